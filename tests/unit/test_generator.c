/* Generated people: what is shipped is what its seed makes; heads and eyes move as literature says. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tracking/generator.h"
#include "tracking/generator_motion.h"
#include "tracking/recording_statistics.h"
#include "tracking/recording_writer.h"

#include <math.h>
#include <unistd.h>

static const double DEGREES = 57.295779513082320877;

/* Of configs/tracks, as `make tracks` and docs/tracks.md have them. */
static const struct {
    const char *kind;
    uint64_t seed;
    double seconds;
} shipped[] = {{"standing", 1, 10}, {"walking", 2, 10},    {"pursuit", 3, 10},
               {"saccades", 4, 10}, {"two-viewers", 5, 6}, {"dropouts", 6, 12}};

/* The log, not its gzip bytes: another zlib may pack otherwise. */
static void shipped_tracks_are_what_their_seeds_make(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof shipped / sizeof *shipped; i++) {
        char path[512], file[256];
        gw_recording *recording;
        gw_bytes made, packed, there;
        check_ok(gw_generate(shipped[i].kind, shipped[i].seed, shipped[i].seconds, &recording, &error));
        scratch_path(path, "made.vrpn");
        check_ok(gw_recording_write(path, GW_RECORDING_BY_NAME, recording, 0, INT64_MAX, 1, &error));
        gw_recording_destroy(&recording);
        check_ok(gw_file_read(path, 1 << 22, &made, &error));
        unlink(path);
        snprintf(file, sizeof file, "configs/tracks/%s.vrpn.gz", shipped[i].kind);
        check_ok(gw_file_read(file, 100000, &packed, &error)); /* none is larger */
        check_ok(gw_gunzip(packed.data, packed.size, 1 << 22, file, &there, &error));
        assert_int_equal(there.size, made.size);
        assert_memory_equal(there.data, made.data, made.size);
        gw_bytes_finish(&made);
        gw_bytes_finish(&packed);
        gw_bytes_finish(&there);
    }
}

static void seeds_and_kinds_differ(void **state) {
    (void)state;
    gw_recording *a, *b;
    check_ok(gw_generate("standing", 1, 0.5, &a, &error));
    check_ok(gw_generate("standing", 2, 0.5, &b, &error));
    assert_int_equal(a->count, b->count);
    int differ = 0;
    for (size_t i = 0; i < a->count; i++)
        differ += memcmp(&a->events[i].event.of, &b->events[i].event.of, sizeof a->events[i].event.of) != 0;
    assert_true((size_t)differ > a->count / 2);
    gw_recording_destroy(&a);
    gw_recording_destroy(&b);
    check_fails(gw_generate("flying", 1, 1, &a, &error), GW_BAD_INPUT, "standing, walking");
    check_fails(gw_generate("standing", 1, 601, &a, &error), GW_BAD_INPUT, "0.1 to 600 seconds");
}

static const gw_person_habits jumping = {
    .place = {0, 0, 1.8}, .fixation = {0.3, 0.5}, .amplitude = {2, 20}, .blink_every = {2, 3}};

/* Peak speed and duration of each saccade, from positions a tenth of a millisecond apart. */
static void saccades_follow_the_main_sequence(void **state) {
    (void)state;
    gw_person person;
    int checked = 0;
    assert_true(gw_person_init(&person, &jumping, 7, 20.0));
    for (int axis = 0; axis < 2; axis++)
        person.drift[axis].amplitude = 0.0;
    for (size_t i = 0; i < person.saccade_count; i++) {
        const gw_move *saccade = &person.saccades[i];
        const double step = 1e-4;
        double before[3], now[3] = {0}, first[3], open, peak = 0.0;
        gw_person_gaze(&person, saccade->start, first, &open);
        memcpy(before, first, sizeof first);
        for (double t = step; t <= saccade->duration + step; t += step) {
            gw_person_gaze(&person, saccade->start + t, now, &open);
            const double sine =
                sqrt(pow(now[0] - before[0], 2) + pow(now[1] - before[1], 2) + pow(now[2] - before[2], 2));
            peak = fmax(peak, sine * DEGREES / step);
            memcpy(before, now, sizeof now);
        }
        const double dot = first[0] * now[0] + first[1] * now[1] + first[2] * now[2];
        const double degrees = acos(fmin(1.0, dot)) * DEGREES;
        if (degrees < 2.0)
            continue;
        /* Baloh et al. 1975: 551 (1 - exp(-A/14)) degrees/s, 37 ms + 2.7 ms per degree. */
        assert_true(fabs(peak / (551.0 * (1.0 - exp(-degrees / 14.0))) - 1.0) < 0.12);
        assert_true(fabs(saccade->duration / (0.037 + 0.0027 * degrees) - 1.0) < 0.25);
        checked++;
    }
    assert_true(checked > 25);
    gw_person_finish(&person);
}

static void blinks_last_100_to_300_ms(void **state) {
    (void)state;
    gw_person person;
    double open, direction[3];
    assert_true(gw_person_init(&person, &jumping, 3, 30.0));
    assert_true(person.blink_count >= 8);
    for (size_t i = 0; i < person.blink_count; i++) {
        const gw_move *blink = &person.blinks[i];
        assert_true(blink->duration >= 0.1 && blink->duration <= 0.3);
        gw_person_gaze(&person, blink->start + 0.5 * blink->duration, direction, &open);
        assert_true(open < 1e-9);
        gw_person_gaze(&person, blink->start - 0.1, direction, &open);
        assert_true(i > 0 || open == 1.0);
    }
    gw_person_finish(&person);
}

/* A standing head stays within centimetres and moves; a walking one goes metres, never as fast as one runs.
 */
static void heads_sway_and_walk(void **state) {
    (void)state;
    static const char *const kinds[] = {"standing", "walking"};
    static const double least[] = {0.004, 1.0}, most[] = {0.05, 2.3}, fastest[] = {0.12, 2.2};
    for (int i = 0; i < 2; i++) {
        gw_recording *recording;
        gw_recording_statistics statistics;
        check_ok(gw_generate(kinds[i], 11, 20, &recording, &error));
        check_ok(gw_recording_measure(recording, 5, 1000, &statistics, &error));
        const gw_recording_channel *head = &statistics.channels[0];
        const double width = fmax(head->high[0] - head->low[0], head->high[2] - head->low[2]);
        assert_true(width > least[i] && width < most[i]);
        assert_true(head->speed_largest < fastest[i] && head->jumps == 0);
        assert_true(fabs(head->rate - 60.0) < 0.5);
        gw_recording_statistics_finish(&statistics);
        gw_recording_destroy(&recording);
    }
}

/* What "dropouts" is for is in it, and replay --info finds it. */
static void dropouts_have_every_fault(void **state) {
    (void)state;
    gw_recording *recording;
    gw_recording_statistics statistics;
    check_ok(gw_generate("dropouts", 6, 12, &recording, &error));
    check_ok(gw_recording_measure(recording, 5, 1000, &statistics, &error));
    assert_int_equal(statistics.channel_count, 5);
    const gw_recording_channel *head = &statistics.channels[0], *gaze = &statistics.channels[1];
    assert_true(head->kind == GW_EVENT_POSE && gaze->kind == GW_EVENT_GAZE);
    assert_true(head->interval_longest > (int64_t)2900000000 && head->gaps >= 3);
    assert_true(head->duplicates > 0 && head->reordered > 0 && gaze->duplicates > 0 && gaze->reordered > 0);
    assert_int_equal(head->clock_steps, 1);
    assert_true(gaze->untracked > 10);
    assert_true(statistics.channels[2].presses == 3 && statistics.channels[4].events == 2);
    gw_recording_statistics_finish(&statistics);
    gw_recording_destroy(&recording);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_tracks_are_what_their_seeds_make),
        cmocka_unit_test(seeds_and_kinds_differ),
        cmocka_unit_test(saccades_follow_the_main_sequence),
        cmocka_unit_test(blinks_last_100_to_300_ms),
        cmocka_unit_test(heads_sway_and_walk),
        cmocka_unit_test(dropouts_have_every_fault),
    };
    return cmocka_run_group_tests_name("generator", tests, NULL, NULL);
}
