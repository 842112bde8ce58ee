/* Sums over a whole wall, as metrics take them: within the bounds of their arithmetic, where sums in floats
 * are not. */
#include "tests/support/check.h"

#include "render/metrics.h"

#include <math.h>

/* 3840 x 2160. */
enum { WIDE = 3840, HIGH = 2160, PIXELS = WIDE * HIGH };

static const float dim = 1e-3f, bright = 1e8f;

/* One pixel of 1e8 among 1e-3. */
static float *make_light(float scale) {
    float *light = malloc((size_t)PIXELS * 3 * sizeof *light);
    assert_non_null(light);
    for (size_t i = 0; i < (size_t)PIXELS * 3; ++i)
        light[i] = dim * scale;
    for (size_t c = 0; c < 3; ++c)
        light[(size_t)PIXELS / 2 * 3 + c] = bright;
    return light;
}

/* The dim pixels are a tenth brighter: that must be seen beside a pixel that outshines all of them together.
 */
static void eight_million_pixels_add_up(void **state) {
    (void)state;
    float *reference = make_light(1), *test = make_light(1.1f);
    const gw_metric_frame a = {.width = WIDE, .height = HIGH, .light = reference},
                          b = {.width = WIDE, .height = HIGH, .light = test};
    const gw_metric_view view = {.pixels_per_degree = 60};
    gw_metrics out;
    check_ok(gw_metrics_compare(&a, &b, &view, &out, &error));
    double change = (double)(dim * 1.1f) - (double)dim, wanted = change * (PIXELS - 1) / PIXELS;
    assert_true(fabs(out.values[GW_METRIC_BIAS] / wanted - 1) < 1e-9);
    double square = change * change / ((double)dim * (double)dim + 0.01) * (PIXELS - 1) / PIXELS;
    assert_true(fabs(out.values[GW_METRIC_RELATIVE_SQUARE] / square - 1) < 1e-9);
    /* Alternating signs cancel. */
    for (size_t i = 0; i < (size_t)PIXELS * 3; ++i)
        test[i] = reference[i] + (i / 3 % 2 ? dim : -dim);
    for (size_t c = 0; c < 3; ++c)
        test[(size_t)PIXELS / 2 * 3 + c] = bright;
    check_ok(gw_metrics_compare(&a, &b, &view, &out, &error));
    assert_true(fabs(out.values[GW_METRIC_BIAS]) < 2 * (double)dim / PIXELS);
    free(reference);
    free(test);
}

static void naive_sums_lose_the_dim(void **state) {
    (void)state;
    float sum = 0, stuck = 0;
    for (int i = 0; i < PIXELS; ++i) {
        sum += i == PIXELS / 2 ? bright : dim;
        stuck += 0.1f * dim;
    }
    double wanted = (double)bright + (double)dim * (PIXELS - 1), change = 0.1 * (double)dim * PIXELS;
    print_message("a float's sum is off by %.0f of %.0f, and of the change alone by %.0f %%\n",
                  fabs((double)sum - wanted), wanted, 100 * fabs((double)stuck / change - 1));
    assert_true(fabs((double)sum - wanted) > 1000);
    assert_true(fabs((double)stuck / change - 1) > 0.01);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eight_million_pixels_add_up),
        cmocka_unit_test(naive_sums_lose_the_dim),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
