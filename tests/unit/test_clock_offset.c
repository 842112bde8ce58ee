/* Offsets of device clocks: delays are told from offsets, drift is followed, steps are found, and what a
 * plainer estimate would make of the same stamps. */
#include "tests/support/check.h"

#include "tests/support/random.h"
#include "tracking/clock_offset.h"

static const int64_t ms = 1000000, second = 1000000000;
static const int64_t unix_time = INT64_C(1700000000000000000); /* what devices stamp with */

/* What is wrong by less than this cannot be told from jitter. */
static void check_near(int64_t got, int64_t wanted, int64_t tolerance) {
    const int64_t off = got > wanted ? got - wanted : wanted - got;
    if (off > tolerance)
        fail_msg("%lld ns is not within %lld of %lld", (long long)got, (long long)tolerance,
                 (long long)wanted);
}

/* Jitter on the way: mostly little, now and then much. */
static int64_t jitter(uint64_t *seed) {
    const double r = random_unit(seed);
    return (int64_t)(2e6 * r * r + (random_unit(seed) < 0.05 ? 40e6 * random_unit(seed) : 0));
}

static void delays_are_told_from_the_offset(void **state) {
    (void)state;
    const double rates[] = {1, 60, 240, 1000};
    for (size_t r = 0; r < 4; r++) {
        uint64_t seed = 1 + r;
        print_message("# seed %llu\n", (unsigned long long)seed);
        gw_clock_offset clock = {0};
        const int64_t period = (int64_t)(1e9 / rates[r]);
        for (int i = 0; i < 2000; i++) {
            const int64_t stamp = unix_time + i * period, on_its_way = jitter(&seed);
            const int64_t arrival = 5 * second + i * period + on_its_way;
            assert_int_equal(gw_clock_offset_take(&clock, arrival, stamp), GW_CLOCK_STEADY);
            if (i * period > 4 * second && rates[r] >= 60)
                check_near(gw_clock_offset_delay(&clock, arrival, stamp), on_its_way, ms / 2);
        }
        assert_int_equal(clock.steps, 0);
    }
}

static void drift_is_followed(void **state) {
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        uint64_t seed = 7;
        gw_clock_offset clock = {0};
        int64_t first = 0, worst_of_the_first = 0;
        for (int64_t i = 0; i < 600 * 60; i++) { /* ten minutes of 200 ppm: 120 ms */
            const int64_t sent = i * second / 60, on_its_way = jitter(&seed);
            const int64_t stamp = unix_time + sent + sign * sent / 5000, arrival = sent + on_its_way;
            gw_clock_offset_take(&clock, arrival, stamp);
            first = i ? first : arrival - stamp;
            const int64_t naive = arrival - stamp - first; /* the offset of the first message for ever */
            const int64_t off = naive > on_its_way ? naive - on_its_way : on_its_way - naive;
            worst_of_the_first = off > worst_of_the_first ? off : worst_of_the_first;
            if (i > 240)
                check_near(gw_clock_offset_delay(&clock, arrival, stamp), on_its_way, 3 * ms / 2);
        }
        assert_int_equal(clock.steps, 0);
        assert_true(worst_of_the_first > 60 * ms);
    }
}

/* A clock set by `step` after 5 s; how long until the delay is right again, and that of the least for ever.
 */
static void check_step(int64_t step, int64_t gap) {
    uint64_t seed = 11;
    gw_clock_offset clock = {0};
    int64_t least = INT64_MAX, settled = -1;
    int naive_is_wrong = 0;
    for (int64_t i = 0; i < 20 * 60; i++) {
        const int64_t sent = i * second / 60, on_its_way = jitter(&seed);
        const int stepped = sent >= 5 * second;
        if (stepped && sent < 5 * second + gap)
            continue;
        const int64_t stamp = unix_time + sent + (stepped ? step : 0), arrival = sent + on_its_way;
        gw_clock_offset_take(&clock, arrival, stamp);
        least = arrival - stamp < least ? arrival - stamp : least;
        const int64_t delay = gw_clock_offset_delay(&clock, arrival, stamp);
        const int right = delay - on_its_way < 41 * ms && on_its_way - delay < 41 * ms;
        settled = !right ? -1 : settled < 0 ? sent : settled;
        naive_is_wrong |= sent > 19 * second && arrival - stamp - least > on_its_way + 50 * ms;
    }
    assert_int_equal(clock.steps, 1);
    check_near(clock.last_step, step, 45 * ms);
    assert_true(settled <= 5 * second + gap + 600 * ms);
    assert_true(naive_is_wrong == (step < 0));
}

static void steps_are_found_and_named(void **state) {
    (void)state;
    const int64_t steps[] = {200 * ms, -200 * ms, 5 * second, -5 * second, 3600 * second, -3600 * second};
    for (size_t i = 0; i < 6; i++) {
        check_step(steps[i], 0);
        check_step(steps[i], 3 * second);
        check_step(steps[i], 6 * second);
    }
}

static void late_packets_and_stalls_are_no_steps(void **state) {
    (void)state;
    gw_clock_offset clock = {0};
    for (int64_t i = 0; i < 20 * 60; i++) {
        const int64_t sent = i * second / 60;
        /* One packet in a hundred is 3 s late; from 8 s to 10 s the line stalls, then all comes at once. */
        int64_t arrival = i % 100 == 50 ? sent + 3 * second : sent;
        if (sent >= 8 * second && sent < 10 * second)
            arrival = 10 * second;
        assert_int_equal(gw_clock_offset_take(&clock, arrival, unix_time + sent), GW_CLOCK_STEADY);
        check_near(clock.offset, -unix_time, 0);
    }
    assert_int_equal(clock.steps, 0);
}

static void any_number_is_survived(void **state) {
    (void)state;
    const int64_t odd[] = {INT64_MIN, INT64_MIN + 1, -1, 0, 1, INT64_MAX};
    uint64_t seed = 23;
    gw_clock_offset clock = {0};
    for (int i = 0; i < 100000; i++) {
        const int64_t a = odd[random_bits(&seed) % 6], b = odd[random_bits(&seed) % 6];
        gw_clock_offset_take(&clock, a, b);
        assert_true(gw_clock_offset_delay(&clock, b, a) >= 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delays_are_told_from_the_offset),
        cmocka_unit_test(drift_is_followed),
        cmocka_unit_test(steps_are_found_and_named),
        cmocka_unit_test(late_packets_and_stalls_are_no_steps),
        cmocka_unit_test(any_number_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
