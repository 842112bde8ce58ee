#include "tests/support/check.h"

#include "tests/support/tracks.h"
#include "tracking/gaze_model.h"
#include "tracking/player.h"
#include "tracking/quaternion.h"

gw_recording *recording_of(const test_pose *poses, size_t count) {
    gw_recording *out = calloc(1, sizeof *out);
    assert_non_null(out);
    out->name = strdup("made");
    out->senders = calloc(1, sizeof *out->senders);
    out->events = calloc(count, sizeof *out->events);
    assert_true(out->name != NULL && out->senders != NULL && out->events != NULL);
    strcpy(out->senders[0], "Test");
    out->sender_count = 1;
    out->count = count;
    for (size_t i = 0; i < count; i++) {
        gw_tracking_event *event = &out->events[i].event;
        *event = (gw_tracking_event){
            .sensor = poses[i].sensor, .arrival = poses[i].time, .device_time = GW_NO_TIME, .quality = 1.0};
        memcpy(event->of.pose.position, poses[i].position, sizeof poses[i].position);
        memcpy(event->of.pose.orientation, poses[i].orientation, sizeof poses[i].orientation);
        assert_true(gw_turn_normalise(event->of.pose.orientation));
        out->duration = poses[i].time;
    }
    return out;
}

gw_tracker_view view_of_recording(const gw_recording *recording, int64_t time, const double neutral_eye[3],
                                  const gw_settings *settings) {
    gw_tracker_options options = {.settings = settings, .adopt_first = 1};
    gw_tracker_setup setup;
    gw_tracker *tracker = NULL;
    gw_player *player = NULL;
    gw_tracker_view view;
    const int8_t source = 0;
    memcpy(options.neutral_eye, neutral_eye, sizeof options.neutral_eye);
    gw_player_track_setup(&setup);
    check_ok(gw_player_open(recording, &source, 0, &player, &error));
    check_ok(gw_tracker_create(&setup, &options, &tracker, &error));
    gw_player_feed(player, tracker, time);
    gw_tracker_at(tracker, time, time, &view);
    gw_tracker_destroy(&tracker);
    gw_player_close(&player);
    return view;
}
