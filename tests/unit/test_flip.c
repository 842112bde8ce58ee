/* FLIP against values that follow from its paper, and its behaviour on hostile pairs. */
#include "tests/support/check.h"

#include "render/flip.h"
#include "tests/support/meshes.h"

#include <math.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };

static gw_image filled(uint8_t r, uint8_t g, uint8_t b) {
    gw_image image = {0};
    check_ok(gw_image_create(SIDE, SIDE, &image, &error));
    for (size_t i = 0; i < PIXELS; ++i) {
        image.rgba[i * 4] = r;
        image.rgba[i * 4 + 1] = g;
        image.rgba[i * 4 + 2] = b;
        image.rgba[i * 4 + 3] = 255;
    }
    return image;
}

static double flip_of(const gw_image *a, const gw_image *b) {
    double mean = -1;
    check_ok(gw_flip(a, b, GW_FLIP_PIXELS_PER_DEGREE, NULL, &mean, &error));
    return mean;
}

static double flip_of_colors(const uint8_t a[3], const uint8_t b[3]) {
    gw_image first = filled(a[0], a[1], a[2]), second = filled(b[0], b[1], b[2]);
    double mean = flip_of(&first, &second);
    gw_image_finish(&first);
    gw_image_finish(&second);
    return mean;
}

/* Uniform pictures have no features, so FLIP is the redistributed HyAB error, which the paper defines:
 * green against blue is 1; black against white is HyAB 100, and 100^0.7 of the largest error 203.4^0.7
 * lies beyond the knee at 0.4: 0.95 + 0.05 (100^0.7 - 0.4 L) / (0.6 L), L = 203.4^0.7, which is 0.967. */
static void uniform_pictures_have_the_papers_values(void **state) {
    const uint8_t black[3] = {0, 0, 0}, white[3] = {255, 255, 255}, green[3] = {0, 255, 0},
                  blue[3] = {0, 0, 255};
    (void)state;
    assert_true(fabs(flip_of_colors(green, blue) - 1) < 1e-4);
    assert_true(fabs(flip_of_colors(blue, green) - 1) < 1e-4);
    assert_true(fabs(flip_of_colors(black, white) - 0.967) < 1e-3);
    assert_true(flip_of_colors(white, white) == 0);
}

/* One step of 255 in middle grey is 0.4 of L*: 0.4^0.7 * 0.95 / (0.4 L) = 0.03. */
static void the_smallest_step_is_small(void **state) {
    const uint8_t a[3] = {119, 119, 119}, b[3] = {120, 120, 120};
    (void)state;
    double step = flip_of_colors(a, b);
    assert_true(step > 0.02 && step < 0.04);
}

/* Noise of twice the strength is seen more; noise finer than the eye resolves, less than coarse noise. */
static void noise_ranks_as_the_eye_sees_it(void **state) {
    gw_image grey = filled(128, 128, 128);
    double seen[3];
    (void)state;
    for (int kind = 0; kind < 3; ++kind) {
        gw_image noisy = filled(128, 128, 128);
        uint64_t random = 1;
        int cell = kind == 2 ? 8 : 1;
        int strength = kind == 1 ? 24 : 12;
        for (int y = 0; y < SIDE; y += cell)
            for (int x = 0; x < SIDE; x += cell) {
                uint8_t value = (uint8_t)(gw_test_random(&random) < 0.5 ? 128 - strength : 128 + strength);
                for (int v = y; v < y + cell; ++v)
                    for (int u = x; u < x + cell; ++u)
                        memset(noisy.rgba + ((size_t)v * SIDE + (size_t)u) * 4, value, 3);
            }
        seen[kind] = flip_of(&grey, &noisy);
        gw_image_finish(&noisy);
    }
    assert_true(seen[1] > 1.2 * seen[0]);
    assert_true(seen[2] > 1.2 * seen[0]);
    gw_image_finish(&grey);
}

/* A line that is there in one picture only counts more than the same energy spread out: features. */
static void a_missing_line_is_noticed(void **state) {
    gw_image plain = filled(100, 100, 100), line = filled(100, 100, 100), spread = filled(102, 102, 102);
    float *map = calloc(PIXELS, sizeof *map);
    double mean;
    (void)state;
    assert_non_null(map);
    for (int y = 0; y < SIDE; ++y)
        memset(line.rgba + ((size_t)y * SIDE + SIDE / 2) * 4, 220, 3);
    check_ok(gw_flip(&plain, &line, GW_FLIP_PIXELS_PER_DEGREE, map, &mean, &error));
    assert_true(map[SIDE / 2 * SIDE + SIDE / 2] > 0.3f);
    assert_true(map[SIDE / 2 * SIDE + 2] < 0.01f);
    assert_true(mean > 0 && flip_of(&plain, &spread) < (double)map[SIDE / 2 * SIDE + SIDE / 2]);
    gw_image_finish(&plain);
    gw_image_finish(&line);
    gw_image_finish(&spread);
    free(map);
}

/* From farther away the same pair differs less. */
static void distance_hides_fine_detail(void **state) {
    gw_image grey = filled(128, 128, 128), stripes = filled(128, 128, 128);
    double near, far;
    (void)state;
    for (size_t i = 0; i < PIXELS; ++i) /* of the same mean light */
        memset(stripes.rgba + i * 4, i % 2 ? 98 : 152, 3);
    check_ok(gw_flip(&grey, &stripes, 20, NULL, &near, &error));
    check_ok(gw_flip(&grey, &stripes, 120, NULL, &far, &error));
    assert_true(far < 0.5 * near);
    gw_image_finish(&grey);
    gw_image_finish(&stripes);
}

static void wrong_pairs_are_refused(void **state) {
    gw_image a = filled(0, 0, 0), b = a;
    double mean;
    (void)state;
    b.width = SIDE / 2;
    check_fails(gw_flip(&a, &b, 67, NULL, &mean, &error), GW_BAD_INPUT, "cannot be compared");
    check_fails(gw_flip(&a, &a, 0, NULL, &mean, &error), GW_BAD_INPUT, "pixels per degree");
    check_fails(gw_flip(&a, &a, NAN, NULL, &mean, &error), GW_BAD_INPUT, "pixels per degree");
    gw_image_finish(&a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uniform_pictures_have_the_papers_values),
        cmocka_unit_test(the_smallest_step_is_small),
        cmocka_unit_test(noise_ranks_as_the_eye_sees_it),
        cmocka_unit_test(a_missing_line_is_noticed),
        cmocka_unit_test(distance_hides_fine_detail),
        cmocka_unit_test(wrong_pairs_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
