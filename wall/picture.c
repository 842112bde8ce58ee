#include "wall/picture.h"

#include "base/file.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fill(gw_image *image, uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                 const uint8_t color[4]) {
    for (uint32_t row = y; row < y + height; row++)
        for (uint32_t column = x; column < x + width; column++)
            memcpy(image->rgba + ((size_t)row * image->width + column) * 4, color, 4);
}

gw_code gw_picture_assemble(const gw_layout *layout, const uint8_t *const *pixels, int framed, gw_image *out,
                            gw_error *error) {
    static const uint8_t bezel[4] = {24, 24, 26, 255}, missing[4] = {96, 0, 16, 255};
    const uint32_t *size = framed ? layout->framed : layout->picture;
    gw_code code = gw_image_create(size[0], size[1], out, error);
    if (code)
        return code;
    fill(out, 0, 0, size[0], size[1], bezel);
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        const gw_tile *tile = &layout->tiles[i];
        const uint32_t *at = framed ? tile->framed : tile->picture;
        uint32_t width = tile->rectangle.width, height = tile->rectangle.height;
        if (!pixels[i]) {
            fill(out, at[0], at[1], width, height, missing);
            continue;
        }
        for (uint32_t row = 0; row < height; row++)
            memcpy(out->rgba + ((size_t)(at[1] + row) * out->width + at[0]) * 4,
                   pixels[i] + (size_t)row * width * 4, (size_t)width * 4);
    }
    return GW_OK;
}

char *gw_picture_path(const char *folder, const char *format, ...) {
    char name[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    return gw_path_join(folder, name);
}
