/* The acuity filter: sharp where the viewer looks, and periods that nobody resolves lose their contrast. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/acuity_filter.h"
#include "render/sparse.h"

#include <math.h>

enum { WIDTH = 400, HEIGHT = 24 };

/* A wall 2 m before the viewer, 1 mm a pixel; somebody looks at its left end. */
static gw_frame_block block_of(uint32_t gazes) {
    gw_scene scene = {0};
    gw_octree octree = {.depth = 1};
    gw_frame_block block;
    gw_frame_state state;
    gw_settings settings;
    const gw_similarity placement = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1000};
    const gw_plane plane = {.corner = {0, 0, -2000}, .step_x = {1, 0, 0}, .step_y = {0, -1, 0}};
    memset(&state, 0, sizeof state);
    gw_settings_init(&settings);
    settings.acuity_slope = 0.2; /* far beyond any eye, so that a small picture has all of it */
    settings.gaze_margin = 0;
    gw_frame_state_apply(&state, &settings);
    state.gaze_count = gazes;
    state.gazes[0] = (gw_gaze){
        .direction = {0, 0, -1}, .up = {0, 1, 0}, .half_width = 1, .half_height = 1, .confidence = 1};
    check_ok(gw_frame_block_fill(&scene, &octree, &placement, &plane, &state, &block, NULL, &error));
    return block;
}

/* Vertical stripes of a period in pixels, sinusoidal in linear light about 0.25 with this amplitude. */
static gw_image stripes(double period, double amplitude) {
    gw_image image;
    check_ok(gw_image_create(WIDTH, HEIGHT, &image, &error));
    for (size_t i = 0; i < WIDTH * HEIGHT; ++i) {
        double linear = 0.25 + amplitude * cos(2 * acos(-1) * (double)(i % WIDTH) / period);
        memset(image.rgba + i * 4, gw_srgb_code_from_linear(linear), 3);
    }
    return image;
}

static double linear_at(const gw_image *image, int x) {
    return gw_srgb_code_to_linear(image->rgba[((size_t)HEIGHT / 2 * WIDTH + (size_t)x) * 4]);
}

static double contrast_near(const gw_image *image, int x, int period) {
    double least = 1, most = 0;
    for (int u = x - period; u <= x + period; ++u) {
        least = fmin(least, linear_at(image, u));
        most = fmax(most, linear_at(image, u));
    }
    return (most - least) / 2;
}

static void nobody_looking_changes_nothing(void **state) {
    gw_frame_block block = block_of(0);
    gw_image in = stripes(4, 0.2), out;
    (void)state;
    assert_true(isinf(gw_sparse_spacing(&block, 10, 10)));
    check_ok(gw_acuity_filter(&in, &block, &out, &error));
    assert_memory_equal(in.rgba, out.rgba, WIDTH * HEIGHT * 4);
    gw_image_finish(&in);
    gw_image_finish(&out);
}

static void an_even_picture_stays(void **state) {
    gw_frame_block block = block_of(1);
    gw_image in = stripes(1, 0), out;
    (void)state;
    check_ok(gw_acuity_filter(&in, &block, &out, &error));
    assert_memory_equal(in.rgba, out.rgba, WIDTH * HEIGHT * 4);
    gw_image_finish(&in);
    gw_image_finish(&out);
}

/* Where the eye looks, the stripes keep their contrast; where their period is the shortest that is resolved,
 * it is halved; farther out it is gone. */
static void contrast_falls_with_eccentricity(void **state) {
    enum { PERIOD = 16 };
    gw_frame_block block = block_of(1);
    gw_image in = stripes(PERIOD, 0.2), out;
    int limit = 0;
    (void)state;
    while (limit < WIDTH && 2 * gw_sparse_spacing(&block, limit + 0.5, HEIGHT / 2) < PERIOD)
        limit++;
    assert_true(limit > 3 * PERIOD && limit < WIDTH - 3 * PERIOD);
    check_ok(gw_acuity_filter(&in, &block, &out, &error));
    assert_true(contrast_near(&out, 20, PERIOD) > 0.95 * 0.2);
    assert_true(fabs(contrast_near(&out, limit, PERIOD / 2) - 0.1) < 0.025);
    assert_true(contrast_near(&out, WIDTH - 2 * PERIOD, PERIOD) < 0.02);
    gw_image_finish(&in);
    gw_image_finish(&out);
}

/* A Gaussian of deviation s turns a sine of period p into one of exp(-2 pi^2 s^2 / p^2) of its amplitude.
 * With s from the period P that the eye just resolves (Guenter et al. 2012: P / 2 = MAR(e') / 2 on the wall),
 * this is 2^-(P/p)^2: a half at p = P, a sixteenth at p = P / 2. Every pixel of the stripes is compared, from
 * the gaze to 11 degrees beside it. */
static void stripes_lose_what_the_gaussian_says(void **state) {
    static const double periods[] = {6, 9, 16, 31};
    gw_frame_block block = block_of(1);
    (void)state;
    for (size_t p = 0; p < sizeof periods / sizeof *periods; ++p) {
        gw_image in = stripes(periods[p], 0.2), out;
        int compared[3] = {0, 0, 0}; /* with nearly all, about half and next to nothing of the contrast */
        check_ok(gw_acuity_filter(&in, &block, &out, &error));
        for (int x = 20; x < WIDTH - 120; ++x) {
            double resolved = 2 * gw_sparse_spacing(&block, x + 0.5, HEIGHT / 2 + 0.5);
            double left =
                resolved * 0.18739 < 0.25 ? 1 : exp2(-(resolved / periods[p]) * (resolved / periods[p]));
            double expected = 0.25 + 0.2 * left * cos(2 * acos(-1) * x / periods[p]);
            /* Below half a pixel of deviation sampling the Gaussian shows; not below what is left alone. */
            if (resolved * 0.18739 > 0.5 || resolved * 0.18739 < 0.25)
                assert_true(fabs(linear_at(&out, x) - expected) < 0.008); /* two steps of 8 bits */
            compared[left > 0.9 ? 0 : left < 0.1 ? 2 : 1]++;
        }
        assert_true(compared[0] > 0 || periods[p] < 10);
        assert_true(compared[1] > 20);
        assert_true(compared[2] > 20 || periods[p] > 20);
        gw_image_finish(&in);
        gw_image_finish(&out);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_looking_changes_nothing),
        cmocka_unit_test(an_even_picture_stays),
        cmocka_unit_test(contrast_falls_with_eccentricity),
        cmocka_unit_test(stripes_lose_what_the_gaussian_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
