/* The wall as one picture, with and without bezels, from its tiles' pixels. Any thread. */
#ifndef GW_WALL_PICTURE_H
#define GW_WALL_PICTURE_H

#include "base/image.h"
#include "base/status.h"
#include "wall/layout.h"

#include <stdint.h>

/* pixels[i]: of tile i ([height][width][4]), or NULL for a tile that is missing: its place is then a dark red
 * that no scene is likely to fill evenly. Bezels and gaps are dark grey. framed: 1 with bezels, 0 without. */
gw_code gw_picture_assemble(const gw_layout *layout, const uint8_t *const *pixels, int framed, gw_image *out,
                            gw_error *error);

/* "FOLDER/STEM.png" and the like: joins folder and a printf-made name. Free the result; NULL when memory is
 * out. */
char *gw_picture_path(const char *folder, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
