/* The pictures of single tiles in the folder of a run. On one machine every rank writes its own; on a cluster
 * those on rank 0's machine do, and rank 0 writes the others', so that all are found in one folder without a
 * shared file system. */
#ifndef GW_WALL_TILE_PICTURE_H
#define GW_WALL_TILE_PICTURE_H

#include "base/status.h"
#include "wall/gate.h"
#include "wall/rank.h"

#include <stdint.h>

/* 1 when the tile's own rank writes its pictures. */
int gw_tile_writes_itself(const gw_rank *rank, uint32_t tile);
/* tile-NAME-NNNN.png, and for the last frame tile-NAME.png. pixels are [height][width][4] of the tile. */
gw_code gw_tile_write_pictures(const gw_rank *rank, uint32_t tile, const uint8_t *pixels,
                               const gw_release *release, gw_error *error);
/* Rank 0: those of the tiles that cannot write them themselves; pixels[tile], NULL: it is lost. */
gw_code gw_tile_write_others(const gw_rank *rank, const gw_release *release, const uint8_t *const *pixels,
                             gw_error *error);

#endif
