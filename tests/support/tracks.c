#include "tests/support/check.h"

#include "tests/support/tracks.h"
#include "tracking/quaternion.h"

gw_track *track_of_reports(const gw_pose_report *reports, size_t count) {
    gw_recorded_event events[TRACK_OF_MOST];
    char name[] = "made", sender[1][GW_SENDER_NAME] = {"Test"};
    const gw_recording recording = {
        .name = name, .count = count, .events = events, .sender_count = 1, .senders = sender};
    const gw_track_options options = {.unit = 1.0};
    gw_track *out = NULL;
    assert_true(count <= TRACK_OF_MOST);
    for (size_t i = 0; i < count; i++) {
        events[i] = (gw_recorded_event){.event = {.sensor = reports[i].sensor,
                                                  .arrival = reports[i].time,
                                                  .device_time = GW_NO_TIME,
                                                  .quality = 1.0}};
        memcpy(events[i].event.of.pose.position, reports[i].position, sizeof reports[i].position);
        memcpy(events[i].event.of.pose.orientation, reports[i].orientation, sizeof reports[i].orientation);
        assert_true(gw_turn_normalise(events[i].event.of.pose.orientation));
    }
    check_ok(gw_track_of(&recording, &options, &out, &error));
    return out;
}
