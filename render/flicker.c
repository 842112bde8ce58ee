/* See flicker.h. The change of a minus the change of r is the change of a - r, so one error per pixel is all
 * that is kept from frame to frame. */
#include "render/flicker.h"

#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double largest_change = 2.0; /* from black for white to white for black */

/* L* over 100 of a pixel; the luminance weights are Rec. 709's, which are sRGB's. */
static double lightness(const double linear[256], const uint8_t *rgba) {
    double y = 0.2126 * linear[rgba[0]] + 0.7152 * linear[rgba[1]] + 0.0722 * linear[rgba[2]];
    return y > 216.0 / 24389 ? 1.16 * cbrt(y) - 0.16 : y * 24389 / 2700;
}

static gw_code check_sizes(const gw_flicker *flicker, const gw_image *reference, const gw_image *picture,
                           gw_error *error) {
    if (reference->width != picture->width || reference->height != picture->height)
        return gw_fail(error, GW_BAD_INPUT, "pictures of %u x %u and %u x %u pixels cannot be compared",
                       reference->width, reference->height, picture->width, picture->height);
    if (flicker->error && (flicker->width != picture->width || flicker->height != picture->height))
        return gw_fail(error, GW_BAD_INPUT,
                       "a frame of %u x %u pixels follows one of %u x %u; a sequence has one size",
                       picture->width, picture->height, flicker->width, flicker->height);
    return GW_OK;
}

static void count_change(gw_flicker *flicker, double change) {
    size_t bin = (size_t)(fabs(change) / largest_change * GW_FLICKER_BINS);
    flicker->bins[bin < GW_FLICKER_BINS ? bin : GW_FLICKER_BINS - 1]++;
    flicker->sum += fabs(change);
    flicker->largest = fmax(flicker->largest, fabs(change));
}

/* The patch whose first pixel is (x0, y0); returns the change of its mean. */
static double add_patch(gw_flicker *flicker, const double linear[256], const gw_image *reference,
                        const gw_image *picture, uint32_t x0, uint32_t y0) {
    double sum = 0;
    uint32_t pixels = 0;
    for (uint32_t y = y0; y < y0 + GW_FLICKER_PATCH && y < picture->height; ++y)
        for (uint32_t x = x0; x < x0 + GW_FLICKER_PATCH && x < picture->width; ++x, ++pixels) {
            size_t at = (size_t)y * picture->width + x;
            float now = (float)(lightness(linear, picture->rgba + at * 4) -
                                lightness(linear, reference->rgba + at * 4));
            double change = (double)(now - flicker->error[at]);
            flicker->error[at] = now;
            if (flicker->frames)
                count_change(flicker, change);
            sum += change;
        }
    return sum / pixels;
}

gw_code gw_flicker_add(gw_flicker *flicker, const gw_image *reference, const gw_image *picture,
                       gw_error *error) {
    double linear[256];
    gw_code code = check_sizes(flicker, reference, picture, error);
    if (!code && !flicker->error)
        code = gw_allocate((void **)&flicker->error, (size_t)picture->width * picture->height,
                           sizeof *flicker->error, "flicker", error);
    if (code)
        return code;
    flicker->width = picture->width;
    flicker->height = picture->height;
    for (int i = 0; i < 256; ++i)
        linear[i] = gw_srgb_code_to_linear((uint8_t)i);
    for (uint32_t y = 0; y < picture->height; y += GW_FLICKER_PATCH)
        for (uint32_t x = 0; x < picture->width; x += GW_FLICKER_PATCH) {
            double jump = add_patch(flicker, linear, reference, picture, x, y);
            if (flicker->frames)
                flicker->pop = fmax(flicker->pop, fabs(jump));
        }
    flicker->frames++;
    return GW_OK;
}

void gw_flicker_cut(gw_flicker *flicker) {
    flicker->frames = 0;
}

gw_flicker_result gw_flicker_of(const gw_flicker *flicker) {
    gw_flicker_result out = {.largest = flicker->largest, .pop = flicker->pop};
    uint64_t total = 0, below = 0;
    for (int i = 0; i < GW_FLICKER_BINS; ++i)
        total += flicker->bins[i];
    if (total == 0)
        return out;
    out.mean = flicker->sum / (double)total;
    int bin = 0;
    while (bin < GW_FLICKER_BINS - 1 && (double)(below + flicker->bins[bin]) < 0.99 * (double)total)
        below += flicker->bins[bin++];
    out.percentile = bin * largest_change / GW_FLICKER_BINS;
    return out;
}

void gw_flicker_finish(gw_flicker *flicker) {
    free(flicker->error);
    memset(flicker, 0, sizeof *flicker);
}
