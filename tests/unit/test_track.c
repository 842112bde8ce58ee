/* Tracks: whose sensors count, and the demo track. */
#include "tests/support/check.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/portable_math.h"
#include "tests/tools/demo_track.h"
#include "tracking/quaternion.h"
#include "tracking/track.h"

#include <math.h>
#include <unistd.h>

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.17g is not within %g of %.17g", got, tolerance, wanted);
}

static void portable_functions_agree_with_the_library(void **state) {
    (void)state;
    for (int i = -20000; i <= 20000; i++) {
        double x = 0.001 * i, far = 37.7 * i, c = i / 20000.0;
        assert_near(gw_sin(x), sin(x), 2.5e-16);
        assert_near(gw_cos(x), cos(x), 2.5e-16);
        assert_near(gw_sin(far), sin(far), 2.5e-16);
        assert_near(gw_cos(far), cos(far), 2.5e-16);
        assert_near(gw_atan2(x, 3.0), atan2(x, 3.0), 2e-15);
        assert_near(gw_atan2(3.0, x), atan2(3.0, x), 2e-15);
        assert_near(gw_atan2(x, -1.0), i == 0 ? 3.14159265358979323846 : atan2(x, -1.0), 2e-15);
        assert_near(gw_acos(c), acos(c), 2e-15);
    }
    assert_true(gw_acos(2.0) == 0.0 && gw_atan2(0.0, 0.0) == 0.0);
}

/* The first device with a head or gaze counts; wands and lost sensors are none. */
static void the_first_device_with_a_viewer_counts(void **state) {
    (void)state;
    static char name[] = "made", sender[3][GW_SENDER_NAME] = {"Wand", "Eyes", "Late"};
    gw_recorded_event events[] = {
        {0, {.kind = GW_EVENT_BUTTON, .quality = 1}},
        {0, {.sensor = 8, .quality = 1}},
        {2, {.sensor = 0, .quality = -1}},
        {1, {.kind = GW_EVENT_GAZE, .sensor = 3, .quality = 1}},
        {2, {.sensor = 0, .quality = 1}},
    };
    gw_recording recording = {
        .name = name, .count = 5, .events = events, .sender_count = 3, .senders = sender};
    uint32_t found = 9;
    check_ok(gw_track_sender(&recording, &found, &error));
    assert_int_equal(found, 1);
    recording.count = 3;
    check_fails(gw_track_sender(&recording, &found, &error), GW_BAD_INPUT, "senders: Wand, Eyes, Late");
}

static void demo_file_is_what_its_formula_makes(void **state) {
    (void)state;
    char path[512];
    check_ok(demo_write(scratch_path(path, "demo.vrpn"), &error));
    gw_bytes bytes;
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    unlink(path);
    const gw_embedded_file *file = gw_embedded_find("configs/tracks/demo.vrpn");
    assert_non_null(file);
    assert_int_equal(bytes.size, file->size);
    assert_memory_equal(bytes.data, file->data, file->size);
    gw_bytes_finish(&bytes);
}

/* Where a gaze sensor's pose meets the wall, mm; it stands where the head does. */
static void wall_point(const gw_tracking_event *gaze, double point[2]) {
    const double *eye = gaze->of.pose.position;
    double direction[3] = {0, 0, -1};
    gw_turn_vector(gaze->of.pose.orientation, direction, direction);
    assert_true(direction[2] < 0.0 && eye[2] > 0.0);
    const double t = -eye[2] / direction[2];
    point[0] = eye[0] + t * direction[0];
    point[1] = eye[1] + t * direction[1];
}

/* In both directions over both borders of a 2x2 wall, resting in every tile. */
static void demo_gaze_crosses_tile_borders(void **state) {
    (void)state;
    gw_recording *track;
    check_ok(gw_track_demo(3000.0, 900.0, &track, &error));
    int crossings[2][2] = {{0}}, rests[4] = {0};
    double before[2] = {0};
    for (size_t i = 1; i < track->count; i += 2) {
        double point[2];
        assert_int_equal(track->events[i].event.sensor, GW_SENSOR_GAZE);
        wall_point(&track->events[i].event, point);
        assert_true(fabs(point[0]) < 1500.0 && fabs(point[1]) < 450.0);
        for (int axis = 0; i > 1 && axis < 2; axis++)
            crossings[axis][point[axis] > 0.0] += (before[axis] > 0.0) != (point[axis] > 0.0);
        if (i > 1 && fabs(point[0] - before[0]) + fabs(point[1] - before[1]) < 5.0)
            rests[(point[0] > 0.0) + 2 * (point[1] > 0.0)]++;
        memcpy(before, point, sizeof before);
    }
    for (int axis = 0; axis < 2; axis++)
        for (int way = 0; way < 2; way++)
            assert_true(crossings[axis][way] >= 2);
    for (int tile = 0; tile < 4; tile++)
        assert_true(rests[tile] >= 15); /* a quarter of a second at 60 Hz */
    gw_recording_destroy(&track);
}

/* Scaled to another wall, head and gaze point stay at the same fractions of it. */
static void demo_is_fitted_to_the_wall(void **state) {
    (void)state;
    gw_recording *recorded, *fitted;
    check_ok(gw_track_demo(2000.0, 1125.0, &recorded, &error));
    check_ok(gw_track_demo(6000.0, 1125.0 * 0.75, &fitted, &error));
    assert_int_equal(recorded->count, 962);
    assert_string_equal(recorded->senders[0], "Demo0");
    assert_near((double)recorded->duration, 8e9, 0.0);
    for (size_t i = 0; i < recorded->count; i++) {
        const gw_tracking_event *a = &recorded->events[i].event, *b = &fitted->events[i].event;
        const double *from = a->of.pose.position, *to = b->of.pose.position;
        assert_true(fabs(from[0]) < 310.0 && from[2] > 1500.0 && from[2] < 2000.0);
        assert_near(to[0], 3.0 * from[0], 1e-9);
        assert_near(to[1], 0.75 * from[1], 1e-9);
        assert_near(to[2], 1.5 * from[2], 1e-9);
        if (a->sensor == GW_SENSOR_GAZE) {
            double seen[2], wanted[2];
            wall_point(a, wanted);
            wall_point(b, seen);
            assert_near(seen[0], 3.0 * wanted[0], 1e-6);
            assert_near(seen[1], 0.75 * wanted[1], 1e-6);
        }
    }
    gw_recording_destroy(&recorded);
    gw_recording_destroy(&fitted);
    check_fails(gw_track_demo(0.0, 10.0, &fitted, &error), GW_BAD_INPUT, "0 x 10 mm");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(portable_functions_agree_with_the_library),
        cmocka_unit_test(the_first_device_with_a_viewer_counts),
        cmocka_unit_test(demo_file_is_what_its_formula_makes),
        cmocka_unit_test(demo_gaze_crosses_tile_borders),
        cmocka_unit_test(demo_is_fitted_to_the_wall),
    };
    return cmocka_run_group_tests_name("track", tests, NULL, NULL);
}
