/* (voxel, triangle) pairs as two methods find them, and what tells the methods apart. Any thread. */
#ifndef GW_WALL_VOXEL_PAIRS_H
#define GW_WALL_VOXEL_PAIRS_H

#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "wall/voxelise.h"

#include <stddef.h>
#include <stdint.h>

/* Morton code of the voxel << 32 | triangle, rising, each once. */
typedef struct gw_pairs {
    uint64_t *keys;
    size_t count;
} gw_pairs;

void gw_pairs_finish(gw_pairs *pairs);
gw_code gw_pairs_of_fragments(const gw_voxelised *voxelised, gw_pairs *out, gw_error *error);
/* Of an octree that is refined to its limit everywhere (leaf_triangles 0). */
gw_code gw_pairs_of_octree(const gw_octree *octree, gw_pairs *out, gw_error *error);

typedef struct gw_pair_differences {
    uint64_t both;
    /* Found by refinement alone, and why the rasteriser has none: */
    uint64_t other_depth; /* it keeps one voxel of each pixel, and the triangle passes through two or three */
    uint64_t thinner;     /* no fragment in that column: the triangle reaches in by less than the rasteriser's
                             subpixel grid */
    uint64_t no_fragment; /* no fragment in that column, though it reaches in further */
    uint64_t
        touching; /* the triangle comes no nearer than the margin by which refinement inflates its boxes */
    /* Found by the rasteriser alone: */
    uint64_t beside;      /* the enlarged triangle covers the voxel, the triangle itself does not touch it */
    uint64_t unexplained; /* the triangle does touch it: refinement has missed it */
} gw_pair_differences;

/* resolution: voxels along a side. subpixel: the rasteriser's grid, of a pixel (2^-GL_SUBPIXEL_BITS). Overlap
 * is decided in double precision. */
gw_code gw_pairs_compare(const gw_scene *scene, uint32_t resolution, double subpixel, const gw_pairs *refined,
                         const gw_pairs *rasterised, gw_pair_differences *out, gw_error *error);

/* 1 if the triangle meets the box, by the separating-axis test in double precision (Akenine-Moeller 2001). */
int gw_triangle_meets_box(const double triangle[3][3], const double centre[3], double half_side);

#endif
