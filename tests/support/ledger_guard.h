/* Recorded work and errors of a scene at a few settings of some knobs, and whether they have got worse: what
 * keeps a change from making frames dearer or poorer without anybody noticing. Plain values. */
#ifndef GW_TESTS_SUPPORT_LEDGER_GUARD_H
#define GW_TESTS_SUPPORT_LEDGER_GUARD_H

#include "base/status.h"
#include "render/metrics.h"
#include "render/renderer.h"

#include <stddef.h>
#include <stdio.h>

enum { GW_GUARD_ROWS = 64, GW_GUARD_NUMBERS = 13, GW_GUARD_TEXT = 400 };
/* The first numbers of a row are work, the rest errors. */
enum { GW_GUARD_WORK = 6, GW_GUARD_FLIP = 10 };

typedef struct gw_guard_row {
    char knob[32];
    double value;
    double numbers[GW_GUARD_NUMBERS];
} gw_guard_row;

/* From exact to coarse within a knob; knobs one after another. */
typedef struct gw_guard_table {
    size_t count;
    gw_guard_row rows[GW_GUARD_ROWS];
} gw_guard_table;

extern const char *const gw_guard_names[GW_GUARD_NUMBERS];

gw_guard_row gw_guard_row_of(const char *knob, double value, const gw_counters *counters,
                             const gw_metrics *errors);

/* CSV with a line of names; lines that begin with # are remarks. GW_BAD_INPUT names file and line. */
gw_code gw_guard_load(const char *path, gw_guard_table *out, gw_error *error);
void gw_guard_write(FILE *file, const gw_guard_table *table, const char *remark);

/* Numbers within 1 % (errors: or within what rounding makes of them). Returns how many are not, and tells the
 * first in text. Tables of other rows differ in every one. */
size_t gw_guard_compare(const gw_guard_table *recorded, const gw_guard_table *measured,
                        char text[GW_GUARD_TEXT]);
/* Knobs whose front of work against FLIP is worse: a recorded point that no measured one equals in both to 1
 * %. Names the first with the point. */
size_t gw_guard_fronts(const gw_guard_table *recorded, const gw_guard_table *measured,
                       char text[GW_GUARD_TEXT]);
/* Knobs whose FLIP falls by more than 5 % from a value to the next, coarser one. */
size_t gw_guard_monotone(const gw_guard_table *measured, char text[GW_GUARD_TEXT]);

#endif
