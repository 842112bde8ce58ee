/* Calibration of made-up rooms: all 48 axis maps, usual and odd units, noise; what naive solutions do with
 * mirrors; bad points, points that cannot tell, points that are none; errors of gazes. */
#include "tests/support/check.h"
#include "tests/support/random.h"

#include "tracking/calibrate.h"
#include "tracking/quaternion.h"

#include <math.h>

static uint64_t seed = 20250612;

static double random_number(void) { /* -1 to 1 */
    return 2 * random_unit(&seed) - 1;
}

/* What the device reports at a place in wall space. */
static void report(const gw_room *room, const double wall[3], double out[3]) {
    double back[4], m[3];
    gw_turn_back(room->turn, back);
    for (int i = 0; i < 3; i++)
        m[i] = (wall[i] - room->shift[i]) / room->unit;
    gw_turn_vector(back, m, m);
    for (int i = 0; i < 3; i++)
        out[room->axes.from[i]] = room->axes.sign[i] * m[i];
}

/* Marks of a room of 3 x 2 x 2.4 m, at random or on the floor alone; samples of 1 mm noise, averaged. */
static void measure(const gw_room *room, uint32_t count, int samples, int flat,
                    gw_calibration_point *points) {
    memset(points, 0, count * sizeof *points);
    for (uint32_t i = 0; i < count; i++) {
        double noisy[3];
        const double corner[3] = {i & 1 ? 1500 : -1500, i & 2 ? 2000 : 0, i & 4 ? 3000 : 600};
        for (int k = 0; k < 3; k++)
            points[i].wall[k] = i < 8 ? corner[k] : corner[k] * fabs(random_number());
        points[i].wall[1] *= !flat;
        snprintf(points[i].name, sizeof points[i].name, "m%u", i + 1);
        for (int k = 0; k < 3; k++) {
            noisy[k] = points[i].wall[k];
            for (int s = 0; s < samples; s++)
                noisy[k] += random_normal(&seed) / samples;
        }
        report(room, noisy, points[i].device);
    }
}

static void random_room(int map, int round, gw_room *out) {
    gw_room_default(round % 2 ? 1 : 1000, out);
    out->axes = gw_axis_map_at(map);
    for (int i = 0; i < 3; i++)
        out->shift[i] = 2000 * random_number();
    /* Every other one is turned by up to some 40 degrees: beyond 45 another map would be nearer. */
    for (int i = 0; i < 3 && round & 2; i++)
        out->turn[i] = 0.2 * random_number();
    gw_turn_normalise(out->turn);
}

/* The greatest distance between two rooms' idea of places inside the marks' box, and the angle between what
 * they make of orientations, degrees. */
static void compare(const gw_room *a, const gw_room *b, double *apart, double *angle) {
    *apart = *angle = 0;
    for (int i = 0; i < 50; i++) {
        const double wall[3] = {1500 * random_number(), 1000 + 1000 * random_number(),
                                1800 + 1200 * random_number()};
        double device[3], at[3], q[4], p[4], away = 0, same = 0;
        report(a, wall, device);
        for (int k = 0; k < 4; k++)
            q[k] = random_number();
        if (!gw_turn_normalise(q))
            continue;
        gw_room_pose(b, device, q, at, p);
        gw_room_pose(a, device, q, device, q);
        for (int k = 0; k < 3; k++)
            away += (at[k] - wall[k]) * (at[k] - wall[k]);
        for (int k = 0; k < 4; k++)
            same += p[k] * q[k];
        *apart = fmax(*apart, sqrt(away));
        *angle = fmax(*angle, 2 * 57.29577951308232 * acos(fmin(1, fabs(same))));
    }
}

/* A second of samples at each of 12 marks, 1 mm noise on each sample and axis: everywhere inside the marks
 * to 1 mm, and 0.1 degree. */
static void all_48_maps_are_recovered(void **state) {
    gw_calibration_point points[12];
    gw_calibration found;
    int snapped = 0;
    (void)state;
    printf("# seed %llu\n", (unsigned long long)seed);
    for (int map = 0; map < GW_AXIS_MAPS; map++)
        for (int round = 0; round < 4; round++) {
            gw_room room;
            double apart, angle;
            random_room(map, round, &room);
            measure(&room, 12, 60, 0, points);
            check_ok(gw_calibrate(points, 12, 1, &found, &error));
            compare(&room, &found.room, &apart, &angle);
            if (apart > 1 || angle > 0.1)
                fail_msg("map %d, round %d: %.3f mm and %.4f degrees off", map, round, apart, angle);
            assert_true(found.hand_known && found.left_out < 0);
            assert_int_equal(gw_axis_map_hand(&found.room.axes), gw_axis_map_hand(&room.axes));
            assert_memory_equal(&found.room.axes, &room.axes, sizeof room.axes);
            assert_true(found.room.unit == room.unit && found.unit_snapped);
            if (!(round & 2)) {
                snapped += found.turn_snapped;
                assert_true(!found.turn_snapped || found.room.turn[3] == 1);
            } else {
                assert_false(found.turn_snapped);
            }
        }
    assert_true(snapped >= 90); /* of 96: chance may speak against one */
}

/* One sample each, 1 mm noise: 27 marks. What is stated as expected error is what it is. */
static void single_samples_are_as_good_as_stated(void **state) {
    gw_calibration_point points[27];
    gw_calibration found;
    double squares = 0, stated = 0;
    (void)state;
    for (int round = 0; round < 96; round++) {
        gw_room room;
        double apart, angle, middle[3] = {0, 0, 0}, at[3];
        random_room(round % 48, round, &room);
        measure(&room, 27, 1, 0, points);
        check_ok(gw_calibrate(points, 27, 0, &found, &error));
        compare(&room, &found.room, &apart, &angle);
        if (apart > 2.5 || angle > 0.1)
            fail_msg("round %d: %.3f mm and %.4f degrees off", round, apart, angle);
        for (int i = 0; i < 27; i++)
            for (int k = 0; k < 3; k++)
                middle[k] += points[i].wall[k] / 27;
        report(&room, middle, at);
        gw_room_position(&found.room, at, at);
        for (int k = 0; k < 3; k++)
            squares += (at[k] - middle[k]) * (at[k] - middle[k]) / 96;
        stated += found.expected / 96;
        assert_true(found.rms > 1 && found.rms < 2.4);
    }
    assert_true(sqrt(squares) > 0.8 * stated && sqrt(squares) < 1.2 * stated);
}

/* A device whose unit is nobody's keeps it; with a turn of a few tenths of a degree that the marks can tell,
 * nothing is snapped. */
static void what_is_odd_is_kept(void **state) {
    gw_calibration_point points[12];
    gw_calibration found;
    gw_room room;
    double apart, angle;
    (void)state;
    gw_room_default(987, &room);
    room.turn[1] = sin(0.25 / 57.29577951308232);
    room.turn[3] = cos(0.25 / 57.29577951308232);
    measure(&room, 12, 60, 0, points);
    check_ok(gw_calibrate(points, 12, 1, &found, &error));
    assert_false(found.unit_snapped || found.turn_snapped);
    assert_true(fabs(found.room.unit - 987) < 0.2 && fabs(found.measured_turn - 0.5) < 0.05);
    compare(&room, &found.room, &apart, &angle);
    assert_true(apart < 1 && angle < 0.1);
    check_ok(gw_calibrate(points, 12, 0, &found, &error));
    assert_false(found.unit_snapped || found.turn_snapped);
}

/* The best orthogonal matrix with its determinant left to chance, as Kabsch's method gives without the
 * correction: here the better of the two hands by its residuals. On the floor alone, noise decides. */
static void marks_in_a_plane_cannot_tell_the_hand(void **state) {
    gw_calibration_point points[8], mirrored[8];
    gw_calibration found, mirror;
    int naive_failed = 0;
    (void)state;
    for (int round = 0; round < 48; round++) {
        gw_room room;
        const double head[3] = {200, 1700, 1500};
        double device[3], at[3];
        random_room(round / 8 * 8, round, &room);
        if (gw_axis_map_hand(&room.axes) < 0)
            continue;
        measure(&room, 8, 1, 1, points);
        check_ok(gw_calibrate(points, 8, 1, &found, &error));
        assert_false(found.hand_known);
        assert_int_equal(gw_axis_map_hand(&found.room.axes), 1);
        report(&room, head, device);
        gw_room_position(&found.room, device, at);
        assert_true(fabs(at[1] - 1700) < 10);
        /* The mirror image of what the device said, solved by a rotation, is the reflection. */
        memcpy(mirrored, points, sizeof points);
        for (int i = 0; i < 8; i++)
            for (int k = 0; k < 3; k++)
                mirrored[i].device[k] = -points[i].device[k];
        check_ok(gw_calibrate(mirrored, 8, 1, &mirror, &error));
        for (int k = 0; k < 3; k++)
            device[k] = -device[k];
        gw_room_position(&mirror.room, device, at);
        naive_failed += mirror.rms < found.rms && fabs(at[1] + 1700) < 20; /* a head in the cellar */
    }
    assert_true(naive_failed >= 4);
}

/* A rotation alone cannot take a left-handed device to the room. */
static void a_rotation_does_not_fit_a_mirror(void **state) {
    gw_calibration_point points[8];
    gw_calibration found;
    gw_room room;
    (void)state;
    random_room(0, 1, &room);
    check_ok(gw_axis_map_parse("unity", &room.axes, &error));
    measure(&room, 8, 60, 0, points);
    check_ok(gw_calibrate(points, 8, 1, &found, &error));
    assert_true(found.hand_known && found.rms < 1 && gw_axis_map_hand(&found.room.axes) == -1);
    /* No right-handed map does, whatever the shift. */
    double least = INFINITY;
    for (int map = 0; map < GW_AXIS_MAPS; map++) {
        gw_room naive = found.room;
        naive.axes = gw_axis_map_at(map);
        if (gw_axis_map_hand(&naive.axes) < 0)
            continue;
        double sum = 0, middle[3] = {0, 0, 0}, at[8][3];
        for (int i = 0; i < 8; i++) {
            gw_room_position(&naive, points[i].device, at[i]);
            for (int k = 0; k < 3; k++)
                middle[k] += (points[i].wall[k] - at[i][k]) / 8;
        }
        for (int i = 0; i < 8; i++)
            for (int k = 0; k < 3; k++)
                sum += pow(at[i][k] + middle[k] - points[i].wall[k], 2) / 8;
        least = fmin(least, sqrt(sum));
    }
    assert_true(least > 500);
}

static void one_bad_point_is_named_and_left_out(void **state) {
    gw_calibration_point points[8];
    gw_calibration found;
    (void)state;
    for (int round = 0; round < 48; round++) {
        gw_room room;
        double apart, angle;
        const uint32_t bad = (uint32_t)round % 8;
        random_room(round, round, &room);
        measure(&room, 8, 60, 0, points);
        points[bad].wall[round % 3] += round % 2 ? 300 : -60; /* a tape read wrongly */
        check_ok(gw_calibrate(points, 8, 1, &found, &error));
        assert_int_equal(found.left_out, bad);
        assert_true(fabs(found.alone[bad] - (round % 2 ? 300 : 60)) < 3);
        compare(&room, &found.room, &apart, &angle);
        assert_true(apart < 1.5 && angle < 0.1);
        /* With it, the room would have been off by centimetres. */
        gw_calibration_point five[5];
        memcpy(five, points, sizeof five);
        check_ok(gw_calibrate(five, 5, 1, &found, &error)); /* too few to say which */
        assert_int_equal(found.left_out, -1);
    }
}

static void good_points_are_not_left_out(void **state) {
    gw_calibration_point points[GW_CALIBRATION_POINTS];
    gw_calibration found;
    (void)state;
    for (int round = 0; round < 96; round++) {
        gw_room room;
        random_room(round % 48, round, &room);
        const uint32_t count = 6 + (uint32_t)round % 10;
        measure(&room, count, 1, 0, points);
        check_ok(gw_calibrate(points, count, 1, &found, &error));
        assert_int_equal(found.left_out, -1);
    }
}

static void points_that_say_nothing_are_refused(void **state) {
    gw_calibration_point points[8];
    gw_calibration found;
    gw_room room;
    (void)state;
    random_room(5, 1, &room);
    measure(&room, 8, 60, 0, points);
    check_fails(gw_calibrate(points, 0, 1, &found, &error), GW_BAD_INPUT, "0 points; at least 3");
    check_fails(gw_calibrate(points, 2, 1, &found, &error), GW_BAD_INPUT, "2 points; at least 3");
    check_ok(gw_calibrate(points, 3, 1, &found, &error)); /* three points: all but the hand */
    assert_false(found.hand_known);
    assert_true(found.left_out < 0 && found.alone[0] < 0 && found.rms < 5);
    for (int i = 0; i < 8; i++) { /* a line through the room */
        for (int k = 0; k < 3; k++)
            points[i].wall[k] = 200.0 * i * (k + 1);
        report(&room, points[i].wall, points[i].device);
    }
    check_fails(gw_calibrate(points, 8, 1, &found, &error), GW_BAD_INPUT, "are on one line");
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            points[i].wall[k] = 1;
    check_fails(gw_calibrate(points, 8, 1, &found, &error), GW_BAD_INPUT, "within 0 mm of each other");
    check_fails(gw_calibrate(points, GW_CALIBRATION_POINTS + 1, 1, &found, &error), GW_BAD_INPUT,
                "at most 64");
    measure(&room, 8, 60, 0, points);
    for (int i = 0; i < 8; i++)
        memcpy(points[i].device, points[0].device, sizeof points[i].device);
    check_fails(gw_calibrate(points, 8, 1, &found, &error), GW_BAD_INPUT, "the same position at all marks");
    for (int i = 0; i < 8; i++)
        points[i].device[0] = i;
    check_fails(gw_calibrate(points, 8, 1, &found, &error), GW_BAD_INPUT, "positions are on one line");
}

static void marks_have_a_mean_and_a_spread(void **state) {
    static double samples[][3] = {{1e6, 1, 1}, {1e6 + 2, 1, 1}, {NAN, 1, 1}, {1e6 + 1, 1, 4}};
    gw_mark mark;
    (void)state;
    gw_mark_of(samples, 2, &mark);
    assert_int_equal(mark.count, 2);
    assert_true(mark.mean[0] == 1e6 + 1 && mark.spread == 1 && mark.farthest == 1);
    gw_mark_of(samples, 4, &mark);
    assert_int_equal(mark.count, 3);
    assert_true(fabs(mark.mean[2] - 2) < 1e-12 && fabs(mark.farthest - 2) < 1e-9);
    gw_mark_of(samples, 0, &mark);
    assert_true(mark.count == 0 && mark.spread == 0);
}

/* A viewer whose gazes are 2 degrees to the right and 1 down with a deviation of 0.5, at nine targets. */
static void gaze_errors_are_bias_and_spread(void **state) {
    enum { COUNT = 900 };
    static gw_gaze_sample samples[COUNT];
    gw_gaze_check check;
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        gw_gaze_sample *s = &samples[i];
        *s = (gw_gaze_sample){{1000.0 * (i % 3 - 1), 500.0 * (i / 3 % 3 - 1), 0}, {100, 50, 2000}, {0, 0, 0}};
        double way[3], flat, far = 0;
        for (int k = 0; k < 3; k++)
            way[k] = s->target[k] - s->eye[k];
        flat = hypot(way[0], way[2]);
        far = hypot(flat, way[1]);
        const double right = tan((2 + 0.5 * random_normal(&seed)) / 57.29577951308232),
                     up = tan((-1 + 0.5 * random_normal(&seed)) / 57.29577951308232);
        s->direction[0] = way[0] / far - way[2] / flat * right - way[1] * way[0] / (flat * far) * up;
        s->direction[1] = way[1] / far + flat / far * up;
        s->direction[2] = way[2] / far + way[0] / flat * right - way[1] * way[2] / (flat * far) * up;
    }
    samples[0].direction[0] = NAN;
    memcpy(samples[1].target, samples[1].eye, sizeof samples[1].eye);
    assert_int_equal(gw_gaze_check_of(samples, COUNT, &check), 1);
    assert_int_equal(check.used, COUNT - 2);
    assert_int_equal(check.dropped, 2);
    if (fabs(check.bias[0] - 2) > 0.1 || fabs(check.bias[1] + 1) > 0.1)
        fail_msg("bias %g, %g", check.bias[0], check.bias[1]);
    assert_true(fabs(check.spread[0] - 0.5) < 0.05 && fabs(check.spread[1] - 0.5) < 0.05);
    assert_true(check.median > 2.1 && check.median < 2.5 && check.most > 2.9 && check.most < 3.3);
    assert_int_equal(gw_gaze_check_of(samples, 0, &check), 0);
    assert_int_equal(gw_gaze_check_of(samples, 1, &check), 0);
    assert_int_equal(gw_gaze_check_of(samples + 2, 1, &check), 1);
    assert_true(check.spread[0] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_48_maps_are_recovered),
        cmocka_unit_test(single_samples_are_as_good_as_stated),
        cmocka_unit_test(what_is_odd_is_kept),
        cmocka_unit_test(marks_in_a_plane_cannot_tell_the_hand),
        cmocka_unit_test(a_rotation_does_not_fit_a_mirror),
        cmocka_unit_test(one_bad_point_is_named_and_left_out),
        cmocka_unit_test(good_points_are_not_left_out),
        cmocka_unit_test(points_that_say_nothing_are_refused),
        cmocka_unit_test(marks_have_a_mean_and_a_spread),
        cmocka_unit_test(gaze_errors_are_bias_and_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
