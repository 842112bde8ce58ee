/* The tracker: eyes that never jump, at any rate of samples and frames; what comes twice, late, from clocks
 * that were set anew or as no number; and the same views however it is asked. */
#include "tests/support/check.h"

#include "tests/support/random.h"
#include "tests/support/track_scene.h"
#include "tracking/filter_turn.h"
#include "tracking/quaternion.h"
#include "tracking/tracker.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* --- a hole
 * ---------------------------------------------------------------------------------------------------- */

/* An eye that stands while its sensor is silent and is where the sensor says as soon as it does: the most by
 * which it steps beyond the raw path. */
static double worst_step_of_a_snap(double fps) {
    double before[3], now[3], raw_before[3], raw[3], worst = 0;
    place_at(1, before);
    memcpy(raw_before, before, sizeof before);
    for (int frame = 1; frame < 8 * fps; frame++) {
        const double t = 1 + frame / fps;
        place_at(t, raw);
        place_at(t > 3 && t < 6 ? 3 : t, now);
        worst = fmax(worst, 1000 * (apart(now, before) - apart(raw, raw_before)));
        memcpy(before, now, sizeof now);
        memcpy(raw_before, raw, sizeof raw);
    }
    return worst;
}

/* The words of the states that follow each other, "fresh held lost ..." */
static void note_state(char *text, gw_sensor_phase phase) {
    const char *name = gw_sensor_phase_names[phase], *last = strrchr(text, ' ');
    if (!last || strcmp(last + 1, name) != 0)
        sprintf(text + strlen(text), " %s", name);
}

/* From 3 s on nothing is heard for 3 s. */
static void check_hole(double rate, double fps, int64_t lead, const char *const *settings) {
    static scene s, whole;
    /* A whole number of periods, so that the last sample before the hole is at 3 s, the next at 6 s. */
    fill(&s, rate, 12, 3, rate > 1 ? 6 : 8);
    fill(&whole, rate, 12, 20, 20);
    open_tracker(&s, settings, 1);
    open_tracker(&whole, settings, 1);
    const double hold = fmax(0.1, 3 / rate), speed = 1200, end = rate > 1 ? 6 : 8;
    char states[200] = "";
    gw_viewer_view before = {0}, raw_before = {0};
    double sample_before[3] = {0, 0, 0};
    for (int frame = 0; frame < 11.5 * fps; frame++) {
        const int64_t now = 10 * ms + llrint(frame * 1e9 / fps);
        const gw_viewer_view view = ask(&s, now, lead), raw = ask(&whole, now, lead);
        const double t = 1e-9 * (double)(now - 3 * ms);
        double sample[3] = {0, 0, 0};
        newest_sample(&whole, sample);
        note_state(states, view.head_state);
        if (frame > 0) {
            /* The raw path: of the samples themselves, or as the same filter and prediction follow it. */
            const double step = apart(view.eye, before.eye),
                         raw_step = fmax(apart(raw.eye, raw_before.eye), apart(sample, sample_before));
            if (!(step <= raw_step + speed / fps))
                fail_msg("rate %g, %g frames/s, at %.3f s: %g mm beyond the raw path", rate, fps, t,
                         step - raw_step);
            assert_true(32 * angle_between(view.head, before.head) <=
                        32 * angle_between(raw.head, raw_before.head) + 120 / fps);
        }
        const gw_sensor_phase wanted = t > 3 + hold && t < end ? GW_SENSOR_LOST : GW_SENSOR_FRESH;
        if (wanted == GW_SENSOR_LOST)
            assert_int_equal(view.head_state, GW_SENSOR_LOST);
        if (t > 3.9 + hold && t < end)
            assert_memory_equal(view.eye, neutral, sizeof neutral); /* there, not nearly there */
        if (t > end + 2)
            assert_true(apart(view.eye, raw.eye) < (rate > 1 ? 0.5 : 60)); /* at 1 Hz prediction takes 15 s */
        assert_true(view.confidence >= 0 && view.confidence <= 1);
        if ((t > 1.1 || rate > 1) && (t < 3 + hold || t > end + 0.01))
            assert_true(view.confidence == 1);
        if (t > 3.4 + hold && t < end)
            assert_true(view.confidence == 0 && view.gaze_state == GW_SENSOR_LOST);
        before = view;
        raw_before = raw;
        memcpy(sample_before, sample, sizeof sample);
    }
    /* At 10 frames/s nobody may look while it is held. */
    const int held = strcmp(states, " fresh held lost returned fresh") == 0;
    if (!held && (fps > 10 || strcmp(states, " fresh lost returned fresh") != 0))
        fail_msg("rate %g, %g frames/s: states%s", rate, fps, states);
    /* Head and gaze; a gaze that was heard once is taken for one of 30 Hz. */
    assert_int_equal(gw_tracker_count(s.tracker)->losses, rate > 1 ? 2 : 3);
    gw_tracker_destroy(&s.tracker);
    gw_tracker_destroy(&whole.tracker);
}

static void eyes_never_jump(void **state) {
    (void)state;
    const double rates[] = {1, 60, 240, 1000}, fps[] = {10, 60};
    for (size_t r = 0; r < 4; r++)
        for (size_t f = 0; f < 2; f++)
            for (int64_t lead = 0; lead <= 50 * ms; lead += 50 * ms)
                for (size_t i = 0; i < 3; i++)
                    check_hole(rates[r], fps[f], lead, every_filter[i]);
    assert_true(worst_step_of_a_snap(60) > 20 && worst_step_of_a_snap(10) > 120);
}

/* Sensors that come and go at random: never a jump, whatever state is left for which. */
static void eyes_never_jump_at_random(void **state) {
    (void)state;
    static scene s, whole;
    for (uint64_t number = 1; number <= 6; number++) {
        uint64_t seed = number;
        print_message("# seed %llu\n", (unsigned long long)seed);
        fill(&whole, 120, 20, 30, 30);
        s.count = 0;
        double silent_until = 0;
        for (size_t i = 0; i < whole.count; i++) {
            const double t = 1e-9 * (double)whole.events[i].arrival;
            if (t > silent_until && random_unit(&seed) < 0.006)
                silent_until = t + 0.6 * random_unit(&seed);
            if (t > silent_until)
                add(&s, whole.events[i]);
        }
        open_tracker(&s, every_filter[number % 3], 0);
        open_tracker(&whole, every_filter[number % 3], 1);
        gw_viewer_view before = ask(&s, 0, 0), raw_before = ask(&whole, 0, 0);
        assert_memory_equal(before.eye, neutral, sizeof neutral); /* before the first sample */
        for (int frame = 1; frame < 20 * 60; frame++) {
            const gw_viewer_view view = ask(&s, frame * second / 60, 20 * ms),
                                 raw = ask(&whole, frame * second / 60, 20 * ms);
            /* Up to 25 ms of silence are no state: what the sensor missed, it makes up for at once. */
            const double raw_step = apart(raw.eye, raw_before.eye), step = apart(view.eye, before.eye);
            const double most = before.head_state == GW_SENSOR_FRESH ? 20 + 0.6 * 25 : 20;
            if (!(step <= raw_step + most))
                fail_msg("frame %d, %s: %g mm", frame, gw_sensor_phase_names[view.head_state], step);
            before = view;
            raw_before = raw;
        }
        assert_true(gw_tracker_count(s.tracker)->losses > 10);
        gw_tracker_destroy(&s.tracker);
        gw_tracker_destroy(&whole.tracker);
    }
}

/* --- the same, however it is asked
 * ----------------------------------------------------------------------------- */

static void views_depend_on_events_and_times_only(void **state) {
    (void)state;
    static scene often, seldom;
    for (size_t i = 0; i < 3; i++) {
        fill(&often, 240, 12, 3, 6);
        fill(&seldom, 240, 12, 3, 6);
        open_tracker(&often, every_filter[i], 1);
        open_tracker(&seldom, every_filter[i], 1);
        for (int frame = 0; frame < 700; frame++) {
            const gw_viewer_view a = ask(&often, frame * second / 60, 30 * ms);
            if (frame % 7 == 0) {
                const gw_viewer_view b = ask(&seldom, frame * second / 60, 30 * ms);
                assert_memory_equal(&a, &b, sizeof a);
            }
        }
        /* And again after a reset. */
        const gw_viewer_view last = ask(&often, 12 * second, 0);
        gw_tracker_reset(often.tracker);
        often.taken = 0;
        const gw_viewer_view again = ask(&often, 12 * second, 0);
        assert_memory_equal(&last, &again, sizeof last);
        gw_tracker_destroy(&often.tracker);
        gw_tracker_destroy(&seldom.tracker);
    }
}

/* --- bad company
 * ------------------------------------------------------------------------------------------------ */

/* Both scenes must give the same views from `from` s on. */
static void check_alike(scene *a, scene *b, double from, double millimetres) {
    for (int frame = (int)(from * 60); frame < 9 * 60; frame++) {
        const gw_viewer_view x = ask(a, frame * second / 60, 20 * ms),
                             y = ask(b, frame * second / 60, 20 * ms);
        assert_true(apart(x.eye, y.eye) <= millimetres);
        assert_true(angle_between(x.head, y.head) <= millimetres * 1e-3 + 1e-9);
        assert_true(apart(x.gaze_direction, y.gaze_direction) <= millimetres * 1e-3 + 1e-9);
        assert_int_equal(x.head_state, y.head_state);
        assert_true(x.confidence == y.confidence);
    }
}

static int by_arrival(const void *a, const void *b) {
    const gw_tracking_event *x = a, *y = b;
    return (x->arrival > y->arrival) - (x->arrival < y->arrival);
}

static void what_comes_twice_or_late_is_left_out(void **state) {
    (void)state;
    static scene clean, bad;
    const double rates[] = {60, 240, 1000};
    for (size_t r = 0; r < 3; r++) {
        uint64_t seed = 60 + r;
        print_message("# seed %llu\n", (unsigned long long)seed);
        uint64_t twice = 0, late = 0, nothing = 0;
        fill(&clean, rates[r], 10, 20, 20);
        bad.count = 0;
        for (size_t i = 0; i < clean.count; i++) {
            gw_tracking_event e = clean.events[i];
            const double chance = random_unit(&seed);
            add(&bad, e);
            if (chance < 0.1) { /* the same again, at once or later */
                e.arrival += chance < 0.05 ? 0 : (int64_t)(1e9 / rates[r] / 2);
                add(&bad, e);
                twice++;
            } else if (chance < 0.15 && i >= 4) { /* one between two that came, after them */
                gw_tracking_event old = clean.events[i - 2];
                old.device_time += (int64_t)(1e9 / rates[r] / 3);
                old.arrival = e.arrival;
                old.of.pose.position[0] += 5;
                add(&bad, old);
                late++;
            } else if (chance < 0.2) {
                const double odd[] = {NAN, INFINITY, -INFINITY, 1e30};
                if (e.sensor == 0)
                    e.of.pose.position[random_bits(&seed) % 3] = odd[random_bits(&seed) % 4];
                else
                    memset(e.of.pose.orientation, 0, sizeof e.of.pose.orientation);
                add(&bad, e);
                nothing++;
            }
        }
        qsort(bad.events, bad.count, sizeof *bad.events, by_arrival);
        open_tracker(&clean, NULL, 1);
        open_tracker(&bad, NULL, 1);
        check_alike(&clean, &bad, 0, 0);
        ask(&bad, 20 * second, 0);
        const gw_tracker_counters *c = gw_tracker_count(bad.tracker);
        /* What comes again after the next one came is late. */
        assert_int_equal(c->duplicated + c->reordered, twice + late);
        assert_true(c->duplicated > twice / 4 && c->reordered >= late);
        assert_int_equal(c->not_finite, nothing);
        assert_int_equal(c->samples, clean.count);
        assert_int_equal(c->clock_steps + c->losses + c->unassigned, 0);
        gw_tracker_destroy(&clean.tracker);
        gw_tracker_destroy(&bad.tracker);
    }
}

static void signs_and_lengths_of_quaternions_do_not_count(void **state) {
    (void)state;
    static scene clean, odd;
    uint64_t seed = 9;
    for (size_t f = 0; f < 3; f++) {
        fill(&clean, 240, 10, 20, 20);
        fill(&odd, 240, 10, 20, 20);
        for (size_t i = 0; i < odd.count; i++) {
            const double scale = (random_unit(&seed) < 0.5 ? -1 : 1) * (0.2 + 3 * random_unit(&seed));
            for (int k = 0; k < 4; k++)
                odd.events[i].of.pose.orientation[k] *= scale;
        }
        open_tracker(&clean, every_filter[f], 1);
        open_tracker(&odd, every_filter[f], 1);
        check_alike(&clean, &odd, 0, 1e-6);
        gw_tracker_destroy(&clean.tracker);
        gw_tracker_destroy(&odd.tracker);
    }
}

/* The device's clock is set by so much at 5 s. What waits for newer stamps loses the sensor until then. */
static void clocks_that_are_set_anew_are_survived(void **state) {
    (void)state;
    static scene clean, stepped;
    const int64_t steps[] = {-second / 4, -2 * second, -3600 * second, second / 4, 2 * second, 3600 * second};
    const double rates[] = {60, 1000};
    for (size_t i = 0; i < 6; i++)
        for (size_t r = 0; r < 2; r++) {
            fill(&clean, rates[r], 10, 20, 20);
            fill(&stepped, rates[r], 10, 20, 20);
            for (size_t k = 0; k < stepped.count; k++)
                if (stepped.events[k].arrival >= 5 * second)
                    stepped.events[k].device_time += steps[i];
            open_tracker(&clean, NULL, 1);
            open_tracker(&stepped, NULL, 1);
            gw_viewer_view before = ask(&stepped, 0, 0), raw_before = ask(&clean, 0, 0);
            for (int frame = 1; frame < 9 * 60; frame++) {
                const gw_viewer_view view = ask(&stepped, frame * second / 60, 20 * ms),
                                     raw = ask(&clean, frame * second / 60, 20 * ms);
                assert_true(view.head_state == GW_SENSOR_FRESH || view.head_state == GW_SENSOR_HELD);
                assert_true(apart(view.eye, before.eye) <= apart(raw.eye, raw_before.eye) + 20);
                assert_true(view.head_arrival < second / 2 && apart(view.eye, raw.eye) < 20);
                before = view;
                raw_before = raw;
            }
            const gw_tracker_counters *c = gw_tracker_count(stepped.tracker);
            assert_int_equal(c->clock_steps, 1);
            assert_int_equal(c->losses, 0);
            assert_true(c->reordered <= 2);
            gw_tracker_destroy(&clean.tracker);
            gw_tracker_destroy(&stepped.tracker);
        }
}

/* --- ages
 * ------------------------------------------------------------------------------------------------------- */

/* 50 ms more on the way, told by the device or seen as a delay that was not there before. */
static void delays_show_in_the_ages(void **state) {
    (void)state;
    static scene s;
    for (int told = 0; told < 2; told++) {
        fill(&s, 240, 12, 20, 20);
        for (size_t i = 0; i < s.count; i++) {
            s.events[i].arrival += s.events[i].arrival > 6 * second ? 50 * ms : 0;
            if (told && s.events[i].arrival > 6 * second) {
                s.events[i].latency = 50 * ms;
                s.events[i].device_time += 50 * ms;
            }
        }
        open_tracker(&s, NULL, 1);
        const gw_viewer_view before = ask(&s, 5 * second, 20 * ms), after = ask(&s, 8 * second, 20 * ms);
        assert_true(llabs(after.head_arrival - before.head_arrival - 50 * ms) <= 2 * ms);
        assert_true(llabs(after.head_age - before.head_age - 50 * ms) <= 5 * ms);
        assert_int_equal(after.head_age, after.head_arrival + after.head_wait + 20 * ms);
        assert_true(after.predicted > before.predicted + 40 * ms);
        gw_tracker_destroy(&s.tracker);
    }
}

static double error_at_presentation(const char *const *settings, int64_t lead) {
    static scene s;
    double worst = 0;
    fill(&s, 120, 10, 20, 20);
    open_tracker(&s, settings, 1);
    for (int frame = 60; frame < 9 * 60; frame++) {
        const int64_t now = frame * second / 60;
        const gw_viewer_view view = ask(&s, now, lead);
        double truth[3];
        place_at(1e-9 * (double)(now + lead - 3 * ms), truth); /* a constant delay is not seen */
        for (int i = 0; i < 3; i++)
            truth[i] *= 1000;
        worst = fmax(worst, apart(view.eye, truth));
    }
    gw_tracker_destroy(&s.tracker);
    return worst;
}

static void prediction_meets_the_presentation(void **state) {
    (void)state;
    static const char *const off[] = {"prediction=off", NULL},
                             *const limited[] = {"prediction_limit=0.01", NULL},
                             *const slow[] = {"head_filter=one-euro", "prediction=off", NULL};
    const double without = error_at_presentation(off, 50 * ms), with = error_at_presentation(NULL, 50 * ms);
    assert_true(with < without / 4);
    assert_true(error_at_presentation(limited, 50 * ms) > 0.6 * without);
    /* A filter's own delay is predicted away, too. */
    assert_true(error_at_presentation(every_filter[1], 50 * ms) < error_at_presentation(slow, 50 * ms) / 4);
    assert_true(error_at_presentation(every_filter[2], 50 * ms) < without / 4);
}

/* --- gazes
 * ------------------------------------------------------------------------------------------------------ */

static void gazes_of_every_kind(void **state) {
    (void)state;
    gw_settings settings;
    gw_tracker_setup setup;
    gw_tracker *tracker;
    gw_tracker_view view;
    gw_settings_init(&settings);
    gw_tracker_setup_default("gaze:7000", &setup);
    setup.viewers[1].gaze = GW_GAZE_KIND_HEAD;
    setup.viewers[2].gaze = GW_GAZE_KIND_NONE;
    const gw_tracker_options options = {&settings, {0, 0, 1800}, 1};
    check_ok(gw_tracker_create(&setup, &options, &tracker, &error));
    gw_tracking_event gaze = {.kind = GW_EVENT_GAZE, .quality = 0.5, .device_time = GW_NO_TIME};
    gaze.of.gaze.frame = GW_GAZE_IN_HEAD;
    gaze.of.gaze.openness = 1;
    gaze.of.gaze.direction[2] = -1;
    gw_tracker_take(tracker, 0, &gaze); /* without a head it is nowhere */
    assert_int_equal(gw_tracker_count(tracker)->headless, 1);
    for (int viewer = 0; viewer < 3; viewer++) {
        gw_tracking_event head = head_event(0, 0);
        const double quarter[3] = {0, pi / 2, 0};
        head.sensor = 2 * viewer;
        gw_turn_from_vector(quarter, head.of.pose.orientation);
        gw_tracker_take(tracker, 0, &head);
        gaze.sensor = viewer;
        gw_tracker_take(tracker, 0, &gaze);
    }
    gw_tracker_at(tracker, 0, 0, &view);
    for (int viewer = 0; viewer < 2; viewer++) { /* looking to the left, as the head is turned */
        assert_true(view.viewers[viewer].has_gaze);
        assert_true(fabs(view.viewers[viewer].gaze_direction[0] + 1) < 1e-9);
        assert_true(apart(view.viewers[viewer].gaze_origin, view.viewers[viewer].eye) == 0);
        assert_true(view.viewers[viewer].confidence == (viewer ? 1 : 0.5));
    }
    assert_true(view.viewers[0].gaze_error < 5 && view.viewers[1].gaze_error > 15);
    assert_true(!view.viewers[2].has_gaze && view.viewers[2].has_head && !view.viewers[3].has_head);
    assert_memory_equal(view.viewers[3].eye, neutral, sizeof neutral);
    /* Closed eyes and sensors that the device does not see say nothing; nobody's numbers are counted. */
    gaze.sensor = 0;
    gaze.arrival = second;
    gaze.of.gaze.openness = 0;
    gw_tracker_take(tracker, 0, &gaze);
    gaze.of.gaze.openness = 1;
    gaze.quality = -1;
    gw_tracker_take(tracker, 0, &gaze);
    gaze.sensor = 9;
    gw_tracker_take(tracker, 0, &gaze);
    gw_tracker_take(tracker, 1, &gaze);
    gw_tracker_take(tracker, -1, &gaze);
    const gw_tracker_counters *c = gw_tracker_count(tracker);
    assert_int_equal(c->untracked, 2);
    assert_int_equal(c->unassigned, 5);
    assert_int_equal(c->samples, 4);
    gw_tracker_destroy(&tracker);
}

/* Whatever the numbers, every view is finite, and every event is counted once. */
static void any_event_is_survived(void **state) {
    (void)state;
    const double odd[] = {0, -0.0, 1, -1, NAN, INFINITY, -INFINITY, 1e308, -1e308, 1e-308, 1e9, 3e-7};
    const int64_t times[] = {0, 1, -1, INT64_MIN, INT64_MAX, INT64_MIN + 1, INT64_C(4000000000000000000)};
    for (uint64_t number = 1; number <= 3; number++) {
        uint64_t seed = number;
        print_message("# seed %llu\n", (unsigned long long)seed);
        gw_settings settings;
        gw_tracker_setup setup;
        gw_tracker *tracker;
        gw_settings_init(&settings);
        settings.head_filter = (int32_t)(number % 3);
        settings.gaze_filter = 1;
        gw_tracker_setup_default("Test@localhost", &setup);
        const gw_tracker_options options = {&settings, {0, 0, 1800}, 0};
        check_ok(gw_tracker_create(&setup, &options, &tracker, &error));
        uint64_t given = 0;
        int64_t now = 0;
        for (int i = 0; i < 60000; i++) {
            gw_tracking_event e = head_event(1e-3 * i, 0);
            e.kind = (gw_tracking_event_kind)(random_bits(&seed) % 5);
            e.sensor = (int32_t)(random_bits(&seed) % 4);
            double *numbers = e.of.pose.position;
            for (int k = 0; k < 8; k++)
                if (random_unit(&seed) < 0.05)
                    numbers[k] = odd[random_bits(&seed) % 12];
            if (e.kind == GW_EVENT_GAZE) {
                e.of.gaze.frame = (gw_gaze_frame)(random_bits(&seed) % 2);
                e.of.gaze.has_origin = (int)(random_bits(&seed) % 2);
                e.of.gaze.openness = odd[random_bits(&seed) % 6];
                for (int k = 0; k < 3; k++)
                    e.of.gaze.direction[k] = odd[random_bits(&seed) % 12];
            }
            if (random_unit(&seed) < 0.02)
                e.arrival = times[random_bits(&seed) % 7];
            if (random_unit(&seed) < 0.02)
                e.device_time = times[random_bits(&seed) % 7];
            if (random_unit(&seed) < 0.02)
                e.latency = times[random_bits(&seed) % 7];
            if (random_unit(&seed) < 0.02)
                e.quality = odd[random_bits(&seed) % 12];
            gw_tracker_take(tracker, 0, &e);
            given++;
            now = i * ms;
            gw_tracker_view view;
            gw_tracker_at(tracker, now, now + 30 * ms, &view);
            const gw_viewer_view *v = &view.viewers[0];
            for (int k = 0; k < 3; k++)
                assert_true(isfinite(v->eye[k]) && isfinite(v->gaze_direction[k]) &&
                            isfinite(v->gaze_origin[k]));
            assert_true(isfinite(v->head[3]) && v->confidence >= 0 && v->confidence <= 1);
            assert_true(v->quality >= 0 && v->quality <= 1 && isfinite(v->gaze_widening));
        }
        const gw_tracker_counters *c = gw_tracker_count(tracker);
        assert_int_equal(c->samples + c->untracked + c->duplicated + c->reordered + c->not_finite +
                             c->headless + c->unassigned,
                         given);
        gw_tracker_destroy(&tracker);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eyes_never_jump),
        cmocka_unit_test(eyes_never_jump_at_random),
        cmocka_unit_test(views_depend_on_events_and_times_only),
        cmocka_unit_test(what_comes_twice_or_late_is_left_out),
        cmocka_unit_test(signs_and_lengths_of_quaternions_do_not_count),
        cmocka_unit_test(clocks_that_are_set_anew_are_survived),
        cmocka_unit_test(delays_show_in_the_ages),
        cmocka_unit_test(prediction_meets_the_presentation),
        cmocka_unit_test(gazes_of_every_kind),
        cmocka_unit_test(any_event_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
