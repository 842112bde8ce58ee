/* The metrics against values that follow from their definitions, against slow second implementations, and on
 * hostile pairs. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/gpu_types.h"
#include "render/distance_transform.h"
#include "render/metrics.h"
#include "tests/support/meshes.h"

#include <math.h>

enum { WIDTH = 40, HEIGHT = 24, PIXELS = WIDTH * HEIGHT };
static const gw_metric_view desk = {.pixels_per_degree = 60};

static gw_image picture_of(uint32_t width, uint32_t height, uint64_t seed) {
    gw_image image = {0};
    uint64_t random = seed;
    check_ok(gw_image_create(width, height, &image, &error));
    for (size_t i = 0; i < (size_t)width * height; ++i)
        for (size_t c = 0; c < 4; ++c) {
            const double wave =
                110 + 50 * sin(0.3 * (double)(i % width)) + 30 * cos(0.2 * (double)(i / width));
            image.rgba[i * 4 + c] = (uint8_t)(c == 3 ? 255 : wave + 15 * (double)c * gw_test_random(&random));
        }
    return image;
}

static gw_metrics compare_pictures(const gw_image *a, const gw_image *b) {
    const gw_metric_frame reference = {.width = a->width, .height = a->height, .picture = a},
                          test = {.width = b->width, .height = b->height, .picture = b};
    gw_metrics out;
    check_ok(gw_metrics_compare(&reference, &test, &desk, &out, &error));
    return out;
}

static double changed_by(gw_image *image, int channel, int step, gw_metric metric) {
    gw_image other = {0};
    check_ok(gw_image_create(image->width, image->height, &other, &error));
    for (size_t i = 0; i < (size_t)image->width * image->height * 4; ++i)
        other.rgba[i] = (uint8_t)(image->rgba[i] + ((int)(i % 4) == channel || channel == 3 ? step : 0));
    const double value = compare_pictures(image, &other).values[metric];
    gw_image_finish(&other);
    return value;
}

static void identical_frames_are_perfect(void **state) {
    gw_image image = picture_of(WIDTH, HEIGHT, 1);
    float light[PIXELS * 3], depths[PIXELS], normals[PIXELS * 3];
    uint32_t ids[PIXELS];
    (void)state;
    for (size_t i = 0; i < PIXELS; ++i) {
        ids[i] = i % WIDTH < 10 ? GW_NO_TRIANGLE : 3;
        depths[i] = 2 + (float)i;
        for (size_t c = 0; c < 3; ++c) {
            light[i * 3 + c] = 1e6f * (float)(i % 7); /* HDR */
            normals[i * 3 + c] = (float)c - 1;
        }
    }
    const gw_metric_frame frame = {WIDTH, HEIGHT, &image, light, ids, depths, normals};
    const gw_metric_view view = {.pixels_per_degree = 60, .baseline = 65};
    gw_metrics out;
    gw_metric_track track = {0};
    check_ok(gw_metric_track_add(&track, &frame, &frame, &view, NULL, &error));
    check_ok(gw_metric_track_add(&track, &frame, &frame, &view, NULL, &error));
    gw_metric_track_of(&track, &out);
    for (int i = 0; i < GW_METRIC_COUNT; ++i) {
        const int of_viewers = i == GW_METRIC_SEEN_FLIP || i == GW_METRIC_SEEN_PSNR ||
                               i == GW_METRIC_SEEN_FLICKER || i == GW_METRIC_SEEN_POP;
        if (of_viewers ? !isnan(out.values[i]) : !(gw_metric_badness((gw_metric)i, out.values[i]) == 0))
            fail_msg("%s of identical frames is %g", gw_metric_table[i].name, out.values[i]);
    }
    gw_metric_track_finish(&track);
    gw_image_finish(&image);
}

/* One code everywhere: the mean square is 1, so PSNR is 20 log10(255); a step of one channel of three adds
 * 10 log10 3 to that of all. */
static void the_smallest_step_is_what_it_is(void **state) {
    gw_image image = picture_of(WIDTH, HEIGHT, 1);
    (void)state;
    assert_true(fabs(changed_by(&image, 3, 1, GW_METRIC_PSNR) - 48.130804) < 1e-5);
    assert_true(fabs(changed_by(&image, 1, 1, GW_METRIC_PSNR) - 48.130804 - 4.771213) < 1e-5);
    assert_true(fabs(changed_by(&image, 1, 1, GW_METRIC_PSNR_GREEN) - 48.130804) < 1e-5);
    assert_true(isinf(changed_by(&image, 1, 1, GW_METRIC_PSNR_RED)));
    assert_true(changed_by(&image, 3, 1, GW_METRIC_CHANGED) == 1);
    assert_true(changed_by(&image, 3, 1, GW_METRIC_LARGEST) == 1);
    const double ssim = changed_by(&image, 3, 1, GW_METRIC_SSIM);
    assert_true(ssim > 0.999 && ssim < 1);
    gw_image_finish(&image);
}

/* A metric that ignored signs would give the same twice. */
static void the_sign_of_a_bias_is_kept(void **state) {
    gw_image image = picture_of(WIDTH, HEIGHT, 1);
    (void)state;
    for (int c = 0; c < 4; ++c) {
        const gw_metric metric = c == 3 ? GW_METRIC_BIAS : (gw_metric)(GW_METRIC_BIAS_RED + c);
        const double up = changed_by(&image, c, 2, metric), down = changed_by(&image, c, -2, metric);
        assert_true(up > 0 && down < 0 && fabs(up + down) < 0.1 * up);
        assert_true(changed_by(&image, 3, 2, metric) > 0);
        assert_true(c == 3 || changed_by(&image, (c + 1) % 3, 2, metric) == 0);
    }
    gw_image_finish(&image);
}

/* --- structure, by another road: every window by itself, in two dimensions -------------------------------
 */

static double direct_ssim(const gw_image *a, const gw_image *b, int channel) {
    double total = 0, windows = 0;
    for (uint32_t y = 5; y + 5 < a->height; ++y)
        for (uint32_t x = 5; x + 5 < a->width; ++x, ++windows) {
            double weights = 0, means[2] = {0, 0}, covariances[3] = {0, 0, 0};
            for (int pass = 0; pass < 2; ++pass)
                for (int v = -5; v <= 5; ++v)
                    for (int u = -5; u <= 5; ++u) {
                        const size_t at = ((size_t)((int)y + v) * a->width + (size_t)((int)x + u)) * 4;
                        const double weight = exp(-(u * u + v * v) / 4.5);
                        const uint8_t *p = a->rgba + at, *q = b->rgba + at;
                        const double s =
                            channel < 3 ? p[channel] : 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
                        const double t =
                            channel < 3 ? q[channel] : 0.299 * q[0] + 0.587 * q[1] + 0.114 * q[2];
                        if (pass == 0) {
                            weights += weight;
                            means[0] += weight * s;
                            means[1] += weight * t;
                        } else {
                            const double ds = s - means[0] / weights, dt = t - means[1] / weights;
                            covariances[0] += weight * ds * ds / weights;
                            covariances[1] += weight * dt * dt / weights;
                            covariances[2] += weight * ds * dt / weights;
                        }
                    }
            const double s = means[0] / weights, t = means[1] / weights;
            total += (2 * s * t + 6.5025) * (2 * covariances[2] + 58.5225) /
                     ((s * s + t * t + 6.5025) * (covariances[0] + covariances[1] + 58.5225));
        }
    return total / windows;
}

static void ssim_is_the_sum_over_windows(void **state) {
    gw_image a = picture_of(WIDTH, HEIGHT, 1), b = picture_of(WIDTH, HEIGHT, 7);
    (void)state;
    const gw_metrics out = compare_pictures(&a, &b);
    for (int c = 0; c < 4; ++c) {
        const double wanted = direct_ssim(&a, &b, c),
                     got = out.values[c < 3 ? GW_METRIC_SSIM_RED + c : GW_METRIC_SSIM];
        print_message("# channel %d: %.6f\n", c, got);
        assert_true(fabs(got - wanted) < 1e-9);
        assert_true(c == 0 ? wanted > 0.99 : wanted < 0.999); /* red of both is the same */
    }
    gw_image_finish(&a);
    gw_image_finish(&b);
}

/* --- geometry --------------------------------------------------------------------------------------------
 */

/* Two discs, the second larger and aside. */
static void fill_disc(uint32_t *ids, double x, double y, double radius) {
    for (int i = 0; i < PIXELS; ++i)
        ids[i] = hypot(i % WIDTH - x, i / WIDTH - y) <= radius ? 1 : GW_NO_TRIANGLE;
}

static int on_outline(const uint32_t *ids, int x, int y) {
    static const int sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (int i = 0; i < 4 && ids[y * WIDTH + x] == 1; ++i) {
        const int u = x + sides[i][0], v = y + sides[i][1];
        if (u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT && ids[v * WIDTH + u] != 1)
            return 1;
    }
    return 0;
}

/* Both loops over all pairs of outline pixels. */
static double direct_hausdorff(const uint32_t *a, const uint32_t *b) {
    double worst = 0;
    for (int i = 0; i < PIXELS; ++i) {
        double nearest = INFINITY;
        if (!on_outline(a, i % WIDTH, i / WIDTH))
            continue;
        for (int j = 0; j < PIXELS; ++j)
            if (on_outline(b, j % WIDTH, j / WIDTH))
                nearest = fmin(nearest, hypot(i % WIDTH - j % WIDTH, i / WIDTH - j / WIDTH));
        worst = fmax(worst, nearest);
    }
    return worst;
}

static gw_metrics compare_ids(const uint32_t *a, const uint32_t *b) {
    const gw_metric_frame reference = {.width = WIDTH, .height = HEIGHT, .ids = a},
                          test = {.width = WIDTH, .height = HEIGHT, .ids = b};
    gw_metrics out;
    check_ok(gw_metrics_compare(&reference, &test, &desk, &out, &error));
    return out;
}

static void silhouettes_are_as_far_as_the_loops_say(void **state) {
    uint32_t a[PIXELS], b[PIXELS];
    (void)state;
    for (int k = 0; k < 6; ++k) {
        fill_disc(a, 12, 11, 5 + k);
        fill_disc(b, 14 + 3 * k, 12, 9 - k);
        const double wanted = fmax(direct_hausdorff(a, b), direct_hausdorff(b, a));
        const gw_metrics out = compare_ids(a, b);
        size_t differing = 0;
        for (int i = 0; i < PIXELS; ++i)
            differing += a[i] != b[i];
        assert_true(fabs(out.values[GW_METRIC_SILHOUETTE_LARGEST] - wanted) < 1e-5);
        assert_true(out.values[GW_METRIC_SILHOUETTE_MEAN] <= wanted);
        assert_true(fabs(out.values[GW_METRIC_HIT_MISMATCH] * PIXELS - (double)differing) < 1e-9);
    }
    fill_disc(a, -100, 0, 1); /* nothing */
    assert_true(fabs(compare_ids(a, b).values[GW_METRIC_SILHOUETTE_LARGEST] - hypot(WIDTH, HEIGHT)) < 1e-9);
    assert_true(isnan(compare_ids(a, a).values[GW_METRIC_SILHOUETTE_LARGEST]));
}

static void distances_are_exact(void **state) {
    enum { W = 37, H = 23 };
    uint8_t marked[W * H];
    float squares[W * H];
    uint64_t random = 3;
    (void)state;
    for (int round = 0; round < 4; ++round) {
        for (int i = 0; i < W * H; ++i)
            marked[i] = gw_test_random(&random) < (round == 0 ? 0 : 0.003 * pow(6, round));
        marked[5] |= round > 0;
        check_ok(gw_distance_transform(marked, W, H, squares, &error));
        for (int i = 0; i < W * H; ++i) {
            double nearest = INFINITY;
            for (int j = 0; j < W * H; ++j)
                if (marked[j])
                    nearest =
                        fmin(nearest, (i % W - j % W) * (i % W - j % W) + (i / W - j / W) * (i / W - j / W));
            assert_true((double)squares[i] == nearest);
        }
    }
}

/* Depth: a hundredth of the distance is 0.01 rad, 0.573 degrees, at 60 px a degree 34.4 px; its sign, what it
 * moves for an eye 65 mm aside at 2 m, and 5 % of pixels ten times as wrong. */
static void depths_and_normals_in_their_units(void **state) {
    float near[PIXELS], far[PIXELS], up[PIXELS * 3], tilted[PIXELS * 3];
    uint32_t ids[PIXELS];
    const double degree = 0.017453292519943295;
    gw_metrics out;
    (void)state;
    for (size_t i = 0; i < PIXELS; ++i) {
        const int outlier = i % 20 == 0;
        near[i] = 2000;
        far[i] = outlier ? 2200 : 2020;
        ids[i] = (uint32_t)i;
        for (size_t c = 0; c < 3; ++c)
            up[i * 3 + c] = c == 2;
        tilted[i * 3] = (float)sin((outlier ? 30 : 1e-3) * degree);
        tilted[i * 3 + 1] = 0;
        tilted[i * 3 + 2] = (float)cos((outlier ? 30 : 1e-3) * degree);
    }
    const gw_metric_frame reference = {WIDTH, HEIGHT, NULL, NULL, ids, near, up},
                          test = {WIDTH, HEIGHT, NULL, NULL, ids, far, tilted};
    const gw_metric_view view = {.pixels_per_degree = 60, .baseline = 65};
    check_ok(gw_metrics_compare(&reference, &test, &view, &out, &error));
    const double px = 60 / degree;
    assert_true(fabs(out.values[GW_METRIC_DEPTH_95] - 0.01 * px) < 1e-3);
    assert_true(fabs(out.values[GW_METRIC_DEPTH_LARGEST] - 0.1 * px) < 1e-2);
    assert_true(fabs(out.values[GW_METRIC_DEPTH_MEAN] - (0.95 * 0.01 + 0.05 * 0.1) * px) < 1e-2);
    assert_true(fabs(out.values[GW_METRIC_DEPTH_BIAS] - out.values[GW_METRIC_DEPTH_MEAN]) < 1e-6);
    assert_true(fabs(out.values[GW_METRIC_PARALLAX_LARGEST] - 65 * (1 / 2000.0 - 1 / 2200.0) * px) < 1e-3);
    assert_true(fabs(out.values[GW_METRIC_NORMAL_95] - 1e-3) < 1e-6);
    assert_true(fabs(out.values[GW_METRIC_NORMAL_LARGEST] - 30) < 1e-4);
    assert_true(fabs(out.values[GW_METRIC_NORMAL_MEAN] - (0.95 * 1e-3 + 0.05 * 30)) < 1e-4);
    check_ok(gw_metrics_compare(&test, &reference, &view, &out, &error));
    assert_true(out.values[GW_METRIC_DEPTH_BIAS] < 0 && out.values[GW_METRIC_DEPTH_MEAN] > 0);
    ids[0] = GW_NO_TRIANGLE; /* an outlier that is not compared any more, because nothing is there */
    check_ok(gw_metrics_compare(&reference, &test, &view, &out, &error));
    assert_true(out.values[GW_METRIC_DEPTH_MEAN] < (0.95 * 0.01 + 0.05 * 0.1) * px - 0.05);
}

/* --- hostile pairs ---------------------------------------------------------------------------------------
 */

static void what_is_no_number_is_counted_and_not_spread(void **state) {
    float clean[PIXELS * 3], dirty[PIXELS * 3], depths[2][PIXELS], normals[2][PIXELS * 3];
    gw_metrics out;
    (void)state;
    for (size_t i = 0; i < PIXELS * 3; ++i) {
        clean[i] = dirty[i] = i / 3 % 2 ? 1e6f : 0.25f;
        normals[0][i] = normals[1][i] = 1;
        depths[0][i / 3] = depths[1][i / 3] = 4;
    }
    dirty[0] = NAN;
    dirty[4] = INFINITY;
    depths[1][7] = NAN;
    depths[1][8] = 0;
    normals[1][9 * 3] = NAN;
    memset(&normals[1][10 * 3], 0, 3 * sizeof(float));
    const gw_metric_frame reference = {WIDTH, HEIGHT, NULL, clean, NULL, depths[0], normals[0]},
                          test = {WIDTH, HEIGHT, NULL, dirty, NULL, depths[1], normals[1]};
    check_ok(gw_metrics_compare(&reference, &test, &desk, &out, &error));
    assert_true(out.values[GW_METRIC_NOT_FINITE] == 6);
    assert_true(out.values[GW_METRIC_RELATIVE_SQUARE] == 0 && out.values[GW_METRIC_BIAS] == 0);
    assert_true(out.values[GW_METRIC_DEPTH_LARGEST] == 0 && out.values[GW_METRIC_NORMAL_LARGEST] == 0);
}

/* A hundredth of a million, where squares are beyond 8 bits and beyond a float's digits: relative. */
static void bright_light_weighs_like_dim_light(void **state) {
    float reference[3] = {1e6f, 1e6f, 1e6f}, test[3] = {1.01e6f, 1.01e6f, 1.01e6f};
    const gw_metric_frame a = {.width = 1, .height = 1, .light = reference},
                          b = {.width = 1, .height = 1, .light = test};
    gw_metrics out;
    (void)state;
    check_ok(gw_metrics_compare(&a, &b, &desk, &out, &error));
    assert_true(fabs(out.values[GW_METRIC_RELATIVE_SQUARE] - 1e-4) < 1e-9);
    assert_true(fabs(out.values[GW_METRIC_BIAS] - 1e4) < 1e-3);
}

static void one_pixel_and_thin_pictures_have_values(void **state) {
    static const uint32_t sizes[][2] = {{1, 1}, {1, 30}, {30, 1}, {2, 2}, {10, 11}, {11, 10}};
    (void)state;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k) {
        gw_image a = picture_of(sizes[k][0], sizes[k][1], 1), b = picture_of(sizes[k][0], sizes[k][1], 9);
        const gw_metrics same = compare_pictures(&a, &a), other = compare_pictures(&a, &b);
        assert_true(same.values[GW_METRIC_SSIM] == 1 && isinf(same.values[GW_METRIC_PSNR]));
        assert_true(other.values[GW_METRIC_SSIM] < 1 && other.values[GW_METRIC_SSIM] > 0.5);
        assert_true(other.values[GW_METRIC_FLIP] > 0);
        gw_image_finish(&a);
        gw_image_finish(&b);
    }
}

static void unequal_sizes_are_refused(void **state) {
    gw_image a = picture_of(8, 4, 1), b = picture_of(4, 8, 1);
    const gw_metric_frame reference = {.width = 8, .height = 4, .picture = &a},
                          turned = {.width = 4, .height = 8, .picture = &b},
                          lying = {.width = 8, .height = 4, .picture = &b}, none = {0};
    const gw_metric_view blind = {.pixels_per_degree = 0};
    gw_metrics out;
    (void)state;
    check_fails(gw_metrics_compare(&reference, &turned, &desk, &out, &error), GW_BAD_INPUT,
                "8 x 4 and 4 x 8");
    check_fails(gw_metrics_compare(&reference, &lying, &desk, &out, &error), GW_BAD_INPUT, "another size");
    check_fails(gw_metrics_compare(&none, &none, &desk, &out, &error), GW_BAD_INPUT, "no pixels");
    check_fails(gw_metrics_compare(&reference, &reference, &blind, &out, &error), GW_BAD_INPUT, "per degree");
    gw_image_finish(&a);
    gw_image_finish(&b);
}

/* Means of mean squares, worst cases, and a pop that the reference does not have. */
static void a_track_sums_its_frames(void **state) {
    gw_image calm = picture_of(WIDTH, HEIGHT, 1), popped = picture_of(WIDTH, HEIGHT, 1);
    const gw_metric_frame reference = {.width = WIDTH, .height = HEIGHT, .picture = &calm},
                          test = {.width = WIDTH, .height = HEIGHT, .picture = &popped};
    gw_metric_track track = {0};
    gw_metrics out;
    (void)state;
    check_ok(gw_metric_track_add(&track, &reference, &reference, &desk, &out, &error));
    assert_true(isnan(out.values[GW_METRIC_FLICKER]));
    for (size_t i = 0; i < PIXELS; ++i)
        if (i % WIDTH < 16 && i / WIDTH < 16)
            for (size_t c = 0; c < 3; ++c)
                popped.rgba[i * 4 + c] = (uint8_t)(calm.rgba[i * 4 + c] + 30);
    check_ok(gw_metric_track_add(&track, &reference, &test, &desk, &out, &error));
    const double psnr = out.values[GW_METRIC_PSNR];
    gw_metric_track_of(&track, &out);
    assert_true(fabs(out.values[GW_METRIC_PSNR] - psnr - 10 * log10(2)) < 1e-9);
    assert_true(out.values[GW_METRIC_LARGEST] == 30);
    assert_true(fabs(out.values[GW_METRIC_CHANGED] - 128.0 / PIXELS) < 1e-12);
    assert_true(out.values[GW_METRIC_POP] > 0.05);
    assert_true(out.values[GW_METRIC_FLICKER] > 0 &&
                out.values[GW_METRIC_FLICKER] < out.values[GW_METRIC_POP]);
    gw_metric_track_finish(&track);
    gw_image_finish(&calm);
    gw_image_finish(&popped);
}

static void every_metric_has_a_row(void **state) {
    (void)state;
    for (int i = 0; i < GW_METRIC_COUNT; ++i) {
        const gw_metric_row *row = &gw_metric_table[i];
        assert_non_null(row->name);
        assert_true(row->unit && row->what && strlen(row->what) > 3);
        for (int j = 0; j < i; ++j)
            assert_string_not_equal(row->name, gw_metric_table[j].name);
    }
    assert_true(gw_metric_badness(GW_METRIC_PSNR, 20) > gw_metric_badness(GW_METRIC_PSNR, 30));
    assert_true(gw_metric_badness(GW_METRIC_SSIM, 0.5) > gw_metric_badness(GW_METRIC_SSIM, 0.9));
    assert_true(gw_metric_badness(GW_METRIC_BIAS, -0.5) > gw_metric_badness(GW_METRIC_BIAS, 0.4));
}

/* A wall of 10 px a mm (the field says mm per pixel: 0.1) seen from 573 mm: 10 mm are a degree. */
static void density_follows_from_the_view(void **state) {
    const gw_plane plane = {.corner = {-5, 3, 0}, .step_x = {0.1, 0, 0}, .step_y = {0, -0.1, 0}};
    const double eye[3] = {0, 0, 573};
    (void)state;
    assert_true(fabs(gw_pixels_per_degree(&plane, eye, 100, 60) - 100) < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identical_frames_are_perfect),
        cmocka_unit_test(the_smallest_step_is_what_it_is),
        cmocka_unit_test(the_sign_of_a_bias_is_kept),
        cmocka_unit_test(ssim_is_the_sum_over_windows),
        cmocka_unit_test(silhouettes_are_as_far_as_the_loops_say),
        cmocka_unit_test(distances_are_exact),
        cmocka_unit_test(depths_and_normals_in_their_units),
        cmocka_unit_test(what_is_no_number_is_counted_and_not_spread),
        cmocka_unit_test(bright_light_weighs_like_dim_light),
        cmocka_unit_test(one_pixel_and_thin_pictures_have_values),
        cmocka_unit_test(unequal_sizes_are_refused),
        cmocka_unit_test(a_track_sums_its_frames),
        cmocka_unit_test(every_metric_has_a_row),
        cmocka_unit_test(density_follows_from_the_view),
    };
    return cmocka_run_group_tests_name("metrics", tests, NULL, NULL);
}
