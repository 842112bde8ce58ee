/* Tracks for tests, without a file. Needs cmocka's headers before it (check.h). */
#ifndef GW_TESTS_SUPPORT_TRACKS_H
#define GW_TESTS_SUPPORT_TRACKS_H

#include "tracking/track.h"
#include "tracking/tracker.h"

enum { TRACK_OF_MOST = 64 };

/* A track of poses in millimetres that arrive at their times, at most TRACK_OF_MOST; for gw_track_destroy().
 * Fails the test when it cannot be made. */
gw_track *track_of_reports(const gw_pose_report *reports, size_t count);

/* What the tracker says of a track at a time of it, by these settings. */
gw_tracker_view view_of_track(const gw_track *track, int64_t time, const double neutral_eye[3],
                              const gw_settings *settings);

/* What a track says between its reports, without any tracker: places and turns on the straight way from one
 * to the next, the first and the last ones before and after. */
typedef struct track_sample {
    int has_head, has_gaze;
    double eye[3], gaze_direction[3]; /* mm; unit */
} track_sample;
void sample_track(const gw_track *track, uint32_t viewer, int64_t time, track_sample *out);

#endif
