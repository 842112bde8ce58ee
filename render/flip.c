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

typedef struct kernel {
    int radius;
    double *weights; /* [2 radius + 1][2 radius + 1] */
} kernel;

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
    size_t side = 2 * (size_t)radius + 1;
    out->radius = radius;
    return gw_allocate((void **)&out->weights, side * side, sizeof *out->weights, "filter", error);
}

static double *weight(const kernel *k, int x, int y) {
    return &k->weights[(y + k->radius) * (2 * k->radius + 1) + x + k->radius];
}

static gw_code sensitivity_kernel(int channel, double pixels_per_degree, kernel *out, gw_error *error) {
    int radius = (int)ceil(3 * sqrt(widest_gaussian / (2 * GW_PI * GW_PI)) * pixels_per_degree);
    double sum = 0;
    gw_code code = make_kernel(radius, out, error);
    for (int y = -radius; !code && y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            double square = (x * x + y * y) / (pixels_per_degree * pixels_per_degree), value = 0;
            for (int i = 0; i < 2; ++i) {
                const double *g = sensitivity[channel][i];
                value += g[0] * sqrt(GW_PI / g[1]) * exp(-GW_PI * GW_PI * square / g[1]);
            }
            *weight(out, x, y) = value;
            sum += value;
        }
    for (int y = -radius; !code && y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            *weight(out, x, y) /= sum;
    return code;
}

/* First (edges) or second (points) derivative of a Gaussian along x; its positive weights sum to 1, its
 * negative ones to -1. */
static gw_code feature_kernel(int points, double pixels_per_degree, kernel *out, gw_error *error) {
    double deviation = 0.5 * feature_width * pixels_per_degree, positive = 0, negative = 0;
    int radius = (int)ceil(3 * deviation);
    gw_code code = make_kernel(radius, out, error);
    for (int y = -radius; !code && y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            double gaussian = exp(-(x * x + y * y) / (2 * deviation * deviation));
            double value = (points ? x * x / (deviation * deviation) - 1 : -x) * gaussian;
            *weight(out, x, y) = value;
            *(value > 0 ? &positive : &negative) += fabs(value);
        }
    for (int y = -radius; !code && y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            *weight(out, x, y) /= *weight(out, x, y) > 0 ? positive : negative;
    return code;
}

static int clamped(int value, int size) {
    return value < 0 ? 0 : value >= size ? size - 1 : value;
}

/* One pixel of a plane under the kernel, or under the kernel turned so that x and y change places; beyond the
 * border the border's pixels go on. */
static double filtered(const planes *p, int channel, const kernel *k, int x, int y, int turned) {
    double sum = 0;
    for (int v = -k->radius; v <= k->radius; ++v) {
        const float *row = p->values[channel] + (size_t)clamped(y + v, p->height) * (size_t)p->width;
        for (int u = -k->radius; u <= k->radius; ++u)
            sum += (turned ? *weight(k, v, u) : *weight(k, u, v)) * (double)row[clamped(x + u, p->width)];
    }
    return sum;
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
    kernel sensitivities[3], edges, points;
    double from_xyz[3][3], largest;
} evaluation;

/* What the eye makes of a pixel: the blurred colour in Hunt-adjusted L*a*b*. */
static void seen(const evaluation *e, int which, int x, int y, double out[3]) {
    double opponent[3], xyz[3], rgb[3], w[3];
    white(w);
    for (int c = 0; c < 3; ++c)
        opponent[c] = filtered(&e->pictures[which], c, &e->sensitivities[c], x, y, 0);
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
static double feature(const evaluation *e, int which, const kernel *k, int x, int y) {
    return hypot(filtered(&e->pictures[which], 0, k, x, y, 0), filtered(&e->pictures[which], 0, k, x, y, 1)) /
           116;
}

static double flip_at(const evaluation *e, int x, int y) {
    double a[3], b[3];
    seen(e, 0, x, y, a);
    seen(e, 1, x, y, b);
    double color = redistribute(pow(hyab(a, b), color_exponent), e->largest);
    double edges = fabs(feature(e, 0, &e->edges, x, y) - feature(e, 1, &e->edges, x, y));
    double points = fabs(feature(e, 0, &e->points, x, y) - feature(e, 1, &e->points, x, y));
    double features = pow(fmin(fmax(edges, points) / sqrt(2), 1), feature_exponent);
    return pow(color, 1 - features);
}

static gw_code prepare(evaluation *e, const gw_image *reference, const gw_image *test,
                       double pixels_per_degree, gw_error *error) {
    gw_code code = make_planes(reference, &e->pictures[0], error);
    if (!code)
        code = make_planes(test, &e->pictures[1], error);
    for (int c = 0; !code && c < 3; ++c)
        code = sensitivity_kernel(c, pixels_per_degree, &e->sensitivities[c], error);
    if (!code)
        code = feature_kernel(0, pixels_per_degree, &e->edges, error);
    if (!code)
        code = feature_kernel(1, pixels_per_degree, &e->points, error);
    invert(to_xyz, e->from_xyz);
    e->largest = largest_error();
    return code;
}

static void finish(evaluation *e) {
    for (int c = 0; c < 3; ++c) {
        free(e->pictures[0].values[c]);
        free(e->pictures[1].values[c]);
        free(e->sensitivities[c].weights);
    }
    free(e->edges.weights);
    free(e->points.weights);
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
    for (int y = 0; !code && y < e.pictures[0].height; ++y)
        for (int x = 0; x < e.pictures[0].width; ++x) {
            double value = flip_at(&e, x, y);
            sum += value;
            if (map)
                map[(size_t)y * reference->width + (size_t)x] = (float)value;
        }
    *mean = sum / ((double)reference->width * reference->height);
    finish(&e);
    return code;
}
