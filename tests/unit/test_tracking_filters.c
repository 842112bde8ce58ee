/* Filters of places, turns and gazes: as late as they say, at any rate and uneven ones, over sign flips and
 * half turns; saccades found and left alone. And what plainer filters make of the same samples. */
#include "tests/support/check.h"

#include "tests/support/random.h"
#include "tracking/filter_gaze.h"
#include "tracking/filter_position.h"
#include "tracking/filter_turn.h"
#include "tracking/quaternion.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const gw_position_tuning one_euro = {.kind = GW_FILTER_KIND_ONE_EURO, .one_euro = {2, 0.01}},
                                kalman = {.kind = GW_FILTER_KIND_KALMAN, .noise = 0.5, .acceleration = 2000};

static void check_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.9g is not within %g of %.9g", got, tolerance, wanted);
}

/* --- places
 * ---------------------------------------------------------------------------------------------------- */

/* Seconds to the next sample: even, or anything from a tenth to twice as long. */
static double step_of(double rate, int uneven, uint64_t *seed) {
    return (uneven ? 0.1 + 1.9 * random_unit(seed) : 1) / rate;
}

/* A ramp after which a filter has settled: how far it lags, in seconds, and what it says of that. */
static double lag_on_a_ramp(const gw_position_tuning *tuning, double speed, double rate, int uneven,
                            gw_position_filter *f) {
    uint64_t seed = 5;
    gw_position_filter_begin(f, tuning);
    double time = 0, lag = 0;
    int count = 0;
    for (double dt = 0; time < 6; time += dt) {
        const double x[3] = {speed * time, 0, 1500};
        assert_int_equal(gw_position_filter_take(f, x, dt), 1);
        if (time > 5) {
            lag += (x[0] - f->at[0]) / speed;
            count++;
        }
        dt = step_of(rate, uneven, &seed);
    }
    return lag / count;
}

static void filters_are_as_late_as_they_say(void **state) {
    (void)state;
    const double rates[] = {10, 60, 240, 1000}, speeds[] = {50, 400, 1200};
    gw_position_filter f;
    for (size_t r = 0; r < 4; r++)
        for (size_t s = 0; s < 3; s++)
            for (int uneven = 0; uneven < 2; uneven++) {
                const double lag = lag_on_a_ramp(&one_euro, speeds[s], rates[r], uneven, &f);
                check_near(lag, f.delay, 0.0005 + (uneven ? 0.08 : 0.01) * f.delay);
                check_near(f.velocity[0], speeds[s], 0.01 * speeds[s]);
                check_near(lag_on_a_ramp(&kalman, speeds[s], rates[r], uneven, &f), 0, 0.0005);
                assert_true(f.delay == 0);
                check_near(f.velocity[0], speeds[s], 0.01 * speeds[s]);
            }
    /* Faster is less late. */
    const double slow = lag_on_a_ramp(&one_euro, 50, 60, 0, &f),
                 fast = lag_on_a_ramp(&one_euro, 1200, 60, 0, &f);
    assert_true(fast < slow / 3);
}

/* The plain filter: the same weight whatever the time between samples. */
static double lag_of_a_plain_average(double rate) {
    double at = 0, x = 0;
    for (int i = 0; i < 20000; i++) {
        x = 400 * i / rate;
        at += 0.2 * (x - at);
    }
    return (x - at) / 400;
}

static void lag_does_not_depend_on_the_rate(void **state) {
    (void)state;
    gw_position_filter f;
    const double at_60 = lag_on_a_ramp(&one_euro, 400, 60, 0, &f),
                 at_1000 = lag_on_a_ramp(&one_euro, 400, 1000, 0, &f);
    check_near(at_60, at_1000, 0.05 * at_1000);
    assert_true(lag_of_a_plain_average(60) > 10 * lag_of_a_plain_average(1000));
}

/* Root mean square of what is left of noise of 1 mm at rest. */
static double noise_left(const gw_position_tuning *tuning, double rate) {
    uint64_t seed = 17;
    gw_position_filter f;
    gw_position_filter_begin(&f, tuning);
    double sum = 0;
    int count = 0;
    for (int i = 0; i < 20000; i++) {
        const double x[3] = {random_normal(&seed), 0, 0};
        gw_position_filter_take(&f, x, 1 / rate);
        if (i > 2000) {
            sum += f.at[0] * f.at[0];
            count++;
        }
    }
    return sqrt(sum / count);
}

static void noise_is_less(void **state) {
    (void)state;
    const gw_position_tuning none = {.kind = GW_FILTER_KIND_NONE};
    const gw_position_tuning matched = {.kind = GW_FILTER_KIND_KALMAN, .noise = 1, .acceleration = 500};
    check_near(noise_left(&none, 60), 1, 0.05);
    assert_true(noise_left(&one_euro, 60) < 0.5);
    assert_true(noise_left(&one_euro, 1000) < 0.2);
    assert_true(noise_left(&matched, 60) < 0.75);
    assert_true(noise_left(&matched, 1000) < noise_left(&matched, 60));
}

static void bad_samples_change_nothing(void **state) {
    (void)state;
    const double bad[4][4] = {{NAN, 0, 0, 1}, {0, INFINITY, 0, 1}, {0, 0, -INFINITY, 1}, {0, NAN, 0, NAN}};
    const double zero[4] = {0, 0, 0, 0}, x[3] = {1, 2, 3}, q[4] = {0, 0, 0, 1}, d[3] = {0, 0, -1};
    const gw_turn_tuning turn_tuning = {1, {2, 1}};
    const gw_gaze_tuning gaze_tuning = {1, {2, 0.05}, 70, 15};
    gw_position_filter p, p_before;
    gw_turn_filter t, t_before;
    gw_gaze_filter g, g_before;
    gw_position_filter_begin(&p, &kalman);
    gw_turn_filter_begin(&t, &turn_tuning);
    gw_gaze_filter_begin(&g, &gaze_tuning);
    for (int round = 0; round < 2; round++) {
        memcpy(&p_before, &p, sizeof p);
        memcpy(&t_before, &t, sizeof t);
        memcpy(&g_before, &g, sizeof g);
        for (int i = 0; i < 4; i++) {
            assert_int_equal(gw_position_filter_take(&p, bad[i], 0.01), 0);
            assert_int_equal(gw_turn_filter_take(&t, bad[i], 0.01), 0);
            assert_int_equal(gw_gaze_filter_take(&g, bad[i], 20000000), 0);
        }
        assert_int_equal(gw_turn_filter_take(&t, zero, 0.01), 0);
        assert_int_equal(gw_gaze_filter_take(&g, zero, 20000000), 0);
        assert_int_equal(round ? gw_gaze_filter_take(&g, d, 10000000) : 0, 0); /* not newer */
        assert_memory_equal(&p_before, &p, sizeof p);
        assert_memory_equal(&t_before, &t, sizeof t);
        assert_memory_equal(&g_before, &g, sizeof g);
        gw_position_filter_take(&p, x, 0.01);
        gw_turn_filter_take(&t, q, 0.01);
        gw_gaze_filter_take(&g, d, 10000000);
    }
    /* No time between two samples, or times that make no sense. */
    const double steps[] = {0, -1, NAN, INFINITY, 1e300, 1e-300};
    const double y[3] = {2, 3, 4}, turned[4] = {0, 1, 0, 0};
    for (int i = 0; i < 6; i++) {
        gw_position_filter_take(&p, y, steps[i]);
        gw_turn_filter_take(&t, turned, steps[i]);
        for (int k = 0; k < 3; k++)
            assert_true(isfinite(p.at[k]) && isfinite(p.velocity[k]) && isfinite(t.velocity[k]));
        assert_true(fabs(p.at[0]) < 10 && isfinite(t.at[3]));
    }
}

/* --- turns
 * ---------------------------------------------------------------------------------------------------- */

static void yaw(double angle, double q[4]) {
    q[0] = q[2] = 0;
    q[1] = sin(0.5 * angle);
    q[3] = cos(0.5 * angle);
}

static double angle_between(const double a[4], const double b[4]) {
    const double dot = fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
    return 2 * acos(fmin(dot, 1));
}

/* What is commonly written: a weighted sum of quaternions, brought to length 1, signs as they come. */
static void plain_average(double at[4], const double q[4], double weight) {
    for (int i = 0; i < 4; i++)
        at[i] += weight * (q[i] - at[i]);
    gw_turn_normalise(at);
}

static void sign_flips_are_not_seen(void **state) {
    (void)state;
    const gw_turn_tuning tuning = {1, {2, 1}};
    for (uint64_t s = 1; s <= 4; s++) {
        uint64_t seed = s;
        print_message("# seed %llu\n", (unsigned long long)s);
        gw_turn_filter straight, flipped;
        gw_turn_filter_begin(&straight, &tuning);
        gw_turn_filter_begin(&flipped, &tuning);
        double plain[4] = {0, 0, 0, 1}, worst_plain = 0;
        for (int i = 0; i < 1200; i++) { /* two whole turns in 20 s */
            double q[4], other[4];
            yaw(4 * pi * i / 1200, q);
            const double sign = random_unit(&seed) < 0.3 ? -3 : 0.5; /* nor of length 1 */
            for (int k = 0; k < 4; k++)
                other[k] = sign * q[k];
            gw_turn_filter_take(&straight, q, 1 / 60.0);
            gw_turn_filter_take(&flipped, other, 1 / 60.0);
            plain_average(plain, other, 0.3);
            worst_plain = fmax(worst_plain, angle_between(plain, q));
            assert_true(angle_between(straight.at, flipped.at) < 1e-7);
            /* 36 degrees a second, 2.6 Hz: late by 61 ms at most, 2.2 degrees. */
            assert_true(angle_between(flipped.at, q) < 3 * pi / 180);
            for (int k = 0; k < 3; k++)
                check_near(flipped.velocity[k], k == 1 && i > 60 ? pi / 5 : flipped.velocity[k], 0.02);
        }
        assert_true(worst_plain > 60 * pi / 180);
    }
}

/* As prediction turns on. */
static void turn_on(const gw_turn_filter *f, double seconds, double out[4]) {
    const double way[3] = {seconds * f->velocity[0], seconds * f->velocity[1], seconds * f->velocity[2]};
    gw_turn_on(f->at, way, out);
}

static void half_turns_are_survived(void **state) {
    (void)state;
    const gw_turn_tuning tuning = {1, {5, 0}};
    const double axes[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.6, 0, 0.8, 0}};
    const double start[4] = {0, 0, 0, 1};
    for (int a = 0; a < 4; a++)
        for (int sign = -1; sign <= 1; sign += 2) {
            gw_turn_filter f;
            gw_turn_filter_begin(&f, &tuning);
            double q[4], before = pi + 1e-9, ahead[4];
            for (int k = 0; k < 4; k++)
                q[k] = sign * axes[a][k];
            gw_turn_filter_take(&f, start, 0);
            for (int i = 0; i < 120; i++) {
                assert_int_equal(gw_turn_filter_take(&f, q, 1 / 60.0), 1);
                const double left = angle_between(f.at, q);
                assert_true(left <= before + 1e-7);
                before = left;
                turn_on(&f, 0.05, ahead);
                check_near(gw_turn_normalise(ahead), 1, 0);
            }
            assert_true(before < 1e-3);
        }
}

static void turns_are_predicted(void **state) {
    (void)state;
    const gw_turn_tuning tuning = {0, {5, 0}};
    gw_turn_filter f;
    gw_turn_filter_begin(&f, &tuning);
    double q[4], ahead[4];
    for (int i = 0; i < 120; i++) {
        yaw(2.0 * i / 60, q);
        gw_turn_filter_take(&f, q, 1 / 60.0);
    }
    turn_on(&f, 0.05, ahead);
    yaw(2.0 * 119 / 60 + 2.0 * 0.05, q);
    assert_true(angle_between(ahead, q) < 1e-3);
}

/* --- gazes
 * ---------------------------------------------------------------------------------------------------- */

static void direction(double degrees, double noise, uint64_t *seed, double out[3]) {
    const double across = degrees * pi / 180 + noise * pi / 180 * random_normal(seed),
                 up = noise * pi / 180 * random_normal(seed);
    out[0] = sin(across) * cos(up);
    out[1] = sin(up);
    out[2] = -cos(across) * cos(up);
}

/* A saccade of so many degrees at 1 s: main sequence, minimum jerk. */
static double saccade_at(double amplitude, double time) {
    const double lasts = 0.021 + 0.0022 * amplitude, t = fmin(fmax((time - 1) / lasts, 0), 1);
    return amplitude * t * t * t * (10 - 15 * t + 6 * t * t);
}

typedef struct sight {
    uint32_t saccades;
    double begin, end;             /* s of the clock */
    double behind, worst_filtered; /* deg, of the filter and of one that knows no saccades, after landing */
    double covered, uncovered; /* deg by which the ellipsoid of 6 held the gaze of 20 ms later at worst, with
                                  the widening and without it */
} sight;

static sight look(double amplitude, double rate, double noise, uint64_t *seed) {
    const gw_gaze_tuning tuning = {1, {2, 0.02}, 70, 30}, blind = {1, {2, 0.02}, 0, 30};
    gw_gaze_filter f, plain;
    gw_gaze_filter_begin(&f, &tuning);
    gw_gaze_filter_begin(&plain, &blind);
    sight out = {0, 0, 0, 0, 0, 1000, 1000};
    const double landing = 1 + 0.021 + 0.0022 * amplitude;
    for (int i = 0; i < 2 * rate; i++) {
        const double time = i / rate, truth = saccade_at(amplitude, time),
                     later = saccade_at(amplitude, time + 0.02);
        double d[3], true_later[3];
        direction(truth, noise, seed, d);
        gw_gaze_filter_take(&f, d, (int64_t)(time * 1e9));
        gw_gaze_filter_take(&plain, d, (int64_t)(time * 1e9));
        direction(later, 0, seed, true_later);
        if (f.in_saccade) {
            out.begin = out.begin > 0 ? out.begin : time;
            out.end = time;
            const double held = 6 - gw_degrees_between(f.at, true_later);
            out.covered = fmin(out.covered, held + gw_gaze_filter_widening(&f, 0.02));
            out.uncovered = fmin(out.uncovered, held);
        }
        direction(truth, 0, seed, d);
        if (time > landing + 1.5 / rate && time < landing + 0.1) {
            out.behind = fmax(out.behind, gw_degrees_between(f.at, d));
            out.worst_filtered = fmax(out.worst_filtered, gw_degrees_between(plain.at, d));
        }
    }
    out.saccades = f.saccades;
    return out;
}

static void saccades_are_found_and_not_filtered(void **state) {
    (void)state;
    const double rates[] = {60, 120, 250, 1000}, amplitudes[] = {4, 10, 20, 30};
    for (size_t r = 0; r < 4; r++)
        for (size_t a = 0; a < 4; a++) {
            uint64_t seed = 100 * r + a;
            print_message("# seed %llu, %g degrees at %g Hz\n", (unsigned long long)seed, amplitudes[a],
                          rates[r]);
            const sight s = look(amplitudes[a], rates[r], 0.1, &seed);
            const double landing = 1 + 0.021 + 0.0022 * amplitudes[a];
            assert_int_equal(s.saccades, 1);
            assert_true(s.begin > 1 && s.begin < 1.03 + 1 / rates[r]);
            assert_true(s.end < landing + 0.02 + 1 / rates[r]);
            assert_true(s.behind < 0.1 * amplitudes[a] + 0.5);
            assert_true(s.worst_filtered > 0.15 * amplitudes[a]); /* a filter that knows no saccades trails */
            assert_true(s.covered > 0);
            assert_true(amplitudes[a] < 20 || s.uncovered < 0);
        }
}

static void fixations_and_pursuit_are_no_saccades(void **state) {
    (void)state;
    const double rates[] = {60, 120, 250, 1000};
    const gw_gaze_tuning tuning = {1, {2, 0.02}, 70, 30};
    for (size_t r = 0; r < 4; r++) {
        uint64_t seed = 31 + r;
        gw_gaze_filter rest, pursuit;
        gw_gaze_filter_begin(&rest, &tuning);
        gw_gaze_filter_begin(&pursuit, &tuning);
        double between_neighbours = 0, last[3] = {0, 0, -1};
        for (int i = 0; i < 4 * rates[r]; i++) {
            const double time = i / rates[r];
            double d[3];
            direction(0, 0.15, &seed, d);
            gw_gaze_filter_take(&rest, d, (int64_t)(time * 1e9));
            between_neighbours = fmax(between_neighbours, gw_degrees_between(d, last) * rates[r]);
            memcpy(last, d, sizeof last);
            direction(-10 + 20 * fmod(time, 1), 0.1, &seed, d); /* 20 deg/s; a saccade back each second */
            gw_gaze_filter_take(&pursuit, d, (int64_t)(time * 1e9));
        }
        assert_int_equal(rest.saccades, 0);
        assert_true(rest.delay > 0 && gw_gaze_filter_widening(&rest, 0.1) == 0);
        assert_int_equal(pursuit.saccades, 3);
        assert_true(rates[r] < 1000 ||
                    between_neighbours > 300); /* what the last two samples alone would say */
    }
}

/* A tracker that shakes by half a degree: what a fixed threshold takes for saccades all the time. */
static void noise_is_no_saccade(void **state) {
    (void)state;
    const double rates[] = {60, 250, 1000};
    const gw_gaze_tuning tuning = {1, {2, 0.02}, 70, 30};
    for (size_t r = 0; r < 3; r++) {
        uint64_t seed = 77 + r;
        uint32_t settled = 0, fast = 0;
        gw_gaze_filter f;
        gw_gaze_filter_begin(&f, &tuning);
        for (int i = 0; i < 20 * rates[r]; i++) {
            double d[3];
            direction(0, 0.5, &seed, d);
            gw_gaze_filter_take(&f, d, (int64_t)(i / rates[r] * 1e9));
            settled = i < 3 * rates[r] ? f.saccades : settled;
            fast += f.speed > 70;
        }
        assert_true(f.saccades - settled <= 2);
        assert_true(rates[r] > 500 || fast > 100);
    }
}

/* Half a degree of noise, and saccades of 3 degrees to and fro: most are slower than what that noise makes of
 * neighbours, which is all that a detector with one span of 10 ms sees. */
static void saccades_are_found_in_noise(void **state) {
    (void)state;
    const double rates[] = {120, 240}, every = 0.5, amplitude = 3, lasts = 0.028;
    const gw_gaze_tuning tuning = {1, {2, 0.02}, 70, 30};
    for (size_t r = 0; r < 2; r++) {
        uint64_t seed = 7 + r;
        gw_gaze_filter f;
        gw_gaze_filter_begin(&f, &tuning);
        int made = 0, found = 0, found_by_one_span = 0;
        uint32_t told = 0, all = 0;
        for (int turn = 0; turn < 60; turn++) {
            int seen = 0, one_span = 0;
            for (int i = 0; i < every * rates[r]; i++) {
                const double part = i / rates[r], moved = saccade_at(amplitude, 1 + part) / amplitude;
                double d[3];
                direction(amplitude * (turn % 2 ? 1 - moved : moved), 0.5, &seed, d);
                gw_gaze_filter_take(&f, d, (int64_t)((turn * every + part) * 1e9));
                if (part <= lasts + 0.04) {
                    seen |= f.saccades > told;
                    one_span |= f.speed >= fmax(70, 4 * f.usual[0]);
                }
                told = f.saccades;
            }
            if (turn < 10) { /* what is usual is learned */
                all = told;
                continue;
            }
            made++;
            found += seen;
            found_by_one_span += one_span;
        }
        print_message("# %g Hz: %d of %d, %d by one span\n", rates[r], found, made, found_by_one_span);
        assert_true(found >= made - 3 && found_by_one_span <= made * 2 / 3);
        assert_true(told - all <= (uint32_t)(found + 2));
    }
}

/* What follows something goes on; a rest stays, and nobody knows where a saccade ends. */
static void pursuit_is_predicted(void **state) {
    (void)state;
    const double speed = 20, ahead = 0.05;
    const gw_gaze_tuning tuning = {0, {2, 0.02}, 70, 30};
    uint64_t seed = 3;
    gw_gaze_filter rest, pursuit;
    gw_gaze_filter_begin(&rest, &tuning);
    gw_gaze_filter_begin(&pursuit, &tuning);
    double worst_rest = 0, worst = 0, worst_as_it_is = 0;
    for (int i = 0; i < 480; i++) {
        const double time = i / 240.0;
        double d[3], there[3];
        direction(0, 0.1, &seed, d);
        gw_gaze_filter_take(&rest, d, (int64_t)(time * 1e9));
        direction(-20 + speed * time, 0.1, &seed, d);
        gw_gaze_filter_take(&pursuit, d, (int64_t)(time * 1e9));
        if (time < 1)
            continue;
        gw_gaze_filter_predict(&rest, ahead, there);
        worst_rest = fmax(worst_rest, gw_degrees_between(there, rest.at));
        gw_gaze_filter_predict(&pursuit, ahead, there);
        direction(-20 + speed * (time + ahead), 0, &seed, d);
        worst = fmax(worst, gw_degrees_between(there, d));
        worst_as_it_is = fmax(worst_as_it_is, gw_degrees_between(pursuit.at, d));
    }
    assert_true(worst < 0.5 && worst_as_it_is > 1.1 && worst_rest < 0.15);
    double d[3], there[3];
    direction(40, 0, &seed, d);
    gw_gaze_filter_take(&pursuit, d, 2000000000);
    gw_gaze_filter_predict(&pursuit, ahead, there);
    assert_true(pursuit.in_saccade && gw_degrees_between(there, pursuit.at) == 0);
}

static void blinks_start_anew(void **state) {
    (void)state;
    const gw_gaze_tuning tuning = {1, {1, 0}, 70, 30};
    gw_gaze_filter f;
    gw_gaze_filter_begin(&f, &tuning);
    uint64_t seed = 1;
    double before[3], after[3];
    direction(0, 0, &seed, before);
    direction(25, 0, &seed, after);
    gw_gaze_filter_take(&f, before, 0);
    gw_gaze_filter_take(&f, after, 300000000);
    assert_true(gw_degrees_between(f.at, after) < 1e-9 && !f.in_saccade);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filters_are_as_late_as_they_say),
        cmocka_unit_test(lag_does_not_depend_on_the_rate),
        cmocka_unit_test(noise_is_less),
        cmocka_unit_test(bad_samples_change_nothing),
        cmocka_unit_test(sign_flips_are_not_seen),
        cmocka_unit_test(half_turns_are_survived),
        cmocka_unit_test(turns_are_predicted),
        cmocka_unit_test(saccades_are_found_and_not_filtered),
        cmocka_unit_test(fixations_and_pursuit_are_no_saccades),
        cmocka_unit_test(noise_is_no_saccade),
        cmocka_unit_test(saccades_are_found_in_noise),
        cmocka_unit_test(pursuit_is_predicted),
        cmocka_unit_test(blinks_start_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
