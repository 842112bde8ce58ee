/* Text and boxes drawn over a picture: tile names, status, overlays. A small font of this program's own for
 * ASCII 32 to 126, on cells of 6 x 10 px, at whole scales so that it stays sharp on any panel. Host only, no
 * state; any thread. Everything is cut at the image's border. */
#ifndef GW_WALL_OVERLAY_TEXT_H
#define GW_WALL_OVERLAY_TEXT_H

#include "base/image.h"

#include <stdint.h>

enum { GW_TEXT_ADVANCE = 6, GW_TEXT_LINE = 10 }; /* px of a cell at scale 1 */

/* Draws text whose first cell has its top left corner at (x, y) px; '\n' begins a new line below the first.
 * scale: 1 or more px a dot. color: R, G, B, alpha. Bytes outside 32 to 126 show as '?'. */
void gw_text_draw(gw_image *image, int64_t x, int64_t y, uint32_t scale, const uint8_t color[4],
                  const char *text);
/* px that it takes: the longest line's cells, and all lines'. */
void gw_text_measure(const char *text, uint32_t scale, uint32_t *width, uint32_t *height);

/* A box filled with color; alpha below 255 lets the picture show through. */
void gw_box_draw(gw_image *image, int64_t x, int64_t y, int64_t width, int64_t height,
                 const uint8_t color[4]);

#endif
