/* Tracks: what is taken from a recording, and the demo track. */
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
    track_sample sample;
    check_ok(gw_track_of(&recording, NULL, &track, &error));
    sample_track(track, 1, 0, &sample);
    assert_true(sample.has_head && sample.has_gaze && sample.eye[2] == 1000.0);
    assert_near(sample.gaze_direction[0], -0.6, 1e-15);
    assert_near(sample.gaze_direction[2], 0.8, 1e-15);
    sample_track(track, 0, 5, &sample);
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
static void wall_point(const track_sample *sample, double point[2]) {
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
        track_sample sample;
        double point[2];
        sample_track(track, 0, time, &sample);
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
        track_sample a, b;
        double from[2], to[2];
        sample_track(recorded, 0, time, &a);
        sample_track(fitted, 0, time, &b);
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
        cmocka_unit_test(gaze_events_are_gazes),
        cmocka_unit_test(demo_file_is_what_its_formula_makes),
        cmocka_unit_test(demo_gaze_crosses_tile_borders),
        cmocka_unit_test(demo_is_fitted_to_the_wall),
    };
    return cmocka_run_group_tests_name("track", tests, NULL, NULL);
}
