/* The tracker and the room: rooms that are changed while frames are drawn, units that cannot be, a device
 * that navigates. */
#include "tests/support/check.h"

#include "tracking/tracker.h"
#include "wall/controls.h"

#include <math.h>

static gw_settings settings;
static gw_tracker_setup setup;

static gw_tracker *open_tracker(void) {
    static const double neutral[3] = {0, 0, 1800};
    gw_tracker *tracker = NULL;
    gw_tracker_options options = {.settings = &settings, .adopt_first = 1};
    gw_settings_init(&settings);
    check_ok(gw_settings_assign(&settings, "head_filter=none", &error));
    memcpy(options.neutral_eye, neutral, sizeof neutral);
    check_ok(gw_tracker_create(&setup, &options, &tracker, &error));
    return tracker;
}

static void report(gw_tracker *tracker, double at, double x, double y, double z) {
    gw_tracking_event event = {
        .kind = GW_EVENT_POSE, .arrival = (int64_t)(at * 1e9), .device_time = GW_NO_TIME, .quality = 1};
    event.of.pose.position[0] = x;
    event.of.pose.position[1] = y;
    event.of.pose.position[2] = z;
    event.of.pose.orientation[3] = 1;
    gw_tracker_take(tracker, 0, &event);
}

static void eye_at(gw_tracker *tracker, double at, double out[3]) {
    gw_tracker_view view;
    gw_tracker_at(tracker, (int64_t)(at * 1e9), (int64_t)(at * 1e9), &view);
    memcpy(out, view.viewers[0].eye, sizeof view.viewers[0].eye);
}

static void rooms_change_while_frames_are_drawn(void **state) {
    gw_tracker_setup_default("Tracker0@h", &setup);
    gw_tracker *tracker = open_tracker();
    double eye[3];
    (void)state;
    report(tracker, 0, 0.1, 1.7, 2);
    eye_at(tracker, 0, eye);
    assert_true(fabs(eye[0] - 100) < 1e-6 && fabs(eye[1] - 1700) < 1e-6);
    gw_tracker_setup other = setup;
    check_ok(gw_axis_map_parse("z-up", &other.sources[0].room.axes, &error));
    other.sources[0].room.shift[0] = 50;
    other.viewers[0].eye_offset[1] = -80;
    other.viewers[0].gaze_error = 2;
    other.viewers[0].head_sensor = 9; /* whose a sensor is stays */
    gw_tracker_set_rooms(tracker, &other);
    for (int i = 1; i <= 40; i++)
        report(tracker, 0.02 * i, 0.1, -2, 1.7);
    eye_at(tracker, 0.8, eye);
    assert_true(fabs(eye[0] - 150) < 1 && fabs(eye[1] - 1620) < 1 && fabs(eye[2] - 2000) < 1);
    gw_tracker_destroy(&tracker);
}

static void units_that_cannot_be_are_told(void **state) {
    char text[256];
    gw_tracker_setup_default("Tracker0@h", &setup);
    gw_tracker *tracker = open_tracker();
    (void)state;
    for (int i = 0; i < 9; i++)
        report(tracker, 0.02 * i, 100, 1700 + i, 2000);
    assert_false(gw_tracker_suspect(tracker, 0, text, sizeof text));
    report(tracker, 0.2, 100, 1700, 2000);
    assert_true(gw_tracker_suspect(tracker, 0, text, sizeof text));
    assert_non_null(strstr(text, "is it mm?"));
    setup.sources[0].room.unit = 1; /* mended while frames are drawn */
    gw_tracker_set_rooms(tracker, &setup);
    for (int i = 0; i < 20; i++)
        report(tracker, 0.3 + 0.02 * i, 100, 1700, 2000);
    assert_false(gw_tracker_suspect(tracker, 0, text, sizeof text));
    gw_tracker_destroy(&tracker);
}

static void feed(gw_tracker *tracker, enum gw_tracking_event_kind kind, int source, int32_t number,
                 double value) {
    gw_tracking_event event = {.kind = kind, .sensor = number, .device_time = GW_NO_TIME, .quality = 1};
    if (kind == GW_EVENT_BUTTON)
        event.of.button.pressed = value != 0;
    else if (kind == GW_EVENT_ANALOG)
        event.of.analog.value = value;
    else
        event.of.link.up = value != 0;
    gw_tracker_take(tracker, source, &event);
}

static void a_joystick_navigates(void **state) {
    gw_wand wand;
    gw_tracker_setup_default("Tracker0@h", &setup);
    setup.navigation = (gw_tracker_navigation){.source = 0, .forward = 1, .turn = 0, .reset = 2};
    gw_tracker *tracker = open_tracker();
    (void)state;
    feed(tracker, GW_EVENT_ANALOG, 0, 1, 0.5);
    feed(tracker, GW_EVENT_ANALOG, 0, 0, -7); /* more than a stick can say */
    feed(tracker, GW_EVENT_ANALOG, 1, 1, 1);  /* another device's */
    feed(tracker, GW_EVENT_ANALOG, 0, 5, 1);  /* another axis */
    feed(tracker, GW_EVENT_BUTTON, 0, 2, 1);
    feed(tracker, GW_EVENT_BUTTON, 0, 2, 0);
    gw_tracker_wand(tracker, &wand);
    assert_true(wand.forward == 0.5 && wand.turn == -1 && wand.resets == 1);
    assert_int_equal(gw_tracker_count(tracker)->unassigned, 2);
    gw_navigation_input input = {.move = {0, 0, 0.75}};
    gw_controls_add_wand(&input, &wand);
    assert_true(input.move[2] == 1 && input.turning[0] < 0);
    /* A stick near its middle is still; one that is gone flies nobody away. */
    feed(tracker, GW_EVENT_ANALOG, 0, 0, 0.05);
    gw_tracker_wand(tracker, &wand);
    assert_true(wand.turn == 0 && wand.forward == 0.5);
    feed(tracker, GW_EVENT_LINK, 0, 0, 0);
    gw_tracker_wand(tracker, &wand);
    assert_true(wand.forward == 0);
    gw_tracker_destroy(&tracker);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rooms_change_while_frames_are_drawn),
        cmocka_unit_test(units_that_cannot_be_are_told),
        cmocka_unit_test(a_joystick_navigates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
