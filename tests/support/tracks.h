/* Recordings for tests, without a file. Needs cmocka's headers before it (check.h). */
#ifndef GW_TESTS_SUPPORT_TRACKS_H
#define GW_TESTS_SUPPORT_TRACKS_H

#include "tracking/recording.h"
#include "tracking/tracker.h"

/* A pose of a sensor: position in mm, orientation of any length. */
typedef struct test_pose {
    int64_t time; /* ns, of arrival */
    int32_t sensor;
    double position[3], orientation[4];
} test_pose;

/* Of one device, in millimetres; for gw_recording_destroy(). Fails the test when memory is out. */
gw_recording *recording_of(const test_pose *poses, size_t count);

/* What the tracker says of a recording in millimetres at a time of it, by these settings. */
gw_tracker_view view_of_recording(const gw_recording *recording, int64_t time, const double neutral_eye[3],
                                  const gw_settings *settings);

#endif
