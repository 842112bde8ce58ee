// Which shadow rays the fragments of a dispatch need: one for each light that their surface faces; the others' visibility is 0 at
// once. What a ray meets in one voxel and its children, within the side of the coarsest voxel that its accepted error allows,
// lies in one light: the first fragment's ray serves those behind it, also those of later rounds. A ray is the place of its
// visibility, fragment * lights + light.
//
// variants: OCTREE_DEPTH=11 REFLECTED=1 FRAGMENTS=8u; OCTREE_DEPTH=11; OCTREE_DEPTH=11 EMISSIVE_LIGHTS=1; OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 SPOT_LIGHTS=1 AREA_LIGHTS=1 FRAGMENTS=8u; OCTREE_DEPTH=11 LOD=1 COARSE_APART=1 GAZE=1 RESUME=1 FRAGMENTS=8u
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 1) readonly buffer Statuses { uvec2 statuses[]; };
layout(std430, binding = 3) buffer Totals { uint totals[]; };
#ifdef RESUME
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };
layout(location = 0) uniform uint queue_length;
#endif
layout(std430, binding = 15) buffer Visibilities { uint visibilities[]; };
layout(std430, binding = 16) writeonly buffer Shadow_rays { uint shadow_rays[]; };
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "shade/surface.glsl"
#include "shade/light_list.glsl"
#include "shade/shadow_ray.glsl"

// With COARSE_APART rays that may meet voxels stand apart, at the end of the list.
void list_ray(uint place, Shadow_ray shadow, uint id, float tau) {
#ifdef COARSE_APART
    bool coarse = (id & GW_FRAGMENT_VOXEL) != 0u || accepted_at_start(shadow, tau) >= 0.5;
    if (coarse)
        shadow_rays[kept_begin - 1u - atomicAdd(totals[GW_TOTAL_COARSE_SHADOWS], 1u)] = place;
    else
        shadow_rays[atomicAdd(totals[3], 1u)] = place;
#else
    shadow_rays[atomicAdd(totals[3], 1u)] = place;
#endif
}

// The rays of one light; the last one that was listed, also in an earlier round, may serve others.
void list_light(uint slot, Pixel_ray ray, uint count, uint light) {
    uint server = GW_NO_PLACE;
    float served_from = 0.0;
#ifdef LOD
    uint kept = kept_place(slot, light);
    float size = length_precise(ray.direction);
#ifdef RESUME
    server = visibilities[kept] == GW_NO_PLACE ? GW_NO_PLACE : kept;
    served_from = uintBitsToFloat(visibilities[kept + 1u]);
#endif
#endif
    for (uint i = 0u; i < count; ++i) {
        uint fragment = slot * FRAGMENTS + i, word = fragment * GW_FRAGMENT_WORDS;
        uint place = fragment * light_count() + light;
        float t = uintBitsToFloat(fragments[word + 1u]), width = footprint_at(ray, t);
        Shadow_ray shadow = shadow_ray_of(fragments[word], t, ray.origin, ray.direction, width, ray.tau, light);
        bool served = false;
#ifdef LOD
        precise float behind = (t - served_from) * size;
        served = server != GW_NO_PLACE && behind <= coarsest_voxel(frame.secondary.x * ray.tau * width);
#endif
#ifdef REFLECTED
        shadow.needed = shadow.needed && ray.reach >= 0.0;
#endif
        if (shadow.needed && !served) {
            list_ray(place, shadow, fragments[word], ray.tau);
            server = place;
            served_from = t;
        } else {
            visibilities[place] = shadow.needed ? server | GW_SERVED : 0u;
        }
    }
#ifdef LOD
#ifndef RESUME
    visibilities[kept] = GW_NO_PLACE;
#endif
    visibilities[kept + 1u] = floatBitsToUint(served_from);
    visibilities[kept + 2u] = server == kept ? GW_NO_PLACE : server;
#endif
}

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
#ifdef RESUME
    bool present = at < queue_length;
    uint slot = queue[present ? at : 0u];
#else
    bool present = true;
    uint slot = at;
#endif
    uvec2 status = statuses[slot];
    if (!present || (status.x & GW_STATUS_OUTSIDE) != 0u)
        return;
    Pixel_square square;
    Pixel_ray ray = ray_of_slot(slot, square);
    seed_lights(square, ray);
    for (uint light = 0u; light < light_count(); ++light)
        list_light(slot, ray, GW_STATUS_COUNT(status.x), light);
}
