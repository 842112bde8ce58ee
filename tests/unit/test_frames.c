/* Frame states: what a track says becomes a state, and a recording gives every bit back. */
#include "tests/support/check.h"

#include "tests/support/tracks.h"
#include "tracking/quaternion.h"
#include "tracking/track.h"

#include "base/file.h"
#include "tests/fuzz/states_entry.h"
#include "tests/support/random.h"
#include "wall/frames.h"

#include <math.h>

static gw_settings defaults(void) {
    gw_settings settings;
    gw_settings_init(&settings);
    return settings;
}

static double dot(const float a[3], const float b[3]) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static void a_stare_is_one_gaze(void **state) {
    (void)state;
    gw_settings settings = defaults();
    gw_frame_state s;
    const double eye[3] = {100, 50, 1800};
    gw_frame_begin(&s, 7, &settings, 9, GW_DEBUG_LEVELS);
    gw_frame_stare(&s, eye, (const double[3]){100, 50, 0}, &settings);
    assert_int_equal(s.frame, 7);
    assert_int_equal(s.seed, 9);
    assert_int_equal(s.debug, GW_DEBUG_LEVELS);
    assert_true((double)s.tau == settings.tau);
    assert_int_equal(s.gaze_count, 1);
    assert_true(s.gazes[0].direction[2] == -1.0f && s.gazes[0].up[1] == 1.0f);
    assert_true((double)s.gazes[0].half_width == settings.gaze_half_width);
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&s, eye, NULL, &settings);
    assert_int_equal(s.gaze_count, 0);
    assert_true(s.eye[0] == 100);
}

/* Any direction, straight up and down included, gives a unit up across it. */
static void up_is_across_every_gaze(void **state) {
    (void)state;
    gw_settings settings = defaults();
    const double eye[3] = {0, 0, 0};
    for (int x = -2; x <= 2; x++) {
        for (int y = -2; y <= 2; y++) {
            for (int z = -2; z <= 2; z++) {
                gw_frame_state s;
                gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
                gw_frame_stare(&s, eye, (const double[3]){x, y, z}, &settings);
                if (!x && !y && !z) {
                    assert_int_equal(s.gaze_count, 0); /* at the eye itself there is no direction */
                    continue;
                }
                const gw_gaze *gaze = &s.gazes[0];
                assert_true(fabs(dot(gaze->direction, gaze->direction) - 1) < 1e-6);
                assert_true(fabs(dot(gaze->up, gaze->up) - 1) < 1e-6);
                assert_true(fabs(dot(gaze->up, gaze->direction)) < 1e-6);
            }
        }
    }
}

/* The demo track's pose of a sensor at the moment of one of its samples. */
static const gw_tracking_event *pose_at(const gw_recording *track, int32_t sensor, int64_t time) {
    for (size_t i = 0; i < track->count; i++) {
        const gw_tracking_event *event = &track->events[i].event;
        if (event->sensor == sensor && event->arrival - time < 1000 && time - event->arrival < 1000)
            return event;
    }
    fail_msg("no sample at %lld", (long long)time);
    return NULL;
}

static void the_track_speaks(void **state) {
    (void)state;
    gw_settings settings = defaults();
    gw_recording *track = NULL;
    const double neutral[3] = {1, 2, 3};
    check_ok(gw_track_demo(2000, 1125, &track, &error));
    gw_frame_state s;
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_tracker_view view = view_of_recording(track, track->duration / 3, neutral, &settings);
    gw_frame_look(&s, &view, &settings);
    const double *eye = pose_at(track, GW_SENSOR_HEAD, track->duration / 3)->of.pose.position;
    const double *turn = pose_at(track, GW_SENSOR_GAZE, track->duration / 3)->of.pose.orientation;
    double direction[3] = {0, 0, -1};
    gw_turn_vector(turn, direction, direction);
    assert_int_equal(s.gaze_count, 1);
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(s.eye[i] - eye[i]) < 0.1);
        assert_true(fabs((double)s.gazes[0].direction[i] - direction[i]) < 2e-3);
    }
    assert_true(s.gazes[0].half_width == (float)settings.gaze_half_width);
    /* At the moment of a sample it is that sample; one that nobody filters or predicts always is. */
    view = view_of_recording(track, 1000000000, neutral, &settings);
    eye = pose_at(track, GW_SENSOR_HEAD, 1000000000)->of.pose.position;
    assert_memory_equal(view.viewers[0].eye, eye, 3 * sizeof *eye);
    /* In a saccade, and of a gaze that is known less surely, the ellipsoid is wider; not without end. */
    view.viewers[0].gaze_widening = 5;
    view.viewers[0].gaze_error = settings.gaze_margin + 2;
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_look(&s, &view, &settings);
    assert_true(s.gazes[0].half_width == (float)(settings.gaze_half_width + 7));
    view.viewers[0].gaze_widening = 100;
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_look(&s, &view, &settings);
    assert_true(s.gazes[0].half_width == 90);
    view.viewers[0].confidence = 0;
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_look(&s, &view, &settings);
    assert_int_equal(s.gaze_count, 0);
    gw_recording_destroy(&track);
}

/* Values that only survive when every digit is written: all bytes of the state come back. */
static void a_recording_gives_every_bit_back(void **state) {
    (void)state;
    enum { COUNT = 50 };
    static gw_frame_state states[COUNT];
    gw_settings settings = defaults();
    char path[512];
    scratch_path(path, "states.json");
    for (uint32_t i = 0; i < COUNT; i++) {
        settings.tau = 1.0 / (i + 3.0);
        settings.acuity_slope = 0.02 + 1e-9 * i;
        gw_frame_begin(&states[i], i, &settings, UINT32_MAX - i, (gw_debug_view)(i % 5));
        const double eye[3] = {1000.0 / 3 * i, -1e-7 / (i + 1), 1800.000000001 + i};
        const double target[3] = {i * 0.1, sin(i), -3};
        gw_frame_stare(&states[i], eye, i % 4 ? target : NULL, &settings);
        states[i].time = INT64_C(9007199254740993) + i; /* more digits than a double has */
        states[i].gazes[0].age = i % 4 ? 0.1f * (float)i : 0;
        states[i].geometry = (uint8_t)(i % 3);
        states[i].near_light = (uint8_t)(255 - i);
        states[i].environment_lights = (uint8_t)(64 - i);
        states[i].shadow_samples = (uint8_t)(i % 3);
        states[i].emissive_lights = (uint8_t)(63 - i);
        states[i].emissive_faintest = 1.0f / (9.0f + (float)i);
        states[i].emissive_least = 1.0f / (7.0f + (float)i);
        states[i].light_least = (uint16_t)(UINT16_MAX - i);
        states[i].bounces = (uint8_t)(i % 9);
        states[i].least_throughput = 1.0f / (3.0f + (float)i);
        states[i].epoch = 7 * i;
        states[i].stand[i % 3] = 1.0f / (3.0f + (float)i);
        states[i].look_at[(i + 1) % 3] = -0.1f * (float)i;
        states[i].accumulate = (uint16_t)(i + 1);
        states[i].strain = 1.0f + 0.1f * (float)i;
        states[i].exposure = 0.3f - 0.1f * (float)i;
        states[i].tone = states[i].metering = i & 1;
        states[i].dither = (i >> 1) & 1;
        states[i].eye_offset[i % 3] = 10.0f / (3.0f + (float)i);
    }
    check_ok(gw_states_save(path, states, COUNT, &error));
    gw_states back;
    check_ok(gw_states_load(path, &back, &error));
    remove(path);
    assert_int_equal(back.count, COUNT);
    for (uint32_t i = 0; i < COUNT; i++)
        assert_memory_equal(&back.states[i], &states[i], sizeof states[i]);
    gw_states_finish(&back);
}

/* Trembling within the bounds is one view; drifting is a new one whenever the bounds are passed since its
 * first sample; an eye or a gaze beyond them at once; and a gaze that comes or goes. */
static void trembling_stands_still_and_drifting_does_not(void **state) {
    (void)state;
    gw_settings settings = defaults();
    settings.accumulate = 200;
    gw_frame_state s[2];
    uint32_t epochs[5] = {0};
    for (uint32_t kind = 0; kind < 5; kind++)
        for (uint32_t frame = 0; frame < 100; frame++) {
            gw_frame_state *now = &s[frame % 2], *before = frame ? &s[1 - frame % 2] : NULL;
            const double tremble = frame % 2 ? 0.7 : -0.7;
            const double eye[3] = {kind == 0                  ? tremble
                                   : kind == 1                ? 0.1 * frame
                                   : kind == 2 && frame >= 50 ? 5
                                                              : 0,
                                   0, 1800};
            const double target[3] = {eye[0] + (kind == 3 ? 0.3 * frame : tremble), 20, 0};
            gw_frame_begin(now, frame, &settings, 0, GW_DEBUG_NONE);
            gw_frame_stare(now, eye, kind == 4 && frame >= 50 ? NULL : target, &settings);
            gw_frame_hold(now, before, 2, 0.2);
            gw_frame_accumulate(now, before, 0);
            assert_true(fabs(now->eye[0] - eye[0]) <= 2);
            epochs[kind] = now->epoch;
        }
    assert_int_equal(epochs[0], 1);
    assert_int_equal(epochs[1], 5); /* 9.9 mm in bounds of 2 */
    assert_int_equal(epochs[2], 2);
    assert_true(epochs[3] >= 4 && epochs[3] <= 6); /* 29.7 mm at 1800, 0.95 degrees in bounds of 0.2 */
    assert_int_equal(epochs[4], 2);
    gw_frame_state held = s[1];
    gw_frame_hold(&held, NULL, 2, 0.2);
    assert_memory_equal(&held, &s[1], sizeof held);
}

/* A head that turns moves both eyes, though what lies between them stands still. */
static void a_turning_head_is_not_still(void **state) {
    (void)state;
    gw_settings settings = defaults();
    settings.accumulate = 200;
    gw_frame_state s[2];
    const double eye[3] = {0, 0, 1800};
    for (uint32_t i = 0; i < 2; i++) {
        gw_frame_begin(&s[i], i, &settings, 0, GW_DEBUG_NONE);
        gw_frame_stare(&s[i], eye, NULL, &settings);
        gw_frame_part_eyes(&s[i], NULL, 64);
        assert_true(s[i].eye_offset[0] == 32 && s[i].eye_offset[1] == 0 && s[i].eye_offset[2] == 0);
    }
    s[1].eye_offset[0] = 31.9f;
    s[1].eye_offset[1] = 2.5f;
    gw_frame_state held = s[1];
    gw_frame_hold(&held, &s[0], 2, 0.2);
    assert_memory_equal(&held, &s[1], sizeof held);
    gw_frame_hold(&held, &s[0], 3, 0.2);
    assert_memory_equal(held.eye_offset, s[0].eye_offset, sizeof held.eye_offset);
}

/* Recordings from before there were two eyes are of one. */
static void a_recording_without_eye_offset_is_mono(void **state) {
    (void)state;
    gw_settings settings = defaults();
    gw_frame_state s;
    gw_states back;
    gw_bytes bytes;
    char path[512];
    scratch_path(path, "mono-states.json");
    gw_frame_begin(&s, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&s, (const double[3]){0, 0, 1800}, NULL, &settings);
    s.accumulate = 1;
    check_ok(gw_states_save(path, &s, 1, &error));
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    char *key = memmem(bytes.data, bytes.size, ",\"eye_offset\":[0.0,0.0,0.0]", 27);
    assert_non_null(key);
    memset(key, ' ', 27);
    check_ok(gw_file_write(path, bytes.data, bytes.size, &error));
    check_ok(gw_states_load(path, &back, &error));
    assert_memory_equal(&back.states[0], &s, sizeof s);
    gw_states_finish(&back);
    gw_bytes_finish(&bytes);
    remove(path);
}

static const char *write_text(char path[512], const char *text) {
    scratch_path(path, "broken-states.json");
    check_ok(gw_file_write(path, text, strlen(text), &error));
    return path;
}

#define HEAD                                                                                                 \
    "{\"gazewall_states\": 1}\n{\"frame\": 0, \"time\": 0, \"seed\": 0, \"epoch\": 0, \"accumulate\": 1"

static void broken_recordings_are_told_by_line(void **state) {
    (void)state;
    char path[512];
    gw_states states;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "no frame state"},
        {"{\"gazewall_states\": 1}\n", "no frame state"},
        {"{\"gazewall_states\": 2}\n", ":1: no recording of frame states"},
        {"[1]\n", ":1: not a JSON object"},
        {"{\"gazewall_states\": 1}\n{\"frame\": 0\n", ":2: not a JSON object"},
        {"{\"gazewall_states\": 1}\n{\"frame\": -1}\n", ":2: 'frame' is missing or not a number"},
        {HEAD ", \"eye\": [1, 2, \"x\"]}\n", ":2: 'eye' is missing"},
        {HEAD ", \"eye\": [1, 2, 3], \"gazes\": [1, 2, 3, 4, 5]}\n", "a list of at most 4"},
        {HEAD ", \"eye\": [1, 2, 3], \"gazes\": [{\"eye\": [0, 0, 0], \"direction\": [0, 0, -2], \"up\": [0, "
              "1, 0]}]}\n",
         "'direction' has length 2, not 1"},
        {HEAD ", \"eye\": [1, 2, 3], \"gazes\": []}\n", "'tau' is missing"},
        {"{\"gazewall_states\": 1}\n{\"frame\": 0, \"time\": 0, \"seed\": 0, \"epoch\": 0, \"accumulate\": "
         "0}\n",
         ":2: 'accumulate' is missing or not a number from 1 to 256"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_text(path, cases[i].text);
        check_fails(gw_states_load(path, &states, &error), GW_BAD_INPUT, cases[i].part);
        assert_null(states.states);
    }
    remove(path);
}

static void mangled_recordings_never_break_the_reader(void **state) {
    (void)state;
    gw_settings settings;
    gw_frame_state one;
    gw_bytes bytes;
    char path[512];
    uint64_t random = 11;
    gw_settings_init(&settings);
    gw_frame_begin(&one, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&one, (const double[3]){0, 0, 1000}, (const double[3]){100, 50, 0}, &settings);
    scratch_path(path, "mangled-states.json");
    check_ok(gw_states_save(path, &one, 1, &error));
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    uint8_t *copy = malloc(bytes.size);
    assert_non_null(copy);
    for (int round = 0; round < 1000; round++) {
        memcpy(copy, bytes.data, bytes.size);
        for (int change = 0; change < 1 + round % 3; change++)
            copy[(size_t)(random_unit(&random) * (double)bytes.size)] =
                (uint8_t) "0123456789-e.,[]{}\"n"[(size_t)(random_unit(&random) * 20)];
        fuzz_states(copy, round % 4 ? bytes.size : (size_t)(random_unit(&random) * (double)bytes.size), path);
    }
    free(copy);
    gw_bytes_finish(&bytes);
    remove(path);
}

/* Samples count up while nothing changes that a pixel depends on, and start again when something does. */
static void still_views_add_up(void **state) {
    (void)state;
    gw_settings settings = defaults();
    settings.accumulate = 3;
    const double eye[3] = {0, 0, 1800}, target[3] = {10, 20, 0};
    gw_frame_state s[2];
    uint32_t epoch = 1;
    for (uint32_t frame = 0; frame < 40; frame++) {
        const uint32_t kind = frame / 5;
        gw_frame_state *now = &s[frame % 2];
        if (kind == 5)
            settings.tau = 2;
        gw_frame_begin(now, frame, &settings, kind >= 3, kind == 4 ? GW_DEBUG_RATES : GW_DEBUG_NONE);
        gw_frame_stare(now, kind == 1 ? (const double[3]){0, 1e-9, 1800} : eye, kind == 2 ? NULL : target,
                       &settings);
        now->eye[1] += kind == 6;
        now->time = frame; /* the scene stands still */
        now->gazes[0].age = now->gaze_count ? 0.001f * (float)(frame % 5) : 0;
        if (kind == 7)
            now->gazes[0].age = 1 + (float)frame; /* beyond gaze_growth_limit: no wider than before */
        gw_frame_accumulate(now, frame ? &s[1 - frame % 2] : NULL, 0);
        epoch += frame % 5 == 0 && frame > 0;
        if (now->epoch != epoch || now->accumulate != (frame % 5 < 3 ? frame % 5 + 1 : 3))
            fail_msg("frame %u: epoch %u, %u samples", frame, now->epoch, now->accumulate);
    }
    gw_frame_accumulate(&s[0], &s[1], 1); /* a scene that moves is another view at another time */
    assert_int_equal(s[0].accumulate, 1);
    settings.accumulate = 1;
    gw_frame_begin(&s[0], 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_accumulate(&s[0], &s[1], 0);
    assert_int_equal(s[0].epoch, 0);
    assert_int_equal(s[0].accumulate, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stare_is_one_gaze),
        cmocka_unit_test(up_is_across_every_gaze),
        cmocka_unit_test(the_track_speaks),
        cmocka_unit_test(still_views_add_up),
        cmocka_unit_test(trembling_stands_still_and_drifting_does_not),
        cmocka_unit_test(a_recording_gives_every_bit_back),
        cmocka_unit_test(a_turning_head_is_not_still),
        cmocka_unit_test(a_recording_without_eye_offset_is_mono),
        cmocka_unit_test(broken_recordings_are_told_by_line),
        cmocka_unit_test(mangled_recordings_never_break_the_reader),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
