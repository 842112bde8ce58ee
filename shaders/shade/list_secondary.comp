// Which secondary rays the fragments of a dispatch ask for. The rays are numbered; a fragment's word finds what they bring.
//
// variants: OCTREE_DEPTH=11 SECONDARY=1 TRANSMISSION=1 SMOOTH_NORMALS=1; OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 TRANSMISSION=1 REFLECTED=1 LOD=1 RESUME=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 TRANSMISSION=1 TRANSMISSION_MAPS=1 MAP_PLACEMENT=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1; OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 LOD=1 GAZE=1 SPARSE=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 REFLECTED=1 LOD=1 RESUME=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1; OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 MIRROR=1 TRANSMISSION=1 REFLECTED=1 LOD=1 RESUME=1 CLEARCOAT=1 SHEEN=1 SPECULAR=1 UNLIT=1 MATERIAL_MAPS=1 DATA_CLASSES=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 CLEARCOAT=1 LAYER_MAPS=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 CONES=1 OCCLUSION=1 LOD=1 FRAGMENTS=8u; OCTREE_DEPTH=11 SECONDARY=1 CONES=1 DIFFUSE=1 MIRROR=1 MATERIAL_MAPS=1
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
layout(std430, binding = 19) writeonly buffer Asked { uint asked_of[]; };
layout(std430, binding = 20) writeonly buffer Requests { uint requests[]; };
#ifdef TRANSMISSION
layout(std430, binding = 28) buffer Media { uvec2 media_of[]; }; // of rays, by slot
#endif
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "shade/surface.glsl"
#include "shade/secondary_kinds.glsl"

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
#ifdef TRANSMISSION
#ifdef RESUME
    uvec2 media = media_of[slot];
#else
    uvec2 media = media_of_start(slot);
    media_of[slot] = media;
#endif
#endif
#ifndef TRANSMISSION
    const uvec2 media = uvec2(0u);
#endif
    uint count = GW_STATUS_COUNT(status.x);
    for (uint i = 0u; i < count; ++i) {
        uint fragment = slot * FRAGMENTS + i, word = fragment * GW_FRAGMENT_WORDS;
        float t = uintBitsToFloat(fragments[word + 1u]), weight = uintBitsToFloat(fragments[word + 2u]);
        uint kinds = kinds_asked(ray, fragments[word], t, weight, media);
        uint rays = rays_of(kinds), first = 0u;
        if (rays > 0u)
            first = atomicAdd(totals[3], rays);
#ifdef TRANSMISSION
        if ((kinds & GW_RAY_REFRACTED) != 0u)
            atomicAdd(totals[GW_TOTAL_REFRACTED], 1u);
#endif
#ifdef CONES
        if ((kinds & GW_RAY_CONES) != 0u)
            atomicAdd(totals[GW_TOTAL_CONES], frame.sampling.z);
#endif
#ifdef GLOSSY
        if ((kinds & GW_RAY_REFLECTED) != 0u && reflects_as_gloss(fragments[word]))
            atomicAdd(totals[GW_TOTAL_GLOSSY], 1u);
        if ((kinds & GW_RAY_COAT) != 0u)
            atomicAdd(totals[GW_TOTAL_GLOSSY], 1u);
#endif
        for (uint which = 0u; which < rays; ++which)
            requests[first + which] = GW_REQUEST(fragment, which);
        asked_of[fragment] = GW_ASKED_WORD(first, kinds);
    }
}
