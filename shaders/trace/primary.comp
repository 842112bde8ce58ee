// One ray per pixel of a chunk: octree traversal, what was met becomes fragments for shade/shade.comp.
// With RESUME the rays of a queue, suspended by an earlier dispatch, go on. With UNTIL_COARSE rays are suspended before
// their first voxel, to go on with LOD: most rays never need that kernel, and software GL pays for all that is in one.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 LOD=1 GAZE=1 LEVEL_BLEND=1 LEAF_BLEND=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=15 ALPHA=1 COUNT=1 WIDE_NODES=1 DOUBLE_EDGES=1 RESUME=1
// variants: OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 FRAGMENTS=8u; OCTREE_DEPTH=11 LOD=1 GAZE=1 GAZE_SEED=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 REFLECTED=1 RESUME=1; OCTREE_DEPTH=11 REFLECTED=1 LOD=1 LEVEL_BLEND=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 UNTIL_COARSE=1 GAZE=1; OCTREE_DEPTH=11 ALPHA=1 TRANSMISSION=1; OCTREE_DEPTH=11 ALPHA=1 TRANSMISSION=1 REFLECTED=1 LOD=1 RESUME=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 ROOT_GRID_LEVEL=6 UNTIL_COARSE=1 GAZE=1; OCTREE_DEPTH=11 ROOT_GRID_LEVEL=6 LOD=1 GAZE=1 RESUME=1 LEVEL_BLEND=1 LEAF_BLEND=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 UNTIL_COARSE=1 REFLECTED=1 DENSE_LEAVES=1 ALPHA=1 COUNT=1
// variants: OCTREE_DEPTH=11 DENSE_LEAVES=1 COUNT=1; OCTREE_DEPTH=11 DENSE_LEAVES=1 LOD=1 RESUME=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=9 LOD=1 ALPHA=1 COUNT=1 RESUME=1 VOXELS_ONLY=1 FRAGMENTS=8u
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
uniform uint group_base;
layout(std430, binding = 0) writeonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 1) writeonly buffer Statuses { uvec2 statuses[]; }; // status, bits of what remains of the ray
layout(std430, binding = 3) buffer Totals { uint totals[]; };                // frame.h
#ifdef RESUME
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };
layout(location = 0) uniform uint queue_length;
#endif
#ifdef COUNT
layout(std430, binding = 6) buffer Work { uvec4 work_of[]; };
#endif
uint ray_slot;
#include "trace/pixel.glsl"
#ifdef REFLECTED
#define WIDE_RAYS 1
#endif
#include "trace/walk.glsl"
#include "blend/opacity.glsl"
#include "common/payload.glsl"
#ifdef LOD
#include "trace/traverse_lod.glsl"
#else
#include "trace/traverse_exact.glsl"
#endif
#include "trace/state.glsl"

const float NO_HIT = 1e30;

// No hit beyond it counts.
float end_of(Pixel_ray ray) {
#ifdef REFLECTED
    return ray.reach != 0.0 ? abs(ray.reach) : NO_HIT;
#else
    return NO_HIT;
#endif
}

void begin(Pixel_ray ray) {
    hit_t = end_of(ray);
    hit_triangle = GW_NO_TRIANGLE;
    floor_t = 0.0;
    floor_triangle = GW_NO_TRIANGLE;
    iterations = 0u;
    list_cursor = 0u;
#ifdef COUNT
    work = uvec4(0u);
#endif
#ifdef ALPHA
    hit_flags = 0u;
#endif
#ifdef OPACITY_STATE
    transmittance = 1.0;
    group_opacity = 0.0;
    group_lean = 0.0;
    group_end = -1.0;
#endif
#ifdef LOD_STATE
    precise float slope = ray.tau * ray.width * GRID_HALF;
    lod_slope = slope;
#ifdef REFLECTED
    precise float at_start = ray.tau * ray.start * GRID_HALF;
    lod_start = at_start;
    lod_clear = ray.clear;
#endif
#endif
#if defined(TRANSMISSION) && defined(REFLECTED)
    skipped_triangle = given_rays[ray_slot * GW_SECONDARY_ROWS + 3u].z;
#endif
#ifdef UNTIL_COARSE
    coarse_ahead = false;
#endif
#ifdef LOD
    voxel_scale = 0;
    leave_ahead = false;
    child_share = 0.0;
    outer_share = 0.0;
    voxel_given = 0.0;
    leaf_share = 1.0;
    leaf_again = false;
    fragment_count = 0u;
    ray_maximum = end_of(ray);
#endif
}

#ifndef LOD
// The nearest hit becomes the one fragment; returns the status.
uint emit_nearest() {
    if (hit_triangle == GW_NO_TRIANGLE)
        return 0u;
    uint at = ray_slot * FRAGMENTS * GW_FRAGMENT_WORDS;
    fragments[at] = hit_triangle & ~GW_HIT_BACK;
    fragments[at + 1u] = floatBitsToUint(hit_t);
    fragments[at + 2u] = floatBitsToUint(1.0);
    uint status = 1u;
#ifdef ALPHA
    begin_group_if_apart(hit_t);
    if ((hit_flags & GW_TRIANGLE_ALPHA) != 0u) {
        floor_t = hit_t;
        floor_triangle = hit_triangle;
#ifdef SKIP_BEHIND_HIT
        floor_t = hit_t + 1e-5; // the naive variant, for the test that shows why
#endif
        hit_t = NO_HIT;
        hit_triangle = GW_NO_TRIANGLE;
        cell = leaf_cell;
        cell_entry = leaf_entry;
        scale = leaf_parent_scale;
        in_root = true;
        return status | GW_STATUS_PROVISIONAL | GW_STATUS_SUSPENDED;
    }
    fragments[at + 2u] = floatBitsToUint(composite(1.0, 0.0, 1.0));
#endif
    return status;
}
#endif

void main() {
#ifdef RESUME
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    bool present = at < queue_length;
    ray_slot = queue[present ? at : 0u];
#else
    ray_slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    bool present = true;
#endif
    Pixel_square square;
    Pixel_ray ray = ray_of_slot(ray_slot, square);
    present = present && square.present;
    if (!present) {
#ifndef RESUME
        statuses[ray_slot] = uvec2(GW_STATUS_OUTSIDE, 0u);
#ifdef COUNT
        work_of[ray_slot] = uvec4(0u);
#endif
#endif
        return;
    }
    set_ray(ray.origin, ray.direction);
    begin(ray);
    walking = enter_root(0.0);
#ifdef RESUME
    in_root = true;
    state_load(ray_slot);
    walking = true;
#elif defined(UNTIL_COARSE) && defined(ROOT_GRID_SCALE)
    // A ray to whose far end cells above the grid may stand for their contents needs the levels that the grid skips.
    coarse_ahead = walking && most_accepted_error() >= LEAST_ABOVE_GRID;
    walking = walking && !coarse_ahead;
    scale = coarse_ahead ? SCALE_ABOVE_ROOT - 1 : scale;
#endif
    traverse();

    uint status = 0u;
#ifdef LOD
    bool stopped = provisional || fragments_full() || iterations >= LOOP_BUDGET;
    bool cut = walking && !stopped; // the driver ended a loop
    walking = walking && stopped;
    status = fragment_count | (walking ? GW_STATUS_SUSPENDED : 0u) | (provisional ? GW_STATUS_PROVISIONAL : 0u);
    float left = remaining();
#else
    bool cut = walking && iterations < LOOP_BUDGET; // the driver ended a loop
    walking = walking && !cut;
#ifdef UNTIL_COARSE
    // Where the other kernel expects the parent's scale, the walk has gone down to the cell's own.
    leaf_again = walking && list_cursor != 0u;
    scale += leaf_again || coarse_ahead ? 1 : 0;
    walking = walking || coarse_ahead;
#endif
    status = walking ? GW_STATUS_SUSPENDED : emit_nearest();
#ifdef ALPHA
    float left = remaining();
#else
    float left = (status & 1u) != 0u ? 0.0 : 1.0;
#endif
#endif
    if (cut)
        atomicAdd(totals[0], 1u);
    if ((status & (GW_STATUS_SUSPENDED | GW_STATUS_PROVISIONAL)) != 0u)
        state_save(ray_slot);
    statuses[ray_slot] = uvec2(status, floatBitsToUint(left));
#ifdef COUNT
    atomicMax(totals[GW_TOTAL_ITERATIONS], iterations);
#ifdef RESUME
    work += work_of[ray_slot];
#endif
    work_of[ray_slot] = work;
#endif
}
