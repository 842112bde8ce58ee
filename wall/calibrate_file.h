/* Files that calibrate reads (docs/calibrate.md): marks whose places were measured, with what the device
 * reported there or when it was held there; and gazes at known targets. YAML; every mistake is one sentence
 * with file, line, key and value. One thread. */
#ifndef GW_WALL_CALIBRATE_FILE_H
#define GW_WALL_CALIBRATE_FILE_H

#include "base/status.h"
#include "tracking/calibrate.h"
#include "tracking/setup.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_marks {
    char source[GW_SOURCE_SPEC]; /* key source, "" where it is not said */
    int32_t sensor;              /* key sensor; default 0 */
    uint32_t count;
    gw_calibration_point points[GW_CALIBRATION_POINTS];
    int known[GW_CALIBRATION_POINTS];       /* the point has what the device reported */
    int timed[GW_CALIBRATION_POINTS];       /* else: it is to be taken from a recording */
    double times[GW_CALIBRATION_POINTS][2]; /* s, from and to */
    gw_mark samples[GW_CALIBRATION_POINTS]; /* what was sampled there, of marks that were not known */
} gw_marks;

gw_code gw_marks_load(const char *path, gw_marks *out, gw_error *error);
gw_code gw_marks_parse(const char *text, size_t size, const char *name, gw_marks *out, gw_error *error);

typedef struct gw_gazes {
    uint32_t targets[GW_TRACK_VIEWERS];
    size_t count[GW_TRACK_VIEWERS], capacity[GW_TRACK_VIEWERS];
    gw_gaze_sample *samples[GW_TRACK_VIEWERS]; /* owned */
} gw_gazes;

gw_code gw_gazes_load(const char *path, gw_gazes *out, gw_error *error);
gw_code gw_gazes_parse(const char *text, size_t size, const char *name, gw_gazes *out, gw_error *error);
/* Adds one. GW_MACHINE when memory is out. */
gw_code gw_gazes_add(gw_gazes *gazes, uint32_t viewer, const gw_gaze_sample *sample, gw_error *error);
void gw_gazes_finish(gw_gazes *gazes);

#endif
