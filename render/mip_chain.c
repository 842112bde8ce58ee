/* See mip_chain.h. */
#include "render/mip_chain.h"

#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gw_texel_curve_init(gw_texel_curve *out) {
    for (int i = 0; i < 256; ++i)
        out->decode[i] = (uint16_t)lround(gw_srgb_to_linear(i / 255.0) * 65535.0);
    /* Bounds between neighbouring bytes: a power per byte, not per value. */
    uint32_t value = 0;
    for (int byte = 0; byte < 256; ++byte) {
        uint32_t end =
            byte == 255 ? 65536 : (uint32_t)ceil(gw_srgb_to_linear((byte + 0.5) / 255.0) * 65535.0);
        for (; value < end; ++value)
            out->encode[value] = (uint8_t)byte;
    }
}

void gw_texel_curve_init_linear(gw_texel_curve *out) {
    for (uint32_t i = 0; i < 256; ++i)
        out->decode[i] = (uint16_t)(i * 257);
    for (uint32_t value = 0; value < 65536; ++value)
        out->encode[value] = (uint8_t)((value + 128) / 257);
}

/* --- resizing --------------------------------------------------------------------------------------------
 */

/* A source texel along one axis that an output position takes from, and its share. */
typedef struct tap {
    uint32_t at;
    double share;
} tap;

/* Of all output positions of an axis. */
typedef struct axis_taps {
    tap *taps;
    uint32_t *first; /* [side + 1] into taps */
} axis_taps;

/* Where an output position falls in the source: two texels and the share of the second when growing; a range
 * with its first and last partly covered when shrinking. */
typedef struct axis_span {
    int64_t first, last;            /* inclusive, before wrapping */
    double first_share, last_share; /* of those two; all between count 1 */
} axis_span;

static axis_span span_of(uint32_t at, uint32_t side, uint32_t source, int nearest) {
    axis_span span;
    double scale = (double)source / (double)side;
    if (source <= side && nearest) {
        span.first = span.last = (int64_t)floor((at + 0.5) * scale);
        span.first_share = span.last_share = 1.0;
        return span;
    }
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

static void axis_finish(axis_taps *axis) {
    free(axis->taps);
    free(axis->first);
    *axis = (axis_taps){0};
}

static gw_code axis_init(uint32_t side, uint32_t source, gw_wrap wrap, int nearest, axis_taps *out,
                         gw_error *error) {
    *out = (axis_taps){0};
    /* Two for each output texel; neighbours that shrink share the source texel between them. */
    size_t most = 2 * (size_t)side + (source > side ? source : 0);
    gw_code code = gw_allocate((void **)&out->taps, most, sizeof *out->taps, "taps", error);
    if (!code)
        code = gw_allocate((void **)&out->first, (size_t)side + 1, sizeof *out->first, "taps", error);
    uint32_t count = 0;
    for (uint32_t at = 0; !code && at < side; ++at) {
        axis_span span = span_of(at, side, source, nearest);
        out->first[at] = count;
        for (int64_t i = span.first; i <= span.last; ++i)
            out->taps[count++] = (tap){wrapped(i, source, wrap), share_at(&span, i)};
        out->first[at + 1] = count;
    }
    return code;
}

static uint16_t to_16_bits(double value) {
    return (uint16_t)((value < 0.0 ? 0.0 : value > 65535.0 ? 65535.0 : value) + 0.5);
}

static void resample(const gw_texel_curve *curve, const gw_image *image, const axis_taps *across,
                     const axis_taps *down, uint32_t x, uint32_t y, uint16_t out[4]) {
    double color[3] = {0}, plain[3] = {0}, alpha = 0.0, weight = 0.0;
    for (uint32_t j = down->first[y]; j < down->first[y + 1]; ++j) {
        const uint8_t *row = image->rgba + (size_t)down->taps[j].at * image->width * 4;
        for (uint32_t i = across->first[x]; i < across->first[x + 1]; ++i) {
            const uint8_t *texel = row + (size_t)across->taps[i].at * 4;
            double share = across->taps[i].share * down->taps[j].share;
            double opacity = share * texel[3];
            for (int c = 0; c < 3; ++c) {
                color[c] += opacity * curve->decode[texel[c]];
                plain[c] += share * curve->decode[texel[c]];
            }
            alpha += opacity;
            weight += share;
        }
    }
    for (int c = 0; c < 3; ++c)
        out[c] = to_16_bits(alpha > 0.0 ? color[c] / alpha : plain[c] / weight);
    out[3] = to_16_bits(alpha / weight * 257.0);
}

/* The same where nothing is transparent: alpha is no weight then, and half of the sums are not needed. */
static void resample_opaque(const gw_texel_curve *curve, const gw_image *image, const axis_taps *across,
                            const axis_taps *down, uint32_t x, uint32_t y, uint16_t out[4]) {
    double color[3] = {0}, weight = 0.0;
    for (uint32_t j = down->first[y]; j < down->first[y + 1]; ++j) {
        const uint8_t *row = image->rgba + (size_t)down->taps[j].at * image->width * 4;
        for (uint32_t i = across->first[x]; i < across->first[x + 1]; ++i) {
            const uint8_t *texel = row + (size_t)across->taps[i].at * 4;
            double share = across->taps[i].share * down->taps[j].share;
            for (int c = 0; c < 3; ++c)
                color[c] += share * curve->decode[texel[c]];
            weight += share;
        }
    }
    for (int c = 0; c < 3; ++c)
        out[c] = to_16_bits(color[c] / weight);
    out[3] = 65535;
}

static int is_opaque(const gw_image *image) {
    const size_t count = (size_t)image->width * image->height;
    size_t i = 0;
    while (i < count && image->rgba[i * 4 + 3] == 255)
        ++i;
    return i == count;
}

static gw_code resize(const gw_texel_curve *curve, const gw_texture *texture, gw_linear_image *out,
                      gw_error *error) {
    const gw_image *image = &texture->image;
    axis_taps across = {0}, down = {0};
    void (*const texel)(const gw_texel_curve *, const gw_image *, const axis_taps *, const axis_taps *,
                        uint32_t, uint32_t, uint16_t[4]) = is_opaque(image) ? resample_opaque : resample;
    gw_code code = axis_init(out->side, image->width, texture->wrap_u, texture->nearest, &across, error);
    if (!code)
        code = axis_init(out->side, image->height, texture->wrap_v, texture->nearest, &down, error);
    for (uint32_t y = 0; !code && y < out->side; ++y)
        for (uint32_t x = 0; x < out->side; ++x)
            texel(curve, image, &across, &down, x, y, out->texels[(size_t)y * out->side + x]);
    axis_finish(&across);
    axis_finish(&down);
    return code;
}

/* --- images ----------------------------------------------------------------------------------------------
 */

static void copy_texels(const gw_texel_curve *curve, const gw_texture *texture, gw_linear_image *out) {
    size_t count = (size_t)out->side * out->side;
    for (size_t i = 0; i < count; ++i) {
        const uint8_t *texel = texture->image.rgba + i * 4;
        for (int c = 0; c < 3; ++c)
            out->texels[i][c] = curve->decode[texel[c]];
        out->texels[i][3] = (uint16_t)(texel[3] * 257);
    }
}

gw_code gw_linear_image_init(const gw_texel_curve *curve, const gw_texture *texture, uint32_t side,
                             gw_linear_image *out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, (size_t)side * side, sizeof *out->texels, "texels", error);
    out->texels = memory;
    out->side = side;
    if (!code && texture->image.width == side && texture->image.height == side)
        copy_texels(curve, texture, out);
    else if (!code)
        code = resize(curve, texture, out, error);
    return code ? gw_context(error, "texture %s", texture->name) : GW_OK;
}

void gw_linear_image_finish(gw_linear_image *image) {
    free(image->texels);
    image->texels = NULL;
    image->side = 0;
}

/* The mean of four texels; where all are opaque, in the same rounding, without the divisions by alpha. */
static void mean_of_four(const uint16_t *const four[4], uint16_t out[4]) {
    uint32_t alpha = 0;
    for (int k = 0; k < 4; ++k)
        alpha += four[k][3];
    if (alpha == 4 * 65535u || alpha == 0) {
        for (int c = 0; c < 3; ++c)
            out[c] = (uint16_t)((four[0][c] + four[1][c] + four[2][c] + four[3][c] + 2) / 4);
        out[3] = (uint16_t)(alpha / 4);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        uint64_t color = alpha / 2;
        for (int k = 0; k < 4; ++k)
            color += (uint64_t)four[k][3] * four[k][c];
        out[c] = (uint16_t)(color / alpha);
    }
    out[3] = (uint16_t)((alpha + 2) / 4);
}

/* In place: the texel written is never ahead of those read. */
void gw_linear_image_halve(gw_linear_image *image) {
    uint32_t half = image->side / 2;
    for (uint32_t y = 0; y < half; ++y)
        for (uint32_t x = 0; x < half; ++x) {
            const uint16_t(*above)[4] =
                (const uint16_t(*)[4])image->texels + (size_t)(2 * y) * image->side + 2 * x;
            const uint16_t(*below)[4] = above + image->side;
            const uint16_t *const four[4] = {above[0], above[1], below[0], below[1]};
            uint16_t mean[4];
            mean_of_four(four, mean);
            memcpy(image->texels[(size_t)y * half + x], mean, sizeof mean);
        }
    image->side = half;
}

void gw_linear_image_encode(const gw_texel_curve *curve, const gw_linear_image *image, uint8_t *rgba) {
    size_t count = (size_t)image->side * image->side;
    for (size_t i = 0; i < count; ++i) {
        for (size_t c = 0; c < 3; ++c)
            rgba[i * 4 + c] = curve->encode[image->texels[i][c]];
        rgba[i * 4 + 3] = (uint8_t)((image->texels[i][3] + 128) / 257);
    }
}

static uint8_t byte_of_component(double value) {
    return (uint8_t)lround((value * 0.5 + 0.5) * 255.0);
}

void gw_unit_texel(uint8_t texel[3]) {
    const double n[3] = {texel[0] / 127.5 - 1.0, texel[1] / 127.5 - 1.0, texel[2] / 127.5 - 1.0};
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3 && length > 0.0; ++c)
        texel[c] = byte_of_component(n[c] / length);
}

void gw_linear_image_encode_normals(const gw_linear_image *image, uint8_t *rgba) {
    const size_t count = (size_t)image->side * image->side;
    for (size_t i = 0; i < count; ++i) {
        double n[3], square = 0.0;
        for (int c = 0; c < 3; ++c) {
            n[c] = image->texels[i][c] / 32767.5 - 1.0;
            square += n[c] * n[c];
        }
        const double length = sqrt(square);
        for (size_t c = 0; c < 3; ++c)
            rgba[i * 4 + c] = byte_of_component(length > 1e-6 ? n[c] / length : c == 2);
        rgba[i * 4 + 3] = (uint8_t)lround((1.0 - sqrt(fmax(1.0 - length, 0.0))) * 255.0);
    }
}
