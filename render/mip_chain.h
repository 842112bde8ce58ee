/* Resizing and halving of images in linear light, 16 bits a channel, straight alpha; colour is averaged with
 * alpha as its weight, so that what is transparent does not bleed. Host only; any thread. */
#ifndef GW_RENDER_MIP_CHAIN_H
#define GW_RENDER_MIP_CHAIN_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* The sRGB curve by tables: bytes to 16 bits of linear light and back, to the nearest byte. What was a byte
 * comes back as that byte. 64 KiB: made once, then read by any thread. */
typedef struct gw_texel_curve {
    uint16_t decode[256];
    uint8_t encode[65536];
} gw_texel_curve;

void gw_texel_curve_init(gw_texel_curve *out);
/* No curve at all: for data. */
void gw_texel_curve_init_linear(gw_texel_curve *out);

/* Square of linear texels, RGBA. */
typedef struct gw_linear_image {
    uint32_t side;
    uint16_t (*texels)[4];
} gw_linear_image;

/* The texture resized to side x side: exact copy where sizes agree, area mean when shrinking, linear
 * interpolation (by the texture's wrap modes) when growing. */
gw_code gw_linear_image_init(const gw_texel_curve *curve, const gw_texture *texture, uint32_t side,
                             gw_linear_image *out, gw_error *error);
void gw_linear_image_finish(gw_linear_image *image);
/* Replaces the image by one of half its side; side must be at least 2. */
void gw_linear_image_halve(gw_linear_image *image);
/* sRGB-encoded bytes; rgba has side * side * 4 of them. */
void gw_linear_image_encode(const gw_texel_curve *curve, const gw_linear_image *image, uint8_t *rgba);

/* The same for an image of linear data that stands for normals (each channel -1..1, opaque): unit normals,
 * and in alpha how long their mean is, as 1 - sqrt(1 - length), which tells lengths near 1 apart (Toksvig,
 * Mipmapping Normal Maps, 2005). */
void gw_linear_image_encode_normals(const gw_linear_image *image, uint8_t *rgba);
/* Makes the normal of an 8-bit texel one of length 1. */
void gw_unit_texel(uint8_t texel[3]);

#endif
