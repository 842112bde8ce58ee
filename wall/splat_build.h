/* The build loop of Weier et al. 2014 (section 3), for the bench only: from the voxeliser's fragments, level
 * by level with compare-and-swap, to nodes, triangle index array and voxels. Needs the GL device's thread. */
#ifndef GW_WALL_SPLAT_BUILD_H
#define GW_WALL_SPLAT_BUILD_H

#include "base/gl.h"
#include "base/status.h"
#include "wall/voxelise.h"

#include <stdint.h>

typedef enum gw_splat_phase {
    GW_SPLAT_TOP_DOWN,  /* insertion and splitting, all levels */
    GW_SPLAT_LISTS,     /* count, prefix sum, fill, relink */
    GW_SPLAT_LEAVES,    /* voxels of leaves */
    GW_SPLAT_BOTTOM_UP, /* voxels of inner nodes */
    GW_SPLAT_PHASES
} gw_splat_phase;

/* The counts do not depend on the order of atomics. */
typedef struct gw_splat_counts {
    uint64_t nodes; /* empty ones included: eight children each */
    uint64_t inner, leaves, empty;
    uint64_t pair_entries, list_entries; /* of the triangle index array */
    double milliseconds[GW_SPLAT_PHASES];
} gw_splat_counts;

/* depth: of the finest level, 1 to 10; the fragments are of 2^depth voxels a side. GW_MACHINE when they are
 * not all on the GPU in one buffer (gw_voxelised.buffer) or the nodes do not fit one. */
gw_code gw_splat_build(gw_gl *device, const gw_voxelised *voxelised, uint32_t depth, uint32_t triangle_count,
                       gw_splat_counts *out, gw_error *error);

#endif
