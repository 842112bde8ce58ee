/* Automatic exposure without a wall: what counts of light say, and how rank 0 answers them. */
#include "tests/support/check.h"

#include "base/portable_math.h"
#include "tests/support/meshes.h"
#include "wall/exposure.h"

#include <math.h>

enum { TILES = 4, SIDE = 64, PIXELS = SIDE * SIDE };

/* As shaders/blend/tone.glsl counts. */
static void count_light(gw_luminance *luminance, float light) {
    uint32_t bits;
    memcpy(&bits, &light, sizeof bits);
    const int bin = (int)(bits >> 21) - GW_LUMINANCE_FIRST;
    luminance->counts[bin < 0 ? 0 : bin < GW_LUMINANCE_BINS ? bin : GW_LUMINANCE_BINS - 1]++;
}

static gw_luminance flat(float light) {
    gw_luminance all = {{0}};
    for (int i = 0; i < PIXELS; i++)
        count_light(&all, light);
    return all;
}

static gw_exposure automatic(void) {
    gw_settings settings;
    gw_exposure exposure;
    gw_settings_init(&settings);
    check_ok(gw_settings_assign(&settings, "exposure=auto", &error));
    gw_exposure_init(&exposure, &settings);
    return exposure;
}

static double decide(gw_exposure *exposure, double seconds) {
    gw_frame_state state = {.time = (int64_t)(seconds * 1e9)};
    gw_exposure_decide(exposure, &state);
    return (double)state.exposure;
}

static void counts_add_up_in_any_order_and_split(void **state) {
    static float light[PIXELS];
    gw_luminance forward = {{0}}, backward = {{0}}, parts[6] = {{{0}}}, sum = {{0}};
    uint64_t random = 7;
    (void)state;
    for (int i = 0; i < PIXELS; i++)
        light[i] = i % 9 ? (float)exp2(14 * gw_test_random(&random) - 10) : 0;
    for (int i = 0; i < PIXELS; i++) {
        count_light(&forward, light[i]);
        count_light(&backward, light[PIXELS - 1 - i]);
        count_light(&parts[i * 7 % 6], light[i]);
    }
    assert_memory_equal(&forward, &backward, sizeof forward);
    for (int i = 5; i >= 0; i--)
        gw_luminance_add(&sum, &parts[i]);
    assert_memory_equal(&forward, &sum, sizeof forward);
    assert_int_equal(gw_luminance_pixels(&sum), PIXELS);
    /* What could overflow stays at the most. */
    sum.counts[3] = UINT32_MAX - 1;
    parts[0].counts[3] = 5;
    gw_luminance_add(&sum, &parts[0]);
    assert_true(sum.counts[3] == UINT32_MAX);
}

static void the_mean_leaves_out_black_and_the_ends(void **state) {
    double mean = 77;
    gw_luminance light = {{0}};
    (void)state;
    assert_int_equal(gw_luminance_mean(&light, &mean), 0);
    light.counts[0] = 1000;
    assert_int_equal(gw_luminance_mean(&light, &mean), 0);
    assert_true(mean == 77);
    light = flat(0.18f);
    light.counts[0] += 3 * PIXELS;
    assert_int_equal(gw_luminance_mean(&light, &mean), 1);
    assert_true(fabs(mean - log2(0.18)) < 0.2);
    /* A lamp in 4 % of the pixels and a cellar in 9 % move nothing: without the ends left out, by a stop. */
    const double alone = mean;
    for (int i = 0; i < PIXELS * 4 / 100; i++)
        count_light(&light, 2000);
    for (int i = 0; i < PIXELS * 9 / 100; i++)
        count_light(&light, 0.0001f);
    gw_luminance_mean(&light, &mean);
    assert_true(fabs(mean - alone) < 1e-9);
}

/* A step in brightness, up and down: at most exposure_speed, never beyond where it ends, and there within the
 * time that the way takes. */
static void a_step_is_followed_without_overshoot(void **state) {
    (void)state;
    gw_exposure exposure = automatic();
    const gw_luminance lit = flat(0.5f), dim = flat(0.5f / 64);
    gw_exposure_note(&exposure, 0, &lit, PIXELS);
    const double first = decide(&exposure, 0);
    assert_true(fabs(first - log2(0.18 / 0.5)) < 0.2); /* at once, the first time */
    double last = first;
    for (int down = 0; down < 2; down++) {
        const double end = down ? first : first + 6;
        gw_exposure_note(&exposure, 0, down ? &lit : &dim, PIXELS);
        for (int frame = 1; frame <= 65; frame++) {
            const double stops = decide(&exposure, (66 * down + frame) / 30.0);
            assert_true(fabs(stops - last) <= 3 / 30.0 * (1 + (frame == 1)) + 1e-5);
            assert_true(down ? stops <= last && stops >= end - 1e-5 : stops >= last && stops <= end + 1e-5);
            last = stops;
        }
        assert_true(fabs(last - end) < GW_EXPOSURE_REST);
    }
    /* A flicker below the threshold moves nothing. */
    gw_luminance nearly = lit;
    count_light(&nearly, 0.4f);
    gw_exposure_note(&exposure, 0, &nearly, PIXELS);
    assert_true(decide(&exposure, 10) == last);
    /* Where the frames' time stands still, at once. */
    gw_exposure_note(&exposure, 0, &dim, PIXELS);
    assert_true(fabs(decide(&exposure, 10) - (first + 6)) < 1e-5);
}

/* A tile that says nothing keeps its last count; one that lies is not believed; and one exposure for all is
 * not what each tile would choose. */
static void tiles_have_one_exposure(void **state) {
    static const float lights[TILES] = {0.02f, 0.1f, 0.6f, 3.0f};
    (void)state;
    gw_exposure exposure = automatic();
    double least = 1e9, most = -1e9;
    for (uint32_t i = 0; i < TILES; i++) {
        const gw_luminance light = flat(lights[i]);
        assert_int_equal(gw_exposure_note(&exposure, i, &light, PIXELS), 1);
        gw_exposure naive = automatic(); /* a tile for itself */
        gw_exposure_note(&naive, 0, &light, PIXELS);
        const double own = decide(&naive, 0);
        least = fmin(least, own);
        most = fmax(most, own);
    }
    assert_true(most - least > 6);
    const double all = decide(&exposure, 0);
    assert_true(all > least + 1 && all < most - 1);
    gw_luminance lie = flat(1000);
    lie.counts[100] = UINT32_MAX;
    assert_int_equal(gw_exposure_note(&exposure, 2, &lie, PIXELS), 0);
    for (int frame = 1; frame < 4; frame++)
        assert_true(decide(&exposure, frame) == all);
    /* One tile for the whole wall, or many: the same. */
    gw_luminance whole = {{0}};
    for (uint32_t i = 0; i < TILES; i++) {
        const gw_luminance light = flat(lights[i]);
        gw_luminance_add(&whole, &light);
    }
    gw_exposure one = automatic();
    gw_exposure_note(&one, 0, &whole, TILES * PIXELS);
    assert_true(decide(&one, 0) == all);
}

static void a_given_exposure_is_left_alone(void **state) {
    gw_settings settings;
    gw_exposure exposure;
    gw_frame_state frame = {0};
    (void)state;
    gw_settings_init(&settings);
    check_ok(gw_settings_assign(&settings, "exposure=-2.5", &error));
    gw_frame_state_apply(&frame, &settings);
    assert_true(frame.exposure == -2.5f && !frame.metering);
    gw_exposure_init(&exposure, &settings);
    const gw_luminance dim = flat(0.001f);
    gw_exposure_note(&exposure, 0, &dim, PIXELS);
    gw_exposure_decide(&exposure, &frame);
    assert_true(frame.exposure == -2.5f);
    check_ok(gw_settings_assign(&settings, "exposure=auto", &error));
    gw_frame_state_apply(&frame, &settings);
    assert_true(frame.exposure == 0 && frame.metering);
}

static void powers_of_two_are_exact_enough(void **state) {
    (void)state;
    for (double x = -30; x <= 30; x += 0.0703125)
        assert_true(fabs(gw_exp2(x) / exp2(x) - 1) < 4e-16);
    for (int i = -24; i <= 24; i++)
        assert_true(gw_exp2(i) == ldexp(1, i));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_add_up_in_any_order_and_split),
        cmocka_unit_test(the_mean_leaves_out_black_and_the_ends),
        cmocka_unit_test(a_step_is_followed_without_overshoot),
        cmocka_unit_test(tiles_have_one_exposure),
        cmocka_unit_test(a_given_exposure_is_left_alone),
        cmocka_unit_test(powers_of_two_are_exact_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
