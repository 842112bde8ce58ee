/* What a fuzzer and the unit test do with the bytes of a VRPN log: read it, check what came out, sample it.
 * Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_VRPN_LOG_ENTRY_H
#define GW_TESTS_FUZZ_VRPN_LOG_ENTRY_H

#include "tests/fuzz/recording_entry.h"
#include "tracking/track.h"

#include <math.h>
#include <stdlib.h>

static inline void fuzz_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_vrpn_log(const uint8_t *data, size_t size) {
    gw_error error = {0};
    gw_track *track = NULL;
    fuzz_recording(data, size);
    gw_code code = gw_track_parse(data, size, "fuzz", NULL, &track, &error);
    fuzz_require((code == GW_OK) == (track != NULL));
    if (code != GW_OK) {
        fuzz_require(error.text[0] != '\0');
        return;
    }
    fuzz_require(track->report_count > 0 && track->report_count == track->counters.poses);
    size_t counted = 0;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS; sensor++)
        counted += track->sensor_count[sensor];
    fuzz_require(track->report_count == counted);
    for (size_t i = 0; i < track->report_count; i++) {
        const gw_pose_report *r = &track->reports[i];
        const double *q = r->orientation;
        fuzz_require(r->time >= (i == 0 ? 0 : r[-1].time));
        fuzz_require(fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0) < 1e-12);
    }
    for (int step = -1; step < 9 * GW_TRACK_VIEWERS; step++) {
        gw_track_sample sample;
        gw_track_at(track, (uint32_t)(step + 1) % GW_TRACK_VIEWERS,
                    track->duration / 8 * (step / GW_TRACK_VIEWERS), &sample);
        fuzz_require(sample.confidence >= 0.0 && sample.confidence <= 1.0 && sample.head_age >= 0);
        const double *d = sample.gaze_direction;
        if (sample.has_gaze)
            fuzz_require(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1.0) < 1e-9);
    }
    gw_track_destroy(&track);
}

#endif
