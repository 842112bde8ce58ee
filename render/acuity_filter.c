/* See acuity_filter.h. */
#include "render/acuity_filter.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "render/sparse.h"

#include <math.h>
#include <stdlib.h>

/* A Gaussian of this deviation, in periods, halves the contrast of the period: sqrt(ln 2 / 2) / pi. */
static const double deviation_of_period = 0.18739;
/* Below this deviation, px, and with it a neighbour's share of 1e-3, nothing is blurred; above the other one
 * the window would be wider than any difference of interest. */
static const double least_deviation = 0.27, most_deviation = 40.0;

static void blur_pixel(const float *linear, int width, int height, int x, int y, double deviation,
                       uint8_t *out) {
    int radius = (int)ceil(3 * deviation);
    double sum[3] = {0, 0, 0}, weights = 0;
    for (int v = y - radius < 0 ? 0 : y - radius; v <= y + radius && v < height; ++v)
        for (int u = x - radius < 0 ? 0 : x - radius; u <= x + radius && u < width; ++u) {
            double square = (u - x) * (u - x) + (v - y) * (v - y);
            double weight = exp(-square / (2 * deviation * deviation));
            const float *from = linear + ((size_t)v * (size_t)width + (size_t)u) * 3;
            for (int c = 0; c < 3; ++c)
                sum[c] += weight * (double)from[c];
            weights += weight;
        }
    for (int c = 0; c < 3; ++c)
        out[c] = gw_srgb_code_from_linear(sum[c] / weights);
}

gw_code gw_acuity_filter(const gw_image *picture, const gw_frame_block *block, gw_image *out,
                         gw_error *error) {
    size_t pixels = (size_t)picture->width * picture->height;
    float *linear = NULL;
    gw_code code = gw_image_create(picture->width, picture->height, out, error);
    if (!code)
        code = gw_allocate((void **)&linear, pixels * 3, sizeof *linear, "picture in linear light", error);
    for (size_t i = 0; !code && i < pixels * 3; ++i)
        linear[i] = (float)gw_srgb_code_to_linear(picture->rgba[i / 3 * 4 + i % 3]);
    for (size_t i = 0; !code && i < pixels; ++i) {
        int x = (int)(i % picture->width), y = (int)(i / picture->width);
        uint8_t *to = out->rgba + i * 4;
        double period = block->counts[0] > 0 ? 2 * gw_sparse_spacing(block, x + 0.5, y + 0.5) : 0;
        double deviation = fmin(period * deviation_of_period, most_deviation);
        for (int c = 0; c < 4; ++c)
            to[c] = picture->rgba[i * 4 + (size_t)c];
        if (deviation >= least_deviation)
            blur_pixel(linear, (int)picture->width, (int)picture->height, x, y, deviation, to);
    }
    free(linear);
    if (code)
        gw_image_finish(out);
    return code;
}
