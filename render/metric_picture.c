/* See metrics.h: codes of the screen, structure, light and its sign. */
#include "render/metrics_internal.h"

#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>

/* Luminance of linear sRGB (Rec. 709), and luma of its codes as SSIM's authors take it (Rec. 601). */
static const double luminance[3] = {0.2126, 0.7152, 0.0722}, luma[3] = {0.299, 0.587, 0.114};

/* --- codes -----------------------------------------------------------------------------------------------
 */

double gw_metric_rms(const gw_image *reference, const gw_image *test, int channel) {
    const size_t pixels = (size_t)reference->width * reference->height;
    uint64_t squares = 0;
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = channel < 3 ? (size_t)channel : 0; c < (channel < 3 ? (size_t)channel + 1 : 3); ++c) {
            const int difference = reference->rgba[i * 4 + c] - test->rgba[i * 4 + c];
            squares += (uint64_t)(difference * difference);
        }
    return sqrt((double)squares / ((double)pixels * (channel < 3 ? 1 : 3))) / 255;
}

double gw_metric_decibels(double rms) {
    return rms > 0 ? -20 * log10(rms) : (double)INFINITY;
}

void gw_metric_codes(const gw_image *reference, const gw_image *test, gw_metrics *out) {
    const size_t pixels = (size_t)reference->width * reference->height;
    double linear[256], bias[3] = {0, 0, 0};
    size_t changed = 0;
    int largest = 0;
    for (int i = 0; i < 256; ++i)
        linear[i] = gw_srgb_code_to_linear((uint8_t)i);
    for (size_t i = 0; i < pixels; ++i) {
        const uint8_t *r = reference->rgba + i * 4, *t = test->rgba + i * 4;
        int here = 0;
        for (int c = 0; c < 3; ++c) {
            const int difference = abs(t[c] - r[c]);
            here = difference > here ? difference : here;
            bias[c] += linear[t[c]] - linear[r[c]];
        }
        changed += here > 0;
        largest = here > largest ? here : largest;
    }
    out->values[GW_METRIC_CHANGED] = (double)changed / (double)pixels;
    out->values[GW_METRIC_LARGEST] = largest;
    out->values[GW_METRIC_BIAS] = 0;
    for (int c = 0; c < 3; ++c) {
        out->values[GW_METRIC_PSNR_RED + c] = gw_metric_decibels(gw_metric_rms(reference, test, c));
        out->values[GW_METRIC_BIAS_RED + c] = bias[c] / (double)pixels;
        out->values[GW_METRIC_BIAS] += luminance[c] * bias[c] / (double)pixels;
    }
    out->values[GW_METRIC_PSNR] = gw_metric_decibels(gw_metric_rms(reference, test, 3));
}

/* --- light -----------------------------------------------------------------------------------------------
 */

/* Relative square: (test - reference)^2 / (reference^2 + 0.01), after Rousselle et al. 2011: light of any
 * size weighs alike. Signs are of the light as it is, not clamped to the screen. */
void gw_metric_light(const float *reference, const float *test, size_t pixels, gw_metrics *out) {
    double squares = 0, bias[3] = {0, 0, 0}, not_finite = 0;
    size_t count = 0;
    for (size_t i = 0; i < pixels; ++i) {
        const float *r = reference + i * 3, *t = test + i * 3;
        int finite = 1;
        for (int c = 0; c < 3; ++c)
            finite = finite && isfinite(r[c]) && isfinite(t[c]);
        if (!finite) {
            ++not_finite;
            continue;
        }
        ++count;
        for (int c = 0; c < 3; ++c) {
            const double difference = (double)t[c] - (double)r[c];
            squares += difference * difference / ((double)r[c] * (double)r[c] + 0.01);
            bias[c] += difference;
        }
    }
    out->values[GW_METRIC_NOT_FINITE] += not_finite;
    if (!count)
        return;
    out->values[GW_METRIC_RELATIVE_SQUARE] = squares / (3 * (double)count);
    out->values[GW_METRIC_BIAS] = 0;
    for (int c = 0; c < 3; ++c) {
        out->values[GW_METRIC_BIAS_RED + c] = bias[c] / (double)count;
        out->values[GW_METRIC_BIAS] += luminance[c] * bias[c] / (double)count;
    }
}

/* --- structure -------------------------------------------------------------------------------------------
 */

/* Wang, Bovik, Sheikh & Simoncelli, Image Quality Assessment: From Error Visibility to Structural Similarity,
 * IEEE TIP 13(4), 2004: their window and constants. */
enum { RADIUS = 5, SUMS = 5 };
static const double window_deviation = 1.5, c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;

typedef struct window {
    int radius; /* of both sides of the middle: pictures smaller than 11 pixels have a smaller window */
    double weights[2 * RADIUS + 1];
} window;

static window window_for(uint32_t side) {
    window w = {.radius = side > 2 * RADIUS ? RADIUS : (int)((side - 1) / 2)};
    double sum = 0;
    for (int i = -w.radius; i <= w.radius; ++i) {
        w.weights[i + w.radius] = exp(-i * i / (2 * window_deviation * window_deviation));
        sum += w.weights[i + w.radius];
    }
    for (int i = 0; i <= 2 * w.radius; ++i)
        w.weights[i] /= sum;
    return w;
}

/* One channel, or luma. */
static double code_of(const uint8_t *rgba, int channel) {
    return channel < 3 ? rgba[channel] : luma[0] * rgba[0] + luma[1] * rgba[1] + luma[2] * rgba[2];
}

/* Weighted sums across one row: of a, b, aa, bb, ab. Places count from the window's first pixel. */
static void sum_row(const gw_image *a, const gw_image *b, int channel, uint32_t y, const window *across,
                    double *out) {
    const uint32_t places = a->width - 2 * (uint32_t)across->radius;
    for (uint32_t x = 0; x < places; ++x) {
        double *sums = out + (size_t)x * SUMS;
        for (int k = 0; k < SUMS; ++k)
            sums[k] = 0;
        for (int i = 0; i <= 2 * across->radius; ++i) {
            const size_t at = ((size_t)y * a->width + x + (size_t)i) * 4;
            const double u = code_of(a->rgba + at, channel), v = code_of(b->rgba + at, channel);
            const double terms[SUMS] = {u, v, u * u, v * v, u * v};
            for (int k = 0; k < SUMS; ++k)
                sums[k] += across->weights[i] * terms[k];
        }
    }
}

static double similarity(const double sums[SUMS]) {
    const double a = sums[0], b = sums[1], aa = fmax(sums[2] - a * a, 0), bb = fmax(sums[3] - b * b, 0),
                 ab = sums[4] - a * b;
    return (2 * a * b + c1) * (2 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
}

/* rows: a ring of as many rows of sums as the window is high. */
static double mean_similarity(const gw_image *a, const gw_image *b, int channel, double *rows) {
    const window across = window_for(a->width), down = window_for(a->height);
    const uint32_t places = a->width - 2 * (uint32_t)across.radius, high = 2 * (uint32_t)down.radius + 1;
    const size_t row = (size_t)places * SUMS;
    double total = 0;
    for (uint32_t y = 0; y < a->height; ++y) {
        sum_row(a, b, channel, y, &across, rows + y % high * row);
        for (uint32_t x = 0; x < places && y + 1 >= high; ++x) {
            double sums[SUMS] = {0};
            for (uint32_t i = 0; i < high; ++i)
                for (size_t k = 0; k < SUMS; ++k)
                    sums[k] += down.weights[i] * rows[(y + 1 + i) % high * row + (size_t)x * SUMS + k];
            total += similarity(sums);
        }
    }
    return total / ((double)places * (a->height - high + 1));
}

gw_code gw_metric_ssim(const gw_image *reference, const gw_image *test, gw_metrics *out, gw_error *error) {
    double *rows = NULL;
    gw_code code = gw_allocate((void **)&rows, (size_t)reference->width * (2 * RADIUS + 1) * SUMS,
                               sizeof *rows, "sums of rows", error);
    for (int c = 0; c < 3 && !code; ++c)
        out->values[GW_METRIC_SSIM_RED + c] = mean_similarity(reference, test, c, rows);
    if (!code)
        out->values[GW_METRIC_SSIM] = mean_similarity(reference, test, 3, rows);
    free(rows);
    return code;
}
