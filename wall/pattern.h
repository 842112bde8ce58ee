/* Test patterns: pictures of a tile that are made from the site alone, without scene or octree, to see
 * whether the wall is as its site file says.
 *
 * grid: lines every 10 and 100 mm at whole millimetres of wall space, so that they run straight on across
 * bezels and gaps, whatever the pixels' sizes; a line across the whole wall; the tile's name, its machine and
 * an arrow to its upper side; marks on its outermost pixels; a ramp of greys beside fine stripes of the same
 * light. colours: bars of the primaries and their mixtures, and greys. names: only who is who. Host only, no
 * state; any thread. */
#ifndef GW_WALL_PATTERN_H
#define GW_WALL_PATTERN_H

#include "base/image.h"
#include "base/status.h"
#include "wall/site.h"

#include <stdint.h>

typedef enum gw_pattern_kind {
    GW_PATTERN_NONE,
    GW_PATTERN_GRID,
    GW_PATTERN_COLOURS,
    GW_PATTERN_NAMES,
    GW_PATTERN_COUNT
} gw_pattern_kind;

extern const char *const gw_pattern_names[GW_PATTERN_COUNT]; /* as the command line writes them */

/* Fills pixels ([height][width][4] of the tile's rectangle). */
void gw_pattern_draw(gw_pattern_kind kind, const gw_site *site, uint32_t tile, uint8_t *pixels);

/* The two axes of wall space, 0 to 2, that a tile's grid stands on: across is the one that its rows run
 * along most, down its columns. */
void gw_pattern_axes(const gw_tile *tile, int axes[2]);

#endif
