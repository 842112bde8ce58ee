/* What a fuzzer and the unit test do with the bytes of a VRPN log: read it, check what came out, play it.
 * Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_VRPN_LOG_ENTRY_H
#define GW_TESTS_FUZZ_VRPN_LOG_ENTRY_H

#include "tests/fuzz/recording_entry.h"
#include "tracking/player.h"

#include <math.h>
#include <stdlib.h>

static inline void fuzz_require(int holds) {
    if (!holds)
        abort();
}

/* Every view of it is finite, whenever one asks. */
static inline void fuzz_play(const gw_track *track) {
    gw_error error = {0};
    gw_settings settings;
    gw_tracker_setup setup;
    gw_tracker *tracker = NULL;
    gw_player *player = NULL;
    gw_settings_init(&settings);
    gw_player_track_setup(&setup);
    const gw_tracker_options options = {&settings, {0, 0, 1800}, 1};
    fuzz_require(gw_tracker_create(&setup, &options, &tracker, &error) == GW_OK);
    fuzz_require(gw_player_open_track(track, 0, &player, &error) == GW_OK);
    for (int step = -1; step < 9; step++) {
        gw_tracker_view view;
        const int64_t time = track->duration / 8 * step;
        gw_player_feed(player, tracker, time);
        gw_tracker_at(tracker, time, time, &view);
        for (int i = 0; i < GW_TRACK_VIEWERS; i++) {
            const gw_viewer_view *v = &view.viewers[i];
            const double *d = v->gaze_direction;
            fuzz_require(v->confidence >= 0 && v->confidence <= 1 && v->head_age >= 0);
            fuzz_require(isfinite(v->eye[0]) && isfinite(v->eye[1]) && isfinite(v->eye[2]));
            fuzz_require(!v->has_gaze || fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-9);
        }
    }
    gw_player_close(&player);
    gw_tracker_destroy(&tracker);
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
    fuzz_play(track);
    gw_track_destroy(&track);
}

#endif
