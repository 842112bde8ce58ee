/* A picture on the GPU that is copied to a window: sRGB codes as they are, no conversion anywhere. The thread
 * of the window's device. */
#ifndef GW_WALL_PRESENT_IMAGE_H
#define GW_WALL_PRESENT_IMAGE_H

#include "base/gl.h"

#include <stdint.h>

typedef struct gw_present_image {
    GLuint texture, framebuffer; /* 0: empty */
    uint32_t size[2];            /* px */
} gw_present_image;

gw_code gw_present_image_create(const uint32_t size[2], gw_present_image *out, gw_error *error);
void gw_present_image_finish(gw_present_image *image); /* accepts an empty one */
/* Rows top to bottom, 4 bytes a pixel. */
void gw_present_image_write(const gw_present_image *image, const uint8_t *rgba);
/* A rectangle of a window's picture, from its top left corner. */
typedef struct gw_present_place {
    int32_t x, y;
    uint32_t width, height; /* px */
} gw_present_place;
/* Into the back buffer of the window whose context is current, which is `window` px large: pixel by pixel
 * where the place has the picture's own size, else scaled. After kernels have written the picture, too. */
void gw_present_image_copy(const gw_present_image *image, const gw_present_place *place,
                           const uint32_t window[2]);

#endif
