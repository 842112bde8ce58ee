/* 8-bit RGBA images: PNG in and out (libpng), JPEG in (libjpeg-turbo). Any thread. */
#ifndef GW_BASE_IMAGE_H
#define GW_BASE_IMAGE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_IMAGE_MAXIMUM_SIDE = 32768 };

/* Rows top to bottom, 4 bytes a pixel (R, G, B, A, sRGB-encoded as in the file), no row padding. */
typedef struct gw_image {
    uint32_t width, height; /* px, 1..GW_IMAGE_MAXIMUM_SIDE */
    uint8_t *rgba;          /* owned */
} gw_image;

gw_code gw_image_create(uint32_t width, uint32_t height, gw_image *out, gw_error *error); /* all bytes zero */
void gw_image_finish(gw_image *image);

/* Decodes PNG or JPEG by its first bytes; other kinds and broken data are GW_BAD_INPUT naming `name`.
 * Images larger than maximum_pixels are refused before they are decoded. */
gw_code gw_image_decode(const void *data, size_t size, const char *name, uint64_t maximum_pixels,
                        gw_image *out, gw_error *error);

/* Opaque RGB PNG (alpha is left out). comment, if not NULL, becomes a tEXt "Comment" that tells how the
 * picture was made. Written through a temporary name. */
gw_code gw_image_write_png(const char *path, const gw_image *image, const char *comment, gw_error *error);

/* Copies the rectangle of source at (0,0) into target at (x,y); parts outside target are cut. */
void gw_image_place(gw_image *target, const gw_image *source, int64_t x, int64_t y);

#endif
