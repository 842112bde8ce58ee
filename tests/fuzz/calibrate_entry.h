/* What a fuzzer and the unit test do with the bytes of a file of marks or of gazes: read it, solve what came
 * out. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_CALIBRATE_ENTRY_H
#define GW_TESTS_FUZZ_CALIBRATE_ENTRY_H

#include "wall/calibrate_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_calibrate_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_marks(const uint8_t *data, size_t size) {
    static gw_marks marks;
    gw_calibration found;
    gw_error error = {0};
    gw_code code = gw_marks_parse((const char *)data, size, "fuzz", &marks, &error);
    fuzz_calibrate_require((code == GW_OK) == (error.text[0] == '\0'));
    if (code)
        return;
    fuzz_calibrate_require(marks.count <= GW_CALIBRATION_POINTS && marks.sensor >= 0);
    for (uint32_t i = 0; i < marks.count; i++)
        fuzz_calibrate_require(strlen(marks.points[i].name) < sizeof marks.points[i].name);
    if (gw_calibrate(marks.points, marks.count, 1, &found, &error))
        return;
    double length = 0;
    for (int i = 0; i < 4; i++)
        length += found.room.turn[i] * found.room.turn[i];
    fuzz_calibrate_require(fabs(length - 1) < 1e-9 && found.room.unit > 0 && isfinite(found.rms));
    fuzz_calibrate_require(found.left_out < (int32_t)marks.count);
}

static inline void fuzz_gazes(const uint8_t *data, size_t size) {
    gw_gazes gazes;
    gw_gaze_check check;
    gw_error error = {0};
    gw_code code = gw_gazes_parse((const char *)data, size, "fuzz", &gazes, &error);
    fuzz_calibrate_require((code == GW_OK) == (error.text[0] == '\0'));
    for (int v = 0; v < GW_TRACK_VIEWERS && !code; v++)
        if (gw_gaze_check_of(gazes.samples[v], (uint32_t)gazes.count[v], &check))
            fuzz_calibrate_require(check.most >= check.median && check.most <= 180.001);
    gw_gazes_finish(&gazes);
}

#endif
