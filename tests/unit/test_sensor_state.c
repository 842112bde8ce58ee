/* States of sensors from their silence, at every rate, and glides that arrive. */
#include "tests/support/check.h"

#include "tests/support/random.h"
#include "tracking/sensor_state.h"

#include <math.h>

static const int64_t ms = 1000000, second = 1000000000;
static const int64_t hold_time = 100 * 1000000;

/* A sensor that has reported for some time, unevenly, the last time at *end. */
static gw_sensor_state running(double rate, uint64_t *seed, int64_t *end) {
    gw_sensor_state sensor = {0};
    int64_t now = 7 * second;
    for (int i = 0; i < 40; i++) {
        now += (int64_t)(1e9 / rate * (0.8 + 0.4 * random_unit(seed)));
        assert_int_equal(gw_sensor_take(&sensor, now + ms, now, hold_time), 0);
    }
    *end = now + ms;
    return sensor;
}

static void silence_is_measured_by_the_sensors_pace(void **state) {
    (void)state;
    const double rates[] = {1, 10, 60, 240, 1000};
    for (size_t r = 0; r < 5; r++) {
        uint64_t seed = 40 + r;
        int64_t end;
        gw_sensor_state sensor = running(rates[r], &seed, &end);
        const double period = 1e9 / rates[r];
        assert_true(fabs((double)sensor.period - period) < 0.15 * period);
        const int64_t hold = gw_sensor_hold(&sensor, hold_time);
        assert_true(fabs((double)hold - fmax(3 * period, 1e8)) < 0.16 * fmax(3 * period, 1e8));
        assert_int_equal(gw_sensor_phase_at(&sensor, end, hold_time), GW_SENSOR_FRESH);
        assert_int_equal(gw_sensor_phase_at(&sensor, end + (int64_t)(1.6 * period), hold_time),
                         GW_SENSOR_FRESH);
        assert_int_equal(gw_sensor_phase_at(&sensor, end + hold, hold_time), GW_SENSOR_HELD);
        assert_int_equal(gw_sensor_phase_at(&sensor, end + hold + 1, hold_time), GW_SENSOR_LOST);
        /* A fixed time, as is usual, would lose a slow sensor between any two of its samples. */
        assert_true(rates[r] > 10 ||
                    gw_sensor_phase_at(&sensor, end + hold_time + ms, hold_time) == GW_SENSOR_FRESH);
        assert_true(gw_sensor_confidence(&sensor, end + hold, hold_time, second) == 1);
        assert_true(fabs(gw_sensor_confidence(&sensor, end + hold + second / 4, hold_time, second) - 0.75) <
                    1e-9);
        assert_true(gw_sensor_confidence(&sensor, end + hold + second, hold_time, second) == 0);
        assert_int_equal(gw_sensor_take(&sensor, end + hold + 2, end + hold + 1, hold_time), 1);
        assert_int_equal(sensor.losses, 1);
        assert_true(sensor.returned == end + hold + 1);
        assert_int_equal(gw_sensor_phase_at(&sensor, end + hold + 2, hold_time), GW_SENSOR_FRESH);
    }
}

static void one_sample_is_held_and_none_is_absent(void **state) {
    (void)state;
    gw_sensor_state sensor = {0};
    assert_int_equal(gw_sensor_phase_at(&sensor, 0, hold_time), GW_SENSOR_ABSENT);
    assert_true(gw_sensor_confidence(&sensor, 0, hold_time, second) == 0);
    gw_sensor_take(&sensor, 5 * second, 5 * second, hold_time);
    assert_int_equal(gw_sensor_phase_at(&sensor, 0, hold_time), GW_SENSOR_FRESH);
    assert_int_equal(gw_sensor_phase_at(&sensor, 6 * second, hold_time), GW_SENSOR_FRESH);
    assert_int_equal(gw_sensor_phase_at(&sensor, 7 * second, hold_time), GW_SENSOR_LOST);
}

/* A hole is one long period among many. */
static void a_hole_does_not_change_the_pace(void **state) {
    (void)state;
    uint64_t seed = 3;
    int64_t end;
    gw_sensor_state sensor = running(60, &seed, &end);
    const int64_t before = sensor.period;
    gw_sensor_take(&sensor, end + 3 * second, end + 3 * second, hold_time);
    assert_true(llabs(sensor.period - before) < ms);
}

static void glides_arrive(void **state) {
    (void)state;
    const gw_glide glide = {{300, -400, 0}, 10 * second};
    const double speed = 1000;
    double left[3], before[3] = {300, -400, 0}, exponential = 500;
    for (int frame = 0; frame < 60; frame++) {
        const int64_t now = glide.since + frame * second / 60;
        const int on_its_way = gw_glide_at(&glide, now, speed, left);
        assert_int_equal(on_its_way, frame < 30);
        const double step = hypot(left[0] - before[0], left[1] - before[1]);
        assert_true(step <= speed / 60 + 1e-6 && left[2] == 0);
        assert_true(fabs(left[0] * 4 + left[1] * 3) < 1e-9); /* straight */
        memcpy(before, left, sizeof before);
        exponential *= frame ? 0.95 : 1; /* the usual way: starts faster than that, and never is there */
    }
    assert_true(left[0] == 0 && left[1] == 0 && exponential > 10 && 500 * 0.05 > speed / 60);
    assert_int_equal(gw_glide_at(&glide, 0, speed, left), 1);
    assert_true(left[0] == 300);
    assert_int_equal(gw_glide_at(&(gw_glide){{0, 0, 0}, 0}, 0, speed, left), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(silence_is_measured_by_the_sensors_pace),
        cmocka_unit_test(one_sample_is_held_and_none_is_absent),
        cmocka_unit_test(a_hole_does_not_change_the_pace),
        cmocka_unit_test(glides_arrive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
