/* FLIP against values that follow from its paper, against a second implementation of it, and its behaviour on
 * hostile pairs. */
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

/* --- the paper's pipeline once more, by another road
 * --- */

/* A picture that is the same in every row needs one-dimensional sums only: its filters are products of a
 * function of x and one of y, and the latter sums to 1 (blur, features across) or to 0 (features along, which
 * are 0). Written after the paper with its primaries and white from chromaticities, not from the matrix that
 * render/flip.c has. */

typedef struct column {
    double y, cx, cz;
} column;

/* sRGB primaries and the D65 white of IEC 61966-2-1, the columns scaled so that they add up to white. */
static void xyz_of(const double rgb[3], double xyz[3]) {
    static const double primaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
    static const double luminances[3] = {0.212656, 0.715158, 0.072186}; /* follow from those and the white */
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (int i = 0; i < 3; ++i) {
        double x = primaries[i][0], y = primaries[i][1], light = luminances[i] * rgb[i];
        xyz[0] += light * x / y;
        xyz[1] += light;
        xyz[2] += light * (1 - x - y) / y;
    }
}

static void whitened(const double rgb[3], double out[3]) {
    static const double ones[3] = {1, 1, 1};
    double white[3];
    xyz_of(ones, white);
    xyz_of(rgb, out);
    for (int i = 0; i < 3; ++i)
        out[i] /= white[i];
}

static column opponent_of(const uint8_t *code) {
    double rgb[3], v[3];
    for (int i = 0; i < 3; ++i) {
        double s = code[i] / 255.0;
        rgb[i] = s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
    }
    whitened(rgb, v);
    return (column){116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

static double value_at(const double line[SIDE], int x) {
    return line[x < 0 ? 0 : x >= SIDE ? SIDE - 1 : x];
}

/* The sum of Gaussians a sqrt(pi/b) exp(-pi^2 d^2 / b), d in degrees, over the line; each has its own sum
 * along y. */
static double blurred(const double line[SIDE], int x, const double (*gaussians)[2], int count, double ppd) {
    int radius = (int)ceil(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * ppd);
    double sum = 0, weights = 0;
    for (int g = 0; g < count; ++g) {
        double a = gaussians[g][0], b = gaussians[g][1], along = 0;
        for (int v = -radius; v <= radius; ++v)
            along += exp(-M_PI * M_PI * v * v / (ppd * ppd * b));
        for (int u = -radius; u <= radius; ++u) {
            double weight = a * sqrt(M_PI / b) * along * exp(-M_PI * M_PI * u * u / (ppd * ppd * b));
            sum += weight * value_at(line, x + u);
            weights += weight;
        }
    }
    return sum / weights;
}

/* First or second derivative of the Gaussian of half of 0.082 degrees. */
static double derivative(const double line[SIDE], int x, int second, double ppd) {
    double deviation = 0.5 * 0.082 * ppd, sums[2] = {0, 0}, totals[2] = {0, 0};
    int radius = (int)ceil(3 * deviation);
    for (int u = -radius; u <= radius; ++u) {
        double g = exp(-u * u / (2 * deviation * deviation));
        double weight = second ? (u * u / (deviation * deviation) - 1) * g : -u * g;
        sums[weight > 0] += fabs(weight) * value_at(line, x + u);
        totals[weight > 0] += fabs(weight);
    }
    return fabs(sums[1] / totals[1] - sums[0] / totals[0]);
}

/* Hunt-adjusted L*a*b* of X, Y, Z relative to white. */
static void hunt_lab(const double xyz[3], double lab[3]) {
    double v[3];
    for (int i = 0; i < 3; ++i)
        v[i] = xyz[i] > 216.0 / 24389 ? cbrt(xyz[i]) : (24389.0 / 27 * xyz[i] + 16) / 116;
    lab[0] = 116 * v[1] - 16;
    lab[1] = 0.01 * lab[0] * 500 * (v[0] - v[1]);
    lab[2] = 0.01 * lab[0] * 200 * (v[1] - v[2]);
}

/* Of what is left of a column behind the eye's blur. */
static void perceived(double lines[3][SIDE], int x, double ppd, double lab[3]) {
    static const double a[][2] = {{1, 0.0047}}, rg[][2] = {{1, 0.0053}},
                        by[][2] = {{34.1, 0.04}, {13.5, 0.025}};
    double y = (blurred(lines[0], x, a, 1, ppd) + 16) / 116;
    double v[3] = {y + blurred(lines[1], x, rg, 1, ppd) / 500, y, y - blurred(lines[2], x, by, 2, ppd) / 200};
    hunt_lab(v, lab);
}

static double distance_of(const double a[3], const double b[3]) {
    return pow(fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}

static double green_against_blue(void) {
    static const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double v[3], a[3], b[3];
    whitened(green, v);
    hunt_lab(v, a);
    whitened(blue, v);
    hunt_lab(v, b);
    return distance_of(a, b);
}

static double flip_of_column(double lines[2][3][SIDE], int x, double ppd) {
    double a[3], b[3], luminance[2][SIDE];
    perceived(lines[0], x, ppd, a);
    perceived(lines[1], x, ppd, b);
    double color = distance_of(a, b) / green_against_blue();
    color = color < 0.4 ? color * 0.95 / 0.4 : 0.95 + (color - 0.4) / 0.6 * 0.05;
    for (int p = 0; p < 2; ++p)
        for (int i = 0; i < SIDE; ++i)
            luminance[p][i] = (lines[p][0][i] + 16) / 116;
    double edges = fabs(derivative(luminance[0], x, 0, ppd) - derivative(luminance[1], x, 0, ppd));
    double points = fabs(derivative(luminance[0], x, 1, ppd) - derivative(luminance[1], x, 1, ppd));
    return pow(color, 1 - sqrt(fmax(edges, points) / sqrt(2)));
}

/* Coloured bars against other ones: every column's value from both roads, at three viewing distances. Colours
 * stay inside the gamut behind the blur, so that no clamping is needed. */
static void maps_equal_those_of_another_implementation(void **state) {
    static const double distances[] = {25, GW_FLIP_PIXELS_PER_DEGREE, 110};
    gw_image pair[2] = {filled(0, 0, 0), filled(0, 0, 0)};
    double lines[2][3][SIDE], mean;
    float map[PIXELS];
    uint64_t random = 7;
    (void)state;
    for (int p = 0; p < 2; ++p)
        for (int x = 0; x < SIDE; ++x) {
            uint8_t code[3];
            for (int c = 0; c < 3; ++c)
                code[c] = (uint8_t)(70 + 120 * gw_test_random(&random));
            if (p == 1 && x / 6 % 2) /* half of the bars are alike */
                memcpy(code, pair[0].rgba + (size_t)x * 4, 3);
            for (int y = 0; y < SIDE; ++y)
                memcpy(pair[p].rgba + ((size_t)y * SIDE + (size_t)x) * 4, code, 3);
            column o = opponent_of(code);
            lines[p][0][x] = o.y;
            lines[p][1][x] = o.cx;
            lines[p][2][x] = o.cz;
        }
    for (size_t d = 0; d < sizeof distances / sizeof *distances; ++d) {
        double largest = 0;
        check_ok(gw_flip(&pair[0], &pair[1], distances[d], map, &mean, &error));
        for (int x = 0; x < SIDE; ++x) {
            double other = flip_of_column(lines, x, distances[d]);
            assert_true(fabs((double)map[SIDE / 2 * SIDE + x] - other) < 5e-5);
            largest = fmax(largest, other);
        }
        assert_true(largest > 0.1);
    }
    gw_image_finish(&pair[0]);
    gw_image_finish(&pair[1]);
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
        cmocka_unit_test(maps_equal_those_of_another_implementation),
        cmocka_unit_test(wrong_pairs_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
