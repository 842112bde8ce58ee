/* Calibration with a person in front of the wall: who is asked to hold a sensor at each mark, or to look at
 * each of nine targets, and presses Enter; what the devices then report is sampled. The main thread; devices
 * are read on the reader's. */
#ifndef GW_WALL_CALIBRATE_LIVE_H
#define GW_WALL_CALIBRATE_LIVE_H

#include "base/log.h"
#include "wall/calibrate_file.h"
#include "wall/site.h"

#include <stdio.h>

typedef struct gw_live_options {
    FILE *answers;  /* where Enter is pressed */
    FILE *talk;     /* where the person is asked */
    double seconds; /* of sampling at each mark or target */
    double still;   /* mm: samples that spread by more are taken again, at most twice */
    const gw_log *log;
} gw_live_options;

/* Positions of the sensor at all marks that are not known. `source` and `bind` as gw_source_open takes them.
 */
gw_code gw_marks_take_live(gw_marks *marks, const char *source, const char *bind,
                           const gw_live_options *options, gw_error *error);

/* Gazes of all viewers of a site's trackers at nine targets, three by three over the whole wall. */
gw_code gw_gazes_take_live(const gw_site *site, const gw_live_options *options, gw_gazes *out,
                           gw_error *error);

#endif
