// Which shadow rays the fragments of a dispatch need: one for each light that their surface faces. The others' visibility is
// 0 at once. A ray is the place of its visibility, fragment * lights + light.
//
// variants: OCTREE_DEPTH=11 REFLECTED=1 FRAGMENTS=8u; OCTREE_DEPTH=11; OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 FRAGMENTS=8u; OCTREE_DEPTH=11 LOD=1 GAZE=1 RESUME=1 FRAGMENTS=8u
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
layout(std430, binding = 15) writeonly buffer Visibilities { float visibilities[]; };
layout(std430, binding = 16) writeonly buffer Shadow_rays { uint shadow_rays[]; };
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "shade/surface.glsl"
#include "shade/light_list.glsl"
#include "shade/shadow_ray.glsl"

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
    uint count = GW_STATUS_COUNT(status.x);
    for (uint i = 0u; i < count; ++i) {
        uint fragment = slot * FRAGMENTS + i, word = fragment * GW_FRAGMENT_WORDS;
        uint id = fragments[word];
        float t = uintBitsToFloat(fragments[word + 1u]);
        for (uint light = 0u; light < light_count(); ++light) {
            uint place = fragment * light_count() + light;
            if (shadow_ray_of(id, t, ray.origin, ray.direction, footprint_at(ray, t), ray.tau, light).needed)
                shadow_rays[atomicAdd(totals[3], 1u)] = place;
            else
                visibilities[place] = 0.0;
        }
    }
}
