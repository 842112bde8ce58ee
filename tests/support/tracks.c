#include "tests/support/check.h"

#include "tests/support/tracks.h"
#include "tracking/gaze_model.h"
#include "tracking/player.h"
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

gw_tracker_view view_of_track(const gw_track *track, int64_t time, const double neutral_eye[3],
                              const gw_settings *settings) {
    gw_tracker_options options = {.settings = settings, .adopt_first = 1};
    gw_tracker_setup setup;
    gw_tracker *tracker = NULL;
    gw_player *player = NULL;
    gw_tracker_view view;
    memcpy(options.neutral_eye, neutral_eye, sizeof options.neutral_eye);
    gw_player_track_setup(&setup);
    check_ok(gw_player_open_track(track, 0, &player, &error));
    check_ok(gw_tracker_create(&setup, &options, &tracker, &error));
    gw_player_feed(player, tracker, time);
    gw_tracker_at(tracker, time, time, &view);
    gw_tracker_destroy(&tracker);
    gw_player_close(&player);
    return view;
}

static int pose_at(const gw_track *track, int sensor, int64_t time, double place[3], double turn[4]) {
    const size_t count = track->sensor_count[sensor];
    size_t next = 0;
    if (!count)
        return 0;
    while (next < count && track->reports[track->sensor_reports[sensor][next]].time <= time)
        next++;
    const gw_pose_report *a = &track->reports[track->sensor_reports[sensor][next ? next - 1 : 0]],
                         *b = &track->reports[track->sensor_reports[sensor][next < count ? next : count - 1]];
    const double t = b->time > a->time ? (double)(time - a->time) / (double)(b->time - a->time) : 0;
    double along = 0;
    for (int i = 0; i < 4; i++)
        along += a->orientation[i] * b->orientation[i];
    for (int i = 0; i < 3; i++)
        place[i] = a->position[i] + t * (b->position[i] - a->position[i]);
    for (int i = 0; i < 4; i++)
        turn[i] = (1 - t) * a->orientation[i] + (along < 0 ? -t : t) * b->orientation[i];
    return gw_turn_normalise(turn);
}

void sample_track(const gw_track *track, uint32_t viewer, int64_t time, track_sample *out) {
    double turn[4], place[3];
    memset(out, 0, sizeof *out);
    out->has_head = pose_at(track, 2 * (int)viewer + GW_SENSOR_HEAD, time, out->eye, turn);
    out->has_gaze = pose_at(track, 2 * (int)viewer + GW_SENSOR_GAZE, time, place, turn);
    if (out->has_gaze)
        gw_gaze_along(turn, out->gaze_direction);
}
