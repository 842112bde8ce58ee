/* See mip_chain.h. */
#include "render/mip_chain.h"

#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>

static void fill_decode_table(uint16_t table[256]) {
    for (int i = 0; i < 256; ++i)
        table[i] = (uint16_t)lround(gw_srgb_to_linear(i / 255.0) * 65535.0);
}

/* Where an output position falls in the source: up to two source texels and the share of the second when
 * growing; a range with its first and last partly covered when shrinking. */
typedef struct axis_span {
    int64_t first, last;            /* inclusive, before wrapping */
    double first_share, last_share; /* of those two; all between count 1 */
} axis_span;

static axis_span span_of(uint32_t at, uint32_t side, uint32_t source) {
    axis_span span;
    double scale = (double)source / (double)side;
    if (source <= side) {
        double centre = (at + 0.5) * scale - 0.5;
        span.first = (int64_t)floor(centre);
        span.last = span.first + 1;
        span.last_share = centre - (double)span.first;
        span.first_share = 1.0 - span.last_share;
        return span;
    }
    double begin = at * scale, end = (at + 1) * scale;
    span.first = (int64_t)floor(begin);
    span.last = (int64_t)ceil(end) - 1;
    span.first_share = fmin((double)span.first + 1.0, end) - begin;
    span.last_share = end - (double)span.last;
    return span;
}

static double share_at(const axis_span *span, int64_t i) {
    return i == span->first ? span->first_share : i == span->last ? span->last_share : 1.0;
}

static uint32_t wrapped(int64_t i, uint32_t size, gw_wrap wrap) {
    int64_t n = size;
    if (wrap == GW_WRAP_REPEAT)
        return (uint32_t)(((i % n) + n) % n);
    return (uint32_t)(i < 0 ? 0 : i >= n ? n - 1 : i);
}

static uint16_t to_16_bits(double value) {
    return (uint16_t)lround(fmin(fmax(value, 0.0), 65535.0));
}

static void resample(const gw_texture *texture, const uint16_t decode[256], uint32_t x, uint32_t y,
                     uint32_t side, uint16_t out[4]) {
    const gw_image *image = &texture->image;
    axis_span across = span_of(x, side, image->width), down = span_of(y, side, image->height);
    double color[3] = {0}, plain[3] = {0}, alpha = 0.0, weight = 0.0;
    for (int64_t j = down.first; j <= down.last; ++j)
        for (int64_t i = across.first; i <= across.last; ++i) {
            size_t column = wrapped(i, image->width, texture->wrap_u);
            size_t row = wrapped(j, image->height, texture->wrap_v);
            const uint8_t *texel = image->rgba + (row * image->width + column) * 4;
            double share = share_at(&across, i) * share_at(&down, j);
            double opacity = share * texel[3];
            for (int c = 0; c < 3; ++c) {
                color[c] += opacity * decode[texel[c]];
                plain[c] += share * decode[texel[c]];
            }
            alpha += opacity;
            weight += share;
        }
    for (int c = 0; c < 3; ++c)
        out[c] = to_16_bits(alpha > 0.0 ? color[c] / alpha : plain[c] / weight);
    out[3] = to_16_bits(alpha / weight * 257.0);
}

static void copy_texels(const gw_texture *texture, const uint16_t decode[256], gw_linear_image *out) {
    size_t count = (size_t)out->side * out->side;
    for (size_t i = 0; i < count; ++i) {
        const uint8_t *texel = texture->image.rgba + i * 4;
        for (int c = 0; c < 3; ++c)
            out->texels[i][c] = decode[texel[c]];
        out->texels[i][3] = (uint16_t)(texel[3] * 257);
    }
}

gw_code gw_linear_image_init(const gw_texture *texture, uint32_t side, gw_linear_image *out,
                             gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, (size_t)side * side, sizeof *out->texels, "texels", error);
    if (code)
        return gw_context(error, "texture %s", texture->name);
    out->texels = memory;
    out->side = side;
    uint16_t decode[256];
    fill_decode_table(decode);
    if (texture->image.width == side && texture->image.height == side) {
        copy_texels(texture, decode, out);
        return GW_OK;
    }
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            resample(texture, decode, x, y, side, out->texels[(size_t)y * side + x]);
    return GW_OK;
}

void gw_linear_image_finish(gw_linear_image *image) {
    free(image->texels);
    image->texels = NULL;
    image->side = 0;
}

/* In place: the texel written is never ahead of those read. */
void gw_linear_image_halve(gw_linear_image *image) {
    uint32_t half = image->side / 2;
    for (uint32_t y = 0; y < half; ++y)
        for (uint32_t x = 0; x < half; ++x) {
            uint64_t color[3] = {0}, plain[3] = {0}, alpha = 0;
            for (uint32_t k = 0; k < 4; ++k) {
                const uint16_t *texel = image->texels[(size_t)(2 * y + k / 2) * image->side + 2 * x + k % 2];
                for (int c = 0; c < 3; ++c) {
                    color[c] += (uint64_t)texel[3] * texel[c];
                    plain[c] += texel[c];
                }
                alpha += texel[3];
            }
            uint16_t *out = image->texels[(size_t)y * half + x];
            for (int c = 0; c < 3; ++c)
                out[c] = (uint16_t)(alpha > 0 ? (color[c] + alpha / 2) / alpha : (plain[c] + 2) / 4);
            out[3] = (uint16_t)((alpha + 2) / 4);
        }
    image->side = half;
}

void gw_linear_image_encode(const gw_linear_image *image, uint8_t *rgba) {
    /* Bounds between neighbouring bytes, so that encoding is a search and not a power per texel. */
    uint16_t least[256];
    uint8_t guess[257]; /* byte of the least value with these upper eight bits */
    least[0] = 0;
    for (int i = 1; i < 256; ++i)
        least[i] = (uint16_t)ceil(gw_srgb_to_linear((i - 0.5) / 255.0) * 65535.0);
    for (int i = 0; i <= 256; ++i)
        guess[i] = (uint8_t)floor(gw_srgb_from_linear(fmin(i * 256 / 65535.0, 1.0)) * 255.0);
    size_t count = (size_t)image->side * image->side;
    for (size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
            uint16_t value = image->texels[i][c];
            uint32_t byte = guess[value >> 8];
            while (byte < 255 && least[byte + 1] <= value)
                ++byte;
            rgba[i * 4 + (size_t)c] = (uint8_t)byte;
        }
        rgba[i * 4 + 3] = (uint8_t)((image->texels[i][3] + 128) / 257);
    }
}
