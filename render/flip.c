/* See flip.h. Names and numbers in comments are the paper's. */
#include "render/flip.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Exponents and break of the error's redistribution, section 4.1.4 (qc, pc, pt), and of features, 4.2 (w,
 * qf). */
static const double color_exponent = 0.7, break_place = 0.4, break_value = 0.95, feature_width = 0.082,
                    feature_exponent = 0.5;
/* Contrast sensitivity of A, RG, BY: sums of two Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
 */
static const double sensitivity[3][2][2] = {
    {{1.0, 0.0047}, {0.0, 1e-5}}, {{1.0, 0.0053}, {0.0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};
static const double widest_gaussian = 0.04;

/* Linear sRGB to XYZ. */
static const double to_xyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

/* All filters of FLIP are products of a function of x and one of y, so they run along rows and then along
 * columns. */
typedef struct kernel {
    int radius;
    double *weights; /* [2 radius + 1] */
} kernel;

/* Along rows: four Gaussians, two for the third channel, a Gaussian for features, its first and its second
 * derivative. */
enum { SENSITIVITY, FEATURE = 4, EDGES, POINTS, KERNELS };
static const int channel_of[KERNELS] = {0, 1, 2, 2, 0, 0, 0};

/* A picture as three planes. */
typedef struct planes {
    int width, height;
    float *values[3];
} planes;

static void multiply(const double m[3][3], const double v[3], double out[3]) {
    for (int i = 0; i < 3; ++i)
        out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

static void invert(const double m[3][3], double out[3][3]) {
    double determinant = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int i = 0; i < 3; ++i)
        determinant += m[0][i] * out[i][0];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[i][j] /= determinant;
}

static void white(double out[3]) {
    static const double ones[3] = {1, 1, 1};
    multiply(to_xyz, ones, out);
}

/* YCxCz, a linear opponent space: L*a*b* without its cube roots. */
static void to_opponent(const double rgb[3], double out[3]) {
    double xyz[3], w[3];
    white(w);
    multiply(to_xyz, rgb, xyz);
    for (int i = 0; i < 3; ++i)
        xyz[i] /= w[i];
    out[0] = 116 * xyz[1] - 16;
    out[1] = 500 * (xyz[0] - xyz[1]);
    out[2] = 200 * (xyz[1] - xyz[2]);
}

static double cube_root_of(double t) {
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

/* L*a*b* whose chroma is scaled by lightness, after Hunt. rgb is linear. */
static void to_hunt_lab(const double rgb[3], double out[3]) {
    double xyz[3], w[3];
    white(w);
    multiply(to_xyz, rgb, xyz);
    for (int i = 0; i < 3; ++i)
        xyz[i] = cube_root_of(xyz[i] / w[i]);
    out[0] = 116 * xyz[1] - 16;
    out[1] = 0.01 * out[0] * 500 * (xyz[0] - xyz[1]);
    out[2] = 0.01 * out[0] * 200 * (xyz[1] - xyz[2]);
}

static double hyab(const double a[3], const double b[3]) {
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* The largest colour error there is: green against blue. */
static double largest_error(void) {
    static const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double a[3], b[3];
    to_hunt_lab(green, a);
    to_hunt_lab(blue, b);
    return pow(hyab(a, b), color_exponent);
}

static double redistribute(double error, double largest) {
    double knee = break_place * largest;
    return error < knee ? error * break_value / knee
                        : break_value + (error - knee) / (largest - knee) * (1 - break_value);
}

/* --- filters
 * ----------------------------------------------------------------------------------------------------- */

static gw_code make_kernel(int radius, kernel *out, gw_error *error) {
    out->radius = radius;
    return gw_allocate((void **)&out->weights, 2 * (size_t)radius + 1, sizeof *out->weights, "filter", error);
}

static gw_code sensitivity_kernels(double pixels_per_degree, kernel *out, double shares[4], gw_error *error) {
    const int radius = (int)ceil(3 * sqrt(widest_gaussian / (2 * GW_PI * GW_PI)) * pixels_per_degree);
    gw_code code = GW_OK;
    for (int i = 0; !code && i < 4; ++i) {
        const double *g = sensitivity[channel_of[i]][i == 3];
        double sum = 0;
        code = make_kernel(radius, &out[i], error);
        for (int x = -radius; !code && x <= radius; ++x) {
            const double away = x / pixels_per_degree;
            sum += out[i].weights[x + radius] = exp(-GW_PI * GW_PI * away * away / g[1]);
        }
        for (int x = 0; !code && x <= 2 * radius; ++x)
            out[i].weights[x] /= sum;
        shares[i] = g[0] * sqrt(GW_PI / g[1]) * sum * sum;
    }
    const double both = shares[2] + shares[3];
    shares[0] = shares[1] = 1;
    shares[2] /= both;
    shares[3] /= both;
    return code;
}

/* A Gaussian of sum 1, or its first (edges) or second (points) derivative, whose positive weights sum to 1
 * and whose negative ones to -1. */
static gw_code feature_kernel(int derivative, double pixels_per_degree, kernel *out, gw_error *error) {
    const double deviation = 0.5 * feature_width * pixels_per_degree;
    const int radius = (int)ceil(3 * deviation);
    double positive = 0, negative = 0;
    gw_code code = make_kernel(radius, out, error);
    for (int x = -radius; !code && x <= radius; ++x) {
        const double scaled = x / deviation, gaussian = exp(-scaled * scaled / 2);
        const double value = derivative == 0   ? gaussian
                             : derivative == 1 ? -x * gaussian
                                               : (scaled * scaled - 1) * gaussian;
        out->weights[x + radius] = value;
        *(value > 0 ? &positive : &negative) += fabs(value);
    }
    for (int x = 0; !code && x <= 2 * radius; ++x)
        out->weights[x] /= out->weights[x] > 0 ? positive : negative;
    return code;
}

static int clamped(int value, int size) {
    return value < 0 ? 0 : value >= size ? size - 1 : value;
}

/* Every kernel's sums along row y of a picture; beyond the border the border's pixels go on. */
static void filter_row(const planes *p, const kernel *kernels, int y, double *out) {
    for (int k = 0; k < KERNELS; ++k) {
        const float *row = p->values[channel_of[k]] + (size_t)y * (size_t)p->width;
        const int radius = kernels[k].radius;
        for (int x = 0; x < p->width; ++x) {
            double sum = 0;
            for (int u = -radius; u <= radius; ++u)
                sum += kernels[k].weights[u + radius] * (double)row[clamped(x + u, p->width)];
            out[k * p->width + x] = sum;
        }
    }
}

/* --- both pipelines
 * ---------------------------------------------------------------------------------------------- */

static gw_code make_planes(const gw_image *image, planes *out, gw_error *error) {
    size_t pixels = (size_t)image->width * image->height;
    gw_code code = GW_OK;
    out->width = (int)image->width;
    out->height = (int)image->height;
    for (int c = 0; !code && c < 3; ++c)
        code = gw_allocate((void **)&out->values[c], pixels, sizeof(float), "picture", error);
    for (size_t i = 0; !code && i < pixels; ++i) {
        const double rgb[3] = {gw_srgb_code_to_linear(image->rgba[i * 4]),
                               gw_srgb_code_to_linear(image->rgba[i * 4 + 1]),
                               gw_srgb_code_to_linear(image->rgba[i * 4 + 2])};
        double opponent[3];
        to_opponent(rgb, opponent);
        for (int c = 0; c < 3; ++c)
            out->values[c][i] = (float)opponent[c];
    }
    return code;
}

typedef struct evaluation {
    planes pictures[2];
    kernel kernels[KERNELS];
    double shares[4]; /* of the Gaussians in their channels */
    int ring;         /* rows of sums that are kept: those of the tallest kernel */
    double *rows[2];  /* [ring][KERNELS][width] of each picture */
    double from_xyz[3][3], largest;
} evaluation;

/* Sums of `across` along columns by `down`, at a pixel. */
static double filtered(const evaluation *e, int which, int across, int down, int x, int y) {
    const planes *p = &e->pictures[which];
    const kernel *k = &e->kernels[down];
    double sum = 0;
    for (int v = -k->radius; v <= k->radius; ++v) {
        const int row = clamped(y + v, p->height) % e->ring;
        sum += k->weights[v + k->radius] *
               e->rows[which][((size_t)row * KERNELS + (size_t)across) * (size_t)p->width + (size_t)x];
    }
    return sum;
}

/* What the eye makes of a pixel: the blurred colour in Hunt-adjusted L*a*b*. */
static void seen(const evaluation *e, int which, int x, int y, double out[3]) {
    double opponent[3] = {0, 0, 0}, xyz[3], rgb[3], w[3];
    white(w);
    for (int i = 0; i < 4; ++i)
        opponent[channel_of[i]] += e->shares[i] * filtered(e, which, SENSITIVITY + i, SENSITIVITY + i, x, y);
    double luminance = (opponent[0] + 16) / 116;
    xyz[0] = (opponent[1] / 500 + luminance) * w[0];
    xyz[1] = luminance * w[1];
    xyz[2] = (luminance - opponent[2] / 200) * w[2];
    multiply(e->from_xyz, xyz, rgb);
    for (int i = 0; i < 3; ++i)
        rgb[i] = fmin(fmax(rgb[i], 0), 1);
    to_hunt_lab(rgb, out);
}

/* Strength of edges or points, of lightness scaled to 0..1. */
static double feature(const evaluation *e, int which, int kind, int x, int y) {
    return hypot(filtered(e, which, kind, FEATURE, x, y), filtered(e, which, FEATURE, kind, x, y)) / 116;
}

static double flip_at(const evaluation *e, int x, int y) {
    double a[3], b[3];
    seen(e, 0, x, y, a);
    seen(e, 1, x, y, b);
    double color = redistribute(pow(hyab(a, b), color_exponent), e->largest);
    double edges = fabs(feature(e, 0, EDGES, x, y) - feature(e, 1, EDGES, x, y));
    double points = fabs(feature(e, 0, POINTS, x, y) - feature(e, 1, POINTS, x, y));
    double features = pow(fmin(fmax(edges, points) / sqrt(2), 1), feature_exponent);
    return pow(color, 1 - features);
}

static gw_code prepare(evaluation *e, const gw_image *reference, const gw_image *test,
                       double pixels_per_degree, gw_error *error) {
    gw_code code = make_planes(reference, &e->pictures[0], error);
    if (!code)
        code = make_planes(test, &e->pictures[1], error);
    if (!code)
        code = sensitivity_kernels(pixels_per_degree, &e->kernels[SENSITIVITY], e->shares, error);
    for (int i = 0; !code && i < 3; ++i)
        code = feature_kernel(i, pixels_per_degree, &e->kernels[FEATURE + i], error);
    for (int k = 0; k < KERNELS; ++k)
        e->ring = 2 * e->kernels[k].radius + 1 > e->ring ? 2 * e->kernels[k].radius + 1 : e->ring;
    for (int i = 0; !code && i < 2; ++i)
        code = gw_allocate((void **)&e->rows[i], (size_t)e->ring * KERNELS * (size_t)e->pictures[i].width,
                           sizeof **e->rows, "filtered rows", error);
    invert(to_xyz, e->from_xyz);
    e->largest = largest_error();
    return code;
}

static void finish(evaluation *e) {
    for (int i = 0; i < 2; ++i) {
        for (int c = 0; c < 3; ++c)
            free(e->pictures[i].values[c]);
        free(e->rows[i]);
    }
    for (int k = 0; k < KERNELS; ++k)
        free(e->kernels[k].weights);
}

/* Rows of both pictures up to where the ring has all that row y needs. */
static void filter_rows(evaluation *e, int y, int *done) {
    const int radius = e->ring / 2, height = e->pictures[0].height;
    for (; *done < height && *done <= y + radius; ++*done)
        for (int i = 0; i < 2; ++i)
            filter_row(&e->pictures[i], e->kernels, *done,
                       e->rows[i] + (size_t)(*done % e->ring) * KERNELS * (size_t)e->pictures[i].width);
}

gw_code gw_flip(const gw_image *reference, const gw_image *test, double pixels_per_degree, float *map,
                double *mean, gw_error *error) {
    evaluation e;
    if (reference->width != test->width || reference->height != test->height)
        return gw_fail(error, GW_BAD_INPUT, "pictures of %u x %u and %u x %u pixels cannot be compared",
                       reference->width, reference->height, test->width, test->height);
    if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000))
        return gw_fail(error, GW_BAD_INPUT, "%g pixels per degree; FLIP takes 1 to 1000", pixels_per_degree);
    memset(&e, 0, sizeof e);
    gw_code code = prepare(&e, reference, test, pixels_per_degree, error);
    double sum = 0;
    int done = 0;
    for (int y = 0; !code && y < e.pictures[0].height; ++y) {
        filter_rows(&e, y, &done);
        for (int x = 0; x < e.pictures[0].width; ++x) {
            double value = flip_at(&e, x, y);
            sum += value;
            if (map)
                map[(size_t)y * reference->width + (size_t)x] = (float)value;
        }
    }
    *mean = sum / ((double)reference->width * reference->height);
    finish(&e);
    return code;
}

void gw_flip_color(float value, uint8_t rgba[4]) {
    for (int c = 0; c < 3; c++) {
        const double share = fmin(fmax(3 * (double)value - c, 0), 1);
        rgba[c] = (uint8_t)(255 * share + 0.5);
    }
    rgba[3] = 255;
}
