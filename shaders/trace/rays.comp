// Any rays, for oracles and benches: nearest triangle through the octree, by the traversal of trace/primary.comp, or with
// ANY_HIT whether there is one.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 ROOT_GRID_LEVEL=6; OCTREE_DEPTH=4 ROOT_GRID_LEVEL=3 STORAGE_FETCH=1; OCTREE_DEPTH=11 ANY_HIT=1; OCTREE_DEPTH=11 ANY_HIT=1 RESUME=1 DENSE_LEAVES=1; OCTREE_DEPTH=11 RESUME=1 COUNT=1 DOUBLE_EDGES=1 DENSE_LEAVES=1
// variants: OCTREE_DEPTH=9 CONTRACTED=1 DENSE_LEAVES=1; OCTREE_DEPTH=9 CONTRACTED_PRECISE=1 ORDERED_EDGES=1; OCTREE_DEPTH=9 FAST_TRIANGLES=1; OCTREE_DEPTH=9 WEIGHTED_DEPTHS=1 HITS_WITHIN_CELLS=1
// variants: OCTREE_DEPTH=9 STORAGE_FETCH=1 STACK_LOCAL=1; OCTREE_DEPTH=9 STACK_SHARED=1
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "trace/rays_main.glsl"
