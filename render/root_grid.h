/* The root grid: a dense grid of the octree's cells of one level, kept on the GPU behind the nodes, where the
 * walk of rays that meet triangles only starts and where it returns to. It spares the levels above: fewer
 * steps, a shorter stack (docs/performance.md). Entries are nodes; common/shared.h tells what they hold.
 * Plain values; any thread. */
#ifndef GW_RENDER_ROOT_GRID_H
#define GW_RENDER_ROOT_GRID_H

#include "build/octree.h"

#include <stddef.h>
#include <stdint.h>

/* Level of the grid for this octree, 0: none. At most 64^3 (2 MiB) and half as many entries as nodes. */
uint32_t gw_root_grid_level(const gw_octree *octree);
/* Entries of a grid of that level; 0 of none. */
size_t gw_root_grid_size(uint32_t level);
/* Where it begins in the array of nodes, so that the array has no padding behind it: kernels find it from the
 * end. */
size_t gw_root_grid_begin(const gw_octree *octree);
/* Writes gw_root_grid_size(level) entries, x fastest. level: 1 to the octree's depth - 1. */
void gw_root_grid_fill(const gw_octree *octree, uint32_t level, gw_node *out);

#endif
