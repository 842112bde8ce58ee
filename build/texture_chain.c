#include "build/texture_chain.h"

#include "base/memory.h"
#include "base/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What tells one chain from another. */
typedef struct chain_key {
    int32_t texture;
    uint32_t cut; /* least 8-bit alpha that counts as opaque; 0: alpha is used as it is */
} chain_key;

/* Weighted sums while texels are averaged. 64 bits hold 2^32 full texels. */
typedef struct texel_sum {
    uint64_t red, green, blue; /* weighted by alpha */
    uint64_t plain[3];         /* not weighted, for areas that are transparent everywhere */
    uint64_t alpha, weight;
} texel_sum;

/* sRGB-encoded byte to linear light, 0..65535 (IEC 61966-2-1). */
static void fill_decode_table(uint16_t table[256]) {
    for (int i = 0; i < 256; ++i) {
        table[i] = (uint16_t)(gw_srgb_code_to_linear((uint8_t)i) * 65535.0 + 0.5);
    }
}

static void add_texel(texel_sum *sum, gw_chain_texel texel, uint64_t weight) {
    uint64_t alpha = weight * texel.alpha;
    sum->red += alpha * texel.red;
    sum->green += alpha * texel.green;
    sum->blue += alpha * texel.blue;
    sum->plain[0] += weight * texel.red;
    sum->plain[1] += weight * texel.green;
    sum->plain[2] += weight * texel.blue;
    sum->alpha += alpha;
    sum->weight += weight;
}

static uint16_t rounded(uint64_t sum, uint64_t weight) {
    return (uint16_t)((sum + weight / 2) / weight);
}

static gw_chain_texel mean_texel(const texel_sum *s) {
    gw_chain_texel texel = {.alpha = rounded(s->alpha, s->weight)};
    if (s->alpha > 0) {
        texel.red = rounded(s->red, s->alpha);
        texel.green = rounded(s->green, s->alpha);
        texel.blue = rounded(s->blue, s->alpha);
    } else {
        texel.red = rounded(s->plain[0], s->weight);
        texel.green = rounded(s->plain[1], s->weight);
        texel.blue = rounded(s->plain[2], s->weight);
    }
    return texel;
}

static gw_chain_texel source_texel(const gw_image *image, uint32_t x, uint32_t y, uint32_t cut,
                                   const uint16_t *decode) {
    const uint8_t *rgba = image->rgba + ((size_t)y * image->width + x) * 4;
    uint16_t alpha = (uint16_t)(rgba[3] * 257u);
    if (cut > 0)
        alpha = rgba[3] >= cut ? 65535 : 0;
    return (gw_chain_texel){decode[rgba[0]], decode[rgba[1]], decode[rgba[2]], alpha};
}

/* Mean of the image over texel (x, y) of a width x height grid, by exact integer overlaps: lengths are
 * counted in units in which a source pixel is `width` long and a texel `image->width`. Sums stay below 2^64:
 * weights of one texel add up to image area <= 2^30, times alpha and colour of 16 bits each. */
static gw_chain_texel area_mean(const gw_image *image, uint32_t width, uint32_t height, uint32_t x,
                                uint32_t y, uint32_t cut, const uint16_t *decode) {
    texel_sum sum = {0};
    uint64_t left = (uint64_t)x * image->width, right = left + image->width;
    uint64_t top = (uint64_t)y * image->height, bottom = top + image->height;
    for (uint64_t j = top / height; j * height < bottom; ++j) {
        uint64_t low = j * height > top ? j * height : top;
        uint64_t high = (j + 1) * height < bottom ? (j + 1) * height : bottom;
        for (uint64_t i = left / width; i * width < right; ++i) {
            uint64_t first = i * width > left ? i * width : left;
            uint64_t last = (i + 1) * width < right ? (i + 1) * width : right;
            add_texel(&sum, source_texel(image, (uint32_t)i, (uint32_t)j, cut, decode),
                      (high - low) * (last - first));
        }
    }
    return mean_texel(&sum);
}

/* Largest power of two not above `side` or `limit`, as its exponent. */
static uint32_t side_bits(uint32_t side, uint32_t limit) {
    uint32_t bits = 0;
    while ((2u << bits) <= side && (2u << bits) <= limit)
        bits++;
    return bits;
}

/* Appends the next level of a chain: each texel is the mean of the texels above it. */
static void halve(const gw_chain_texel *above, uint32_t width, uint32_t height, gw_chain_texel *below) {
    uint32_t step_x = width > 1 ? 2 : 1, step_y = height > 1 ? 2 : 1;
    for (uint32_t y = 0; y < height / step_y; ++y)
        for (uint32_t x = 0; x < width / step_x; ++x) {
            texel_sum sum = {0};
            for (uint32_t j = 0; j < step_y; ++j)
                for (uint32_t i = 0; i < step_x; ++i)
                    add_texel(&sum, above[(size_t)(y * step_y + j) * width + x * step_x + i], 1);
            below[(size_t)y * (width / step_x) + x] = mean_texel(&sum);
        }
}

static gw_code append_chain(gw_texture_chains *chains, const gw_image *image, uint32_t cut,
                            uint32_t maximum_side, const uint16_t *decode, gw_error *error) {
    gw_texture_chain chain = {.offset = (uint32_t)chains->texel_count,
                              .width_bits = side_bits(image->width, maximum_side),
                              .height_bits = side_bits(image->height, maximum_side)};
    uint32_t width = 1u << chain.width_bits, height = 1u << chain.height_bits;
    size_t needed = chains->texel_count + (size_t)width * height * 2 + 32;
    if (needed > INT32_MAX)
        return gw_fail(error, GW_MACHINE,
                       "the textures' mip chains need %zu texels, more than 2^31; lower "
                       "payload_texture_side (now %u)",
                       needed, maximum_side);
    gw_code code = gw_grow((void **)&chains->texels, &chains->texel_capacity, needed, sizeof *chains->texels,
                           "texture mip chains", error);
    if (code != GW_OK)
        return code;
    gw_chain_texel *level = chains->texels + chain.offset;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            level[(size_t)y * width + x] = area_mean(image, width, height, x, y, cut, decode);
    chains->texel_count += (size_t)width * height;
    while (width > 1 || height > 1) {
        gw_chain_texel *next = level + (size_t)width * height;
        halve(level, width, height, next);
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
        chains->texel_count += (size_t)width * height;
        level = next;
    }
    chains->chains[chains->count++] = chain;
    return GW_OK;
}

static chain_key key_of(const gw_material *material) {
    chain_key key = {material->base_color_texture, 0};
    if (material->alpha_mode == GW_ALPHA_MASK) {
        float needed =
            material->base_color[3] > 0 ? material->alpha_cutoff / material->base_color[3] * 255.0f : 256.0f;
        key.cut = needed >= 256.0f ? 256 : needed <= 1.0f ? 1 : (uint32_t)ceilf(needed);
    }
    return key;
}

gw_code gw_texture_chains_init(const gw_scene *scene, uint32_t maximum_side, gw_texture_chains *out,
                               gw_error *error) {
    uint16_t decode[256];
    chain_key *keys = NULL;
    *out = (gw_texture_chains){0};
    fill_decode_table(decode);
    gw_code code = gw_allocate((void **)&keys, scene->material_count, sizeof *keys, "texture chains", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&out->chains, scene->material_count, sizeof *out->chains,
                           "texture chains", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&out->chain_of, scene->material_count, sizeof *out->chain_of,
                           "texture chains", error);
    for (uint32_t m = 0; code == GW_OK && m < scene->material_count; ++m) {
        chain_key key = key_of(&scene->materials[m]);
        uint32_t c = 0;
        out->chain_of[m] = -1;
        if (key.texture < 0)
            continue;
        while (c < out->count && (keys[c].texture != key.texture || keys[c].cut != key.cut))
            c++;
        if (c == out->count) {
            keys[c] = key;
            code =
                append_chain(out, &scene->textures[key.texture].image, key.cut, maximum_side, decode, error);
        }
        out->chain_of[m] = (int32_t)c;
    }
    free(keys);
    if (code != GW_OK)
        gw_texture_chains_finish(out);
    return code;
}

void gw_texture_chains_finish(gw_texture_chains *chains) {
    free(chains->chains);
    free(chains->texels);
    free(chains->chain_of);
    *chains = (gw_texture_chains){0};
}
