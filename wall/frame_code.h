/* The frame code: a block of large cells on every tile that says which frame it shows, so that one photograph
 * of the wall proves that all tiles show the same one.
 *
 * 6 x 5 cells: a white ring, inside it 4 x 3 cells, white for 1 and black for 0: in the first row white,
 * black, white (for whoever reads: what white and black look like) and the frame's lowest bit; below it the
 * low 8 bits of the frame's number in Gray code, the highest first. From frame to frame one bit of the Gray
 * code changes, and the lowest bit does: a camera that was open while the frame changed sees those two cells
 * grey and no third number. Host only, no state; any thread. */
#ifndef GW_WALL_FRAME_CODE_H
#define GW_WALL_FRAME_CODE_H

#include "base/image.h"

#include <stdint.h>

enum { GW_CODE_COLUMNS = 6, GW_CODE_ROWS = 5, GW_CODE_PERIOD = 256 /* frames */ };

/* Where the block stands in a tile of width x height px: in its lower right corner. cell px a side. */
typedef struct gw_code_place {
    uint32_t x, y, cell; /* px */
} gw_code_place;
gw_code_place gw_frame_code_place(uint32_t width, uint32_t height);

/* Draws it into a picture of one tile. */
void gw_frame_code_draw(gw_image *tile, uint32_t frame);

typedef enum gw_code_reading {
    GW_CODE_READ,    /* clear */
    GW_CODE_CHANGED, /* the frame changed while the picture was taken */
    GW_CODE_NONE     /* no block, or not to be read */
} gw_code_reading;

/* Reads the block of the tile that covers a rectangle of a picture (px, fractions allowed: it may be a scaled
 * one), which is of width x height px on the wall. *frame: its number modulo GW_CODE_PERIOD, of GW_CODE_READ
 * only. */
gw_code_reading gw_frame_code_read(const gw_image *picture, const double rectangle[4], uint32_t width,
                                   uint32_t height, uint32_t *frame);

#endif
