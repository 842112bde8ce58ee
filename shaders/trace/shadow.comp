// What share of a light reaches what a fragment shows. Where voxels or alpha may stand between, opacities are composited
// along the ray as for pixels (trace/traverse_lod.glsl), else any triangle will do. With UNTIL_COARSE the rays are those of a frame
// with voxels that start at triangles and are too narrow for any voxel: most are, and the walk without voxels is cheaper.
//
// variants: OCTREE_DEPTH=11 REFLECTED=1 LOD=1 SPOT_LIGHTS=1 AREA_LIGHTS=1 FRAGMENTS=8u; OCTREE_DEPTH=11; OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 LEVEL_BLEND=1 LEAF_BLEND=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 RESUME=1 WIDE_NODES=1 DENSE_LEAVES=1 DOUBLE_EDGES=1 COUNT=1
// variants: OCTREE_DEPTH=11 ALPHA=1 TRANSMISSION=1 TRANSMISSION_MAPS=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 ALPHA=1 TRANSMISSION=1 ABSORPTION=1; OCTREE_DEPTH=15 ALPHA=1 TEXTURES=1 TEXTURE_CLASSES=2 VERTEX_COLORS=1 COUNT=1
// variants: OCTREE_DEPTH=11 LOD=1 ALPHA=1 RESUME=1 DENSE_LEAVES=1 FRAGMENTS=8u; OCTREE_DEPTH=9 LOD=1 VOXELS_ONLY=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 ROOT_GRID_LEVEL=6 UNTIL_COARSE=1 GAZE=1 SPARSE=1 FRAGMENTS=8u; OCTREE_DEPTH=11 ROOT_GRID_LEVEL=6 LOD=1 EMISSIVE_LIGHTS=1 FRAGMENTS=8u
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
#ifndef TEXTURE_CLASSES
#define TEXTURE_CLASSES 0
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 3) buffer Totals { uint totals[]; };
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };          // suspended shadow rays of the batch
layout(std430, binding = 5) writeonly buffer NextQueue { uint next_queue[]; };
#ifdef COUNT
layout(std430, binding = 6) buffer Work { uint work_words[]; };
#endif
layout(std430, binding = 15) writeonly buffer Visibilities { uint visibilities[]; };
layout(std430, binding = 16) readonly buffer Shadow_rays { uint shadow_rays[]; };
layout(location = 0) uniform uint queue_length; // or the number of rays in the batch
layout(location = 2) uniform uint batch_begin;
#undef UNTIL_COARSE // its one use here is to say that fragments have room for voxels
#define SHADOW_RAYS 1
#define WIDE_RAYS 1
#if defined(ALPHA) && !defined(LOD)
#define LOD 1 // at tau 0
#endif
#define ANY_HIT 1
#include "trace/pixel.glsl"
#include "trace/walk.glsl"
#include "blend/opacity.glsl"
#include "shade/surface.glsl"
#include "shade/light_list.glsl"
#include "shade/shadow_ray.glsl"
#ifdef TRANSMISSION
#include "shade/transmission.glsl"
#endif
#ifdef LOD
Shadow_ray shadow;
#ifdef ALPHA
#ifdef TRANSMISSION
#include "shade/shadow_tint.glsl"
#endif

// Opacity of the triangle that the ray has met at t.
float alpha_of_hit(uint triangle, float t) {
    precise float width = max(shadow.width - shadow.narrowing * t, 0.0);
    Surface surface = surface_of_triangle(triangle, t, ray_origin, ray_direction, width);
#ifdef TRANSMISSION
    surface.alpha = tinted_alpha(triangle, surface, t);
#endif
    return surface.alpha;
}
#endif
#include "trace/traverse_lod.glsl"
#else
#include "trace/traverse_exact.glsl"
#endif
#include "trace/state.glsl"

void begin(Shadow_ray ray, float tau) {
    hit_t = ray.maximum;
    hit_triangle = GW_NO_TRIANGLE;
    floor_t = 0.0;
    floor_triangle = GW_NO_TRIANGLE;
    iterations = 0u;
    list_cursor = 0u;
#ifdef COUNT
    work = uvec4(0u);
#endif
#ifdef LOD
    shadow = ray;
    ray_maximum = ray.maximum;
    precise float grid = frame.secondary.x * tau * GRID_HALF;
    precise float slope = -ray.narrowing * grid;
    lod_slope = slope;
    lod_start = accepted_at_start(ray, tau);
    lod_clear = ray.clear;
    transmittance = 1.0;
    group_opacity = 0.0;
    group_lean = 0.0;
    group_end = -1.0;
    voxel_scale = 0;
    leave_ahead = false;
    child_share = 0.0;
    outer_share = 0.0;
    voxel_given = 0.0;
    leaf_share = 1.0;
    leaf_again = false;
    fragment_count = 0u;
#endif
#if defined(ALPHA)
    hit_flags = 0u;
#endif
#ifdef TRANSMISSION
    begin_tint();
#endif
}

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (at >= queue_length)
        return;
#ifdef RESUME
    uint ray_slot = queue[at];
#else
    uint ray_slot = at;
#endif
    uint place = shadow_rays[batch_begin + ray_slot];
    uint fragment = place / light_count(), word = fragment * GW_FRAGMENT_WORDS;
    Pixel_square square;
    Pixel_ray pixel = ray_of_slot(fragment / FRAGMENTS, square);
    float t = uintBitsToFloat(fragments[word + 1u]);
    seed_lights(square, pixel);
    Shadow_ray ray = shadow_ray_of(fragments[word], t, pixel.origin, pixel.direction, footprint_at(pixel, t), pixel.tau,
                                   place % light_count());
    set_ray(ray.origin, ray.direction);
    begin(ray, pixel.tau);
    walking = enter_root(0.0);
#ifdef RESUME
    in_root = true;
    state_load(ray_slot);
    walking = true;
#endif
    traverse();
    if (walking && iterations >= LOOP_BUDGET) {
        state_save(ray_slot);
        next_queue[atomicAdd(totals[2], 1u)] = ray_slot;
    } else {
        if (walking)
            atomicAdd(totals[0], 1u); // the driver ended a loop
#ifdef LOD
        float left = remaining();
        visibilities[place] = floatBitsToUint(left >= OPAQUE_REMAINDER ? left : 0.0);
#ifdef TRANSMISSION
        visibilities[place + uint(visibilities.length()) / 2u] = tint_word(ray.maximum);
#endif
#else
        visibilities[place] = floatBitsToUint(hit_triangle == GW_NO_TRIANGLE ? 1.0 : 0.0);
#endif
    }
#ifdef COUNT
    atomicMax(totals[GW_TOTAL_ITERATIONS], iterations);
    for (int i = 0; i < 4; ++i)
        atomicAdd(work_words[(fragment / FRAGMENTS) * 4u + uint(i)], work[i]);
#endif
}
