/* Tracks: what they say between their reports, and the demo track. */
#include "tests/support/check.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/portable_math.h"
#include "tests/support/tracks.h"
#include "tests/tools/demo_track.h"
#include "tracking/track.h"

#include <math.h>
#include <unistd.h>

static const int64_t second = 1000000000;

/* The quaternion of a turn about an axis. */
static void turn(double axis_x, double axis_y, double axis_z, double angle, double q[4]) {
    q[0] = axis_x * sin(0.5 * angle);
    q[1] = axis_y * sin(0.5 * angle);
    q[2] = axis_z * sin(0.5 * angle);
    q[3] = cos(0.5 * angle);
}

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

static void positions_are_interpolated_and_clamped(void **state) {
    (void)state;
    gw_pose_report reports[3] = {
        {.time = 0, .position = {0, 100, 1500}, .orientation = {0, 0, 0, 1}},
        {.time = second, .position = {100, 100, 1500}, .orientation = {0, 0, 0, 1}},
        {.time = 2 * second, .position = {100, 300, 1700}, .orientation = {0, 0, 0, 1}}};
    gw_track *track = track_of_reports(reports, 3);
    gw_track_sample sample;
    static const struct {
        int64_t time;
        double eye[3];
    } rows[] = {{-second, {0, 100, 1500}},          {0, {0, 100, 1500}},
                {second / 4, {25, 100, 1500}},      {second, {100, 100, 1500}},
                {3 * second / 2, {100, 200, 1600}}, {2 * second, {100, 300, 1700}},
                {100 * second, {100, 300, 1700}},   {INT64_MAX, {100, 300, 1700}},
                {INT64_MIN, {0, 100, 1500}}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        gw_track_at(track, 0, rows[i].time, &sample);
        assert_true(sample.has_head && !sample.has_gaze);
        for (int axis = 0; axis < 3; axis++)
            assert_near(sample.eye[axis], rows[i].eye[axis], 1e-9);
    }
    gw_track_destroy(&track);
}

/* The gaze direction halfway and at a quarter between two orientations. */
static void gaze_between(const double a[4], const double b[4], double t, double direction[3]) {
    gw_pose_report reports[2] = {{.time = 0, .sensor = GW_SENSOR_GAZE},
                                 {.time = second, .sensor = GW_SENSOR_GAZE}};
    memcpy(reports[0].orientation, a, sizeof reports[0].orientation);
    memcpy(reports[1].orientation, b, sizeof reports[1].orientation);
    gw_track *track = track_of_reports(reports, 2);
    gw_track_sample sample;
    gw_track_at(track, 0, (int64_t)(t * (double)second), &sample);
    assert_true(sample.has_gaze);
    memcpy(direction, sample.gaze_direction, sizeof sample.gaze_direction);
    gw_track_destroy(&track);
}

static void gaze_turns_evenly(void **state) {
    (void)state;
    for (double whole = 0.0; whole <= 3.1; whole += 0.31)
        for (double t = 0.0; t <= 1.0; t += 0.125) {
            double a[4] = {0, 0, 0, 1}, b[4], d[3];
            turn(0, 1, 0, whole, b); /* to the left: -z turns towards -x */
            gaze_between(a, b, t, d);
            assert_near(d[0], -sin(t * whole), 1e-8);
            assert_near(d[1], 0.0, 1e-12);
            assert_near(d[2], -cos(t * whole), 1e-8);
        }
}

/* q and -q are one orientation: with the sign flipped, the way must not lead around the back. */
static void flipped_signs_take_the_shorter_way(void **state) {
    (void)state;
    double a[4], b[4], straight[3], flipped[3];
    turn(1, 0, 0, 0.3, a);
    turn(0, 1, 0, -0.4, b);
    for (double t = 0.0; t <= 1.0; t += 0.25) {
        double opposite[4] = {-b[0], -b[1], -b[2], -b[3]};
        gaze_between(a, b, t, straight);
        gaze_between(a, opposite, t, flipped);
        for (int axis = 0; axis < 3; axis++)
            assert_near(flipped[axis], straight[axis], 1e-14);
        assert_true(straight[2] < -0.9);
    }
    double same[4] = {-a[0], -a[1], -a[2], -a[3]};
    gaze_between(a, same, 0.5, flipped);
    assert_near(flipped[2], -cos(0.3), 1e-12);
}

static void half_turns_stay_finite(void **state) {
    (void)state;
    double a[4] = {0, 0, 0, 1}, b[4], d[3];
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; i++) {
        turn(axes[i][0], axes[i][1], axes[i][2], GW_PI, b);
        gaze_between(a, b, 0.5, d);
        assert_near(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1.0, 1e-12);
        if (i < 2) /* half of a half turn: a right angle */
            assert_near(d[2], 0.0, 1e-8);
    }
}

static void ages_and_confidence_tell_of_missing_reports(void **state) {
    (void)state;
    gw_pose_report reports[5] = {{.time = 0, .sensor = 0, .orientation = {0, 0, 0, 1}},
                                 {.time = second / 2, .sensor = 1, .orientation = {0, 0, 0, 1}},
                                 {.time = second, .sensor = 0, .orientation = {0, 0, 0, 1}},
                                 {.time = second, .sensor = 1, .orientation = {0, 0, 0, 1}},
                                 {.time = 3 * second, .sensor = 0, .orientation = {0, 0, 0, 1}}};
    gw_track *track = track_of_reports(reports, 5);
    gw_track_sample sample;
    static const struct {
        int64_t time, head_age, gaze_age;
        double confidence;
    } rows[] = {
        {0, 0, 500000000, 0.0}, /* the gaze's first report is still to come */
        {450000000, 450000000, 50000000, 0.125},
        {500000000, 500000000, 0, 0.0},
        {1000000000, 0, 0, 1.0},
        {1100000000, 100000000, 100000000, 1.0},
        {1300000000, 300000000, 300000000, 0.5},
        {1500000000, 500000000, 500000000, 0.0},
        {3000000000, 0, 2000000000, 0.0},
        {9000000000, 0, 2000000000, 0.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        gw_track_at(track, 0, rows[i].time, &sample);
        assert_int_equal(sample.head_age, rows[i].head_age);
        assert_int_equal(sample.gaze_age, rows[i].gaze_age);
        assert_near(sample.confidence, rows[i].confidence, 1e-12);
    }
    gw_track_destroy(&track);
}

/* Gaze events count as a gaze sensor's poses: in the device's frame as they are, in the head's turned by it.
 */
static void gaze_events_are_gazes(void **state) {
    (void)state;
    static char name[] = "made", sender[2][GW_SENDER_NAME] = {"Test", "Other"};
    gw_recorded_event events[] = {
        {0, {.sensor = 2, .device_time = GW_NO_TIME, .quality = 1, .of.pose = {{0, 0, 1}, {0, 1, 0, 0}}}},
        {1, {.sensor = 0, .device_time = GW_NO_TIME, .quality = 1, .of.pose = {{0, 0, 1}, {0, 0, 0, 1}}}},
        {0,
         {.kind = GW_EVENT_GAZE,
          .sensor = 1,
          .device_time = GW_NO_TIME,
          .quality = 1,
          .of.gaze = {GW_GAZE_IN_HEAD, 0, {0}, {0.6, 0, -0.8}, 1}}},
        {0,
         {.kind = GW_EVENT_GAZE,
          .arrival = 5,
          .device_time = GW_NO_TIME,
          .quality = 1,
          .of.gaze = {GW_GAZE_IN_DEVICE, 0, {0}, {0.6, 0, -0.8}, 1}}},
        {0, {.kind = GW_EVENT_GAZE, .arrival = 5, .device_time = GW_NO_TIME, .quality = -1}},
        {0, {.kind = GW_EVENT_BUTTON, .arrival = 5, .device_time = GW_NO_TIME, .quality = 1}},
        {0, {.kind = GW_EVENT_GAZE, .sensor = 4, .arrival = 5, .quality = 1}},
    };
    const gw_recording recording = {.name = name,
                                    .count = sizeof events / sizeof *events,
                                    .events = events,
                                    .sender_count = 2,
                                    .senders = sender};
    gw_track *track = NULL;
    gw_track_sample sample;
    check_ok(gw_track_of(&recording, NULL, &track, &error));
    gw_track_at(track, 1, 0, &sample);
    assert_true(sample.has_head && sample.has_gaze && sample.eye[2] == 1000.0);
    assert_near(sample.gaze_direction[0], -0.6, 1e-15);
    assert_near(sample.gaze_direction[2], 0.8, 1e-15);
    gw_track_at(track, 0, 5, &sample);
    assert_true(!sample.has_head && sample.has_gaze); /* the other sender's head is not its */
    assert_near(sample.gaze_direction[0], 0.6, 1e-15);
    assert_int_equal(track->counters.poses, 3);
    assert_int_equal(track->counters.other_sender, 1);
    assert_int_equal(track->counters.other_kind, 1);
    assert_int_equal(track->counters.untracked, 1);
    assert_int_equal(track->counters.other_sensor, 1);
    gw_track_destroy(&track);
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

/* Where the gaze of a sample meets the wall, mm. */
static void wall_point(const gw_track_sample *sample, double point[2]) {
    assert_true(sample->gaze_direction[2] < 0.0 && sample->eye[2] > 0.0);
    double t = -sample->eye[2] / sample->gaze_direction[2];
    point[0] = sample->eye[0] + t * sample->gaze_direction[0];
    point[1] = sample->eye[1] + t * sample->gaze_direction[1];
}

/* In both directions over both borders of a 2x2 wall, resting in every tile. */
static void demo_gaze_crosses_tile_borders(void **state) {
    (void)state;
    gw_track *track;
    check_ok(gw_track_demo(3000.0, 900.0, &track, &error));
    int crossings[2][2] = {{0}}, rests[4] = {0};
    double before[2] = {0};
    for (int64_t time = 0; time <= track->duration; time += second / 60) {
        gw_track_sample sample;
        double point[2];
        gw_track_at(track, 0, time, &sample);
        wall_point(&sample, point);
        assert_true(fabs(point[0]) < 1500.0 && fabs(point[1]) < 450.0);
        for (int axis = 0; time > 0 && axis < 2; axis++)
            crossings[axis][point[axis] > 0.0] += (before[axis] > 0.0) != (point[axis] > 0.0);
        if (time > 0 && fabs(point[0] - before[0]) + fabs(point[1] - before[1]) < 5.0)
            rests[(point[0] > 0.0) + 2 * (point[1] > 0.0)]++;
        memcpy(before, point, sizeof before);
    }
    for (int axis = 0; axis < 2; axis++)
        for (int way = 0; way < 2; way++)
            assert_true(crossings[axis][way] >= 2);
    for (int tile = 0; tile < 4; tile++)
        assert_true(rests[tile] >= 15); /* a quarter of a second at 60 Hz */
    gw_track_destroy(&track);
}

/* Scaled to another wall, head and gaze point stay at the same fractions of it. */
static void demo_is_fitted_to_the_wall(void **state) {
    (void)state;
    gw_track *recorded, *fitted;
    check_ok(gw_track_demo(2000.0, 1125.0, &recorded, &error));
    check_ok(gw_track_demo(6000.0, 1125.0 * 0.75, &fitted, &error));
    assert_int_equal(recorded->report_count, 962);
    assert_string_equal(recorded->sender, "Demo0");
    assert_near((double)recorded->duration, 8e9, 0.0);
    for (int64_t time = 0; time <= recorded->duration; time += second / 30) {
        gw_track_sample a, b;
        double from[2], to[2];
        gw_track_at(recorded, 0, time, &a);
        gw_track_at(fitted, 0, time, &b);
        assert_true(fabs(a.eye[0]) < 310.0 && a.eye[2] > 1500.0 && a.eye[2] < 2000.0);
        assert_near(b.eye[0], 3.0 * a.eye[0], 1e-9);
        assert_near(b.eye[1], 0.75 * a.eye[1], 1e-9);
        assert_near(b.eye[2], 1.5 * a.eye[2], 1e-9);
        if (time % (second / 2) != 0) /* between reports the arc's middle is scaled only nearly alike */
            continue;
        wall_point(&a, from);
        wall_point(&b, to);
        assert_near(to[0], 3.0 * from[0], 1e-6);
        assert_near(to[1], 0.75 * from[1], 1e-6);
    }
    gw_track_destroy(&recorded);
    gw_track_destroy(&fitted);
    check_fails(gw_track_demo(0.0, 10.0, &fitted, &error), GW_BAD_INPUT, "0 x 10 mm");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(portable_functions_agree_with_the_library),
        cmocka_unit_test(positions_are_interpolated_and_clamped),
        cmocka_unit_test(gaze_turns_evenly),
        cmocka_unit_test(flipped_signs_take_the_shorter_way),
        cmocka_unit_test(half_turns_stay_finite),
        cmocka_unit_test(ages_and_confidence_tell_of_missing_reports),
        cmocka_unit_test(gaze_events_are_gazes),
        cmocka_unit_test(demo_file_is_what_its_formula_makes),
        cmocka_unit_test(demo_gaze_crosses_tile_borders),
        cmocka_unit_test(demo_is_fitted_to_the_wall),
    };
    return cmocka_run_group_tests_name("track", tests, NULL, NULL);
}
