/* Profiles: settings that were found together, with the measurement that they come from (docs/ledger/). A
 * file, or one of those inside the program (configs/profiles/NAME.yaml) by its name alone. Reading is for
 * hostile files: every length is bounded, every setting checked. Any thread. */
#ifndef GW_WALL_PROFILE_H
#define GW_WALL_PROFILE_H

#include "base/settings.h"
#include "base/status.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

enum { GW_PROFILE_FIGURES = 16 };

typedef struct gw_profile {
    char name[64];  /* "default": the table's own settings, of no profile */
    char file[256]; /* "": inside the program, or no profile */
    char about[512];
    char measured_by[512]; /* the command */
    struct {
        char name[64];
        double value;
    } figures[GW_PROFILE_FIGURES]; /* what was measured: errors and costs */
    size_t figure_count;
    gw_settings settings; /* as they stand with it, before anything else is set */
} gw_profile;

void gw_profile_init(gw_profile *profile);

/* Takes word, a file or a name, and sets what it says, leaving other settings as they stand. */
gw_code gw_profile_apply(const char *word, gw_settings *settings, gw_profile *out, gw_error *error);
/* The same from the text of a file. */
gw_code gw_profile_parse(const char *text, size_t size, const char *name, gw_settings *settings,
                         gw_profile *out, gw_error *error);

/* Writes settings as a profile: all rows but those of trackers that differ from the table's. */
gw_code gw_profile_write(const char *path, const gw_profile *profile, gw_error *error);

/* {name, file, about, measured_by, measured{}, changed[]}: the last, settings that are not the profile's any
 * more. */
json_t *gw_profile_json(const gw_profile *profile, const gw_settings *settings);

#endif
