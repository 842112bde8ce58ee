// Which fragments of a dispatch reflect as mirrors. They are numbered; the number finds what was reflected.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 LOD=1 FRAGMENTS=8u; OCTREE_DEPTH=11 LOD=1 RESUME=1 FRAGMENTS=8u
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
layout(std430, binding = 19) writeonly buffer Reflection_of { uint reflection_of[]; };
layout(std430, binding = 20) writeonly buffer Mirrors { uint mirrors[]; };
#include "trace/fetch.glsl"
#include "shade/surface.glsl"
#include "shade/mirror_share.glsl"

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
    uint count = GW_STATUS_COUNT(status.x);
    for (uint i = 0u; i < count; ++i) {
        uint fragment = slot * FRAGMENTS + i, number = GW_NO_REFLECTION;
        if (mirror_share(fragments[fragment * GW_FRAGMENT_WORDS]) > 0.0) {
            number = atomicAdd(totals[3], 1u);
            mirrors[number] = fragment;
        }
        reflection_of[fragment] = number;
    }
}
