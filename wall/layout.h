/* The wall as built: its tiles in millimetres and pixels, from --tiles/--size or from a site file
 * (wall/site.h). A plain value without pointers, so that rank 0 can send it to every rank as bytes. Any
 * thread. */
#ifndef GW_WALL_LAYOUT_H
#define GW_WALL_LAYOUT_H

#include "base/status.h"
#include "render/view.h"

#include <stdint.h>

enum { GW_MAXIMUM_TILES = 64, GW_MAXIMUM_WALL_SIDE = 32768 /* px */ };

typedef struct gw_tile {
    char name[32];          /* letters, digits, '-' and '_': it is part of file names */
    gw_plane plane;         /* all tiles of one split share the same numbers */
    gw_rectangle rectangle; /* of that plane's pixels */
    uint32_t picture[2];    /* px: where the tile stands in the picture without bezels */
    uint32_t framed[2];     /* px: where it stands in the picture with bezels */
} gw_tile;

typedef struct gw_layout {
    uint32_t tile_count; /* 1..GW_MAXIMUM_TILES; tile i belongs to rank i */
    uint32_t picture[2]; /* px, of the picture without bezels: the wall's size in pixels */
    uint32_t framed[2];  /* px, of the picture with bezels */
    double size[2];      /* mm, of the box around all tiles, seen from the front */
    double centre[3];    /* mm, of that box */
    double eye[3];       /* mm, where a viewer stands when nothing is tracked */
    gw_tile tiles[GW_MAXIMUM_TILES];
} gw_layout;

/* A grid of tiles; flat and as it lies on the table, before it hangs anywhere. */
typedef struct gw_grid {
    uint32_t columns, rows;
    uint32_t widths[GW_MAXIMUM_TILES], heights[GW_MAXIMUM_TILES]; /* px, of each column and row */
    double pitch[2];                                              /* mm per pixel, across and down */
    double left, right, top, bottom;                              /* mm, bezel of each tile on that side */
    double column_gaps[GW_MAXIMUM_TILES], row_gaps[GW_MAXIMUM_TILES]; /* mm, of air after column or row i */
    double eye[3];                                                    /* mm */
} gw_grid;

/* Where a grid hangs, and how it is bent round an axis that is parallel to `up`: the middles of its columns
 * touch a circle whose centre lies `radius` in front of the grid's middle. */
typedef struct gw_hang {
    double centre[3];       /* mm, of the grid with its outer bezels */
    double right[3], up[3]; /* unit, at right angles; right x up faces the viewer */
    double radius;          /* mm; 0: flat */
    double angle;           /* radians from a column to the next */
    double lean;            /* radians by which each row leans more to the viewer than the row below it */
} gw_hang;

/* Flat, facing +z, centred on (0,0,0). */
extern const gw_hang gw_hang_front;

/* Splits `pixels` into `count` parts as evenly as whole pixels allow: part i is [i*pixels/count,
 * (i+1)*pixels/count). pixels >= count. */
void gw_split_evenly(uint32_t pixels, uint32_t count, uint32_t *parts);

/* The grid alone on a flat wall, as gw_hang_front hangs it. Without bezels and gaps all tiles are cut from
 * one plane and share its numbers, so that every split of it gives the same pixels; else each tile is its own
 * plane. Tiles are named c0r0, c1r0, ... row by row from the top left. GW_BAD_INPUT for too many tiles, no
 * pixels, or sizes that are not finite and positive. */
gw_code gw_layout_grid(const gw_grid *grid, gw_layout *out, gw_error *error);

/* Adds the tiles of a grid to a layout that gw_layout_measure then completes. In both pictures the grid's
 * first pixel is at `place` and framed_place; framed_end is where its picture with bezels ends. A name, if
 * not "", stands before those of the tiles: NAME-c0r0, or NAME alone for a grid of one tile. */
gw_code gw_layout_add_grid(const gw_grid *grid, const gw_hang *hang, const char *name,
                           const uint32_t place[2], const uint32_t framed_place[2], gw_layout *layout,
                           uint32_t framed_end[2], gw_error *error);

/* The plane of a panel with these outer corners (top left, top right, bottom left; mm) and this many pixels.
 * Every plane is made here, so that printed corners give the same bits again. */
void gw_plane_from_corners(const double corners[3][3], const uint32_t pixels[2], gw_plane *out);

/* A tile's corners in mm: top left, top right, bottom left, bottom right. */
void gw_tile_corners(const gw_tile *tile, double out[4][3]);

/* The point of wall space (mm) under a position of the picture without bezels (px, fractions allowed).
 * GW_BAD_INPUT when no tile is there. */
gw_code gw_layout_point(const gw_layout *layout, const double pixel[2], double out[3], gw_error *error);

/* "c1r0, c2r0, c0r1 and 3 more": the tiles whose bits are set in `tiles`, as far as there is room. */
void gw_layout_names(const gw_layout *layout, uint64_t tiles, char *text, size_t room);

/* Fills size, centre and picture from the tiles. */
gw_code gw_layout_measure(gw_layout *layout, gw_error *error);

/* Fills framed: the tiles as they hang seen from the front, at the first tile's pixel size, pushed apart
 * where they would hide each other (a bent wall seen from the front is too narrow for its pixels), with the
 * gaps that they have. */
gw_code gw_layout_frame(gw_layout *layout, gw_error *error);

#endif
