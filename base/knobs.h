/* The registry of knobs: everything in the program that trades accuracy for time, memory or delay. Most are
 * rows of the table of settings; a knob adds what the ledger (`gazewall bench accuracy`) needs to measure its
 * curve: which values it tries, at which one there is no error, what must be set for it to have something to
 * do, and which model predicts its error. Knobs that are no settings say where they live and what measures
 * them.
 *
 * gw_knobs_check() tells what is not registered; a unit test calls it, so a new setting without a knob fails.
 * Constant tables; any thread. */
#ifndef GW_BASE_KNOBS_H
#define GW_BASE_KNOBS_H

#include "base/settings.h"
#include "base/status.h"

#include <stddef.h>

/* What its error is measured against. */
typedef enum gw_knob_reference {
    GW_KNOB_EXACT, /* the exact frame of all knobs, which has this knob's `exact` in it */
    GW_KNOB_OWN    /* an effect or a look of its own: its `exact` only counts where it is swept itself */
} gw_knob_reference;

typedef struct gw_knob {
    const char *name;
    const char *sweep; /* values with blanks between, as --set takes them; NULL: made from the default */
    const char *exact; /* the value without this knob's error, set in the reference; NULL: not set there */
    const char *with;  /* "name=value ...", what has to be set beside it, or NULL */
    double age;        /* s, of the gaze in its frames */
    const char *model; /* what predicts its error, or NULL */
    gw_knob_reference reference;
    int over_time; /* 1: its worth lies in what moves, eyes or pictures, which a still frame does not tell */
    int quick;     /* 1: it is part of a quick ledger */
} gw_knob;

/* A knob that is no setting. */
typedef struct gw_knob_elsewhere {
    const char *name, *unit, *initial, *range, *trades, *reference;
    const char *where;    /* option, file or line that holds it */
    const char *measured; /* by which command or test */
} gw_knob_elsewhere;

extern const gw_knob gw_knobs[];
extern const size_t gw_knob_count;
extern const gw_knob_elsewhere gw_knobs_elsewhere[];
extern const size_t gw_knob_elsewhere_count;

/* NULL when there is none of that name. */
const gw_knob *gw_knob_find(const char *name);
/* The knob's setting; NULL when the name is wrong, which gw_knobs_check() tells. */
const gw_setting_row *gw_knob_setting(const gw_knob *knob);

enum { GW_KNOB_VALUES = 12, GW_KNOB_TEXT = 64 };
/* The values that the ledger tries, each once, ascending (choices in their order), with the default among
 * them: the knob's own, all of a switch or choice, or a quarter, half, once, twice and four times the default
 * within its range. As --set takes them. */
size_t gw_knob_values(const gw_knob *knob, char out[GW_KNOB_VALUES][GW_KNOB_TEXT]);

/* Assigns "name=value name=value ...". */
gw_code gw_settings_assign_all(gw_settings *settings, const char *assignments, gw_error *error);

/* Whether the registry and this table of settings agree: every row has its knob, every knob its row, every
 * sweep and assignment is one that the row takes, with at least two values. GW_BAD_INPUT names what is not
 * so.
 */
gw_code gw_knobs_check(const gw_setting_row *rows, size_t count, gw_error *error);

#endif
