// Kernel 4: each child cell becomes nothing, an inner cell or a leaf; sums for their places.
//
// Leaf by the K rule (at most leaf_triangles), by the fan rule (all triangles share one welded vertex, at most fan_cap:
// without it every vertex neighbourhood is refined to the depth limit), or at the depth limit. A leaf by K or fan is
// refined all the same while its triangles are whole connected components, each smaller than half the cell: an isolated
// small thing would otherwise have no voxel of its own size (Weier et al. 2014, abstract and section 1).
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(location = 7) uniform uint leaf_triangles;
layout(location = 8) uniform uint fan_cap; // 0: rule off
layout(location = 9) uniform uint isolation;
layout(location = 10) uniform uint at_limit; // 1: the children are at the depth limit
layout(location = 11) uniform uint least_pairs; // fewer: the memory budget keeps the cell from being refined

// Per triangle: three welded vertices and its connected component. The component's longest side is in the w of the
// triangle's first vertex, its number of triangles (at most 2^24, exact) in the w of the second.
layout(binding = 0) uniform samplerBuffer triangle_texels;
layout(binding = 1) uniform usamplerBuffer topology_texels;

layout(binding = 3) uniform usamplerBuffer pair_texels; // of all children
layout(std430, binding = 7) writeonly buffer Classes { uint classes[]; }; // kind, reason << 4, per slot
layout(std430, binding = 8) writeonly buffer SlotBases { uvec4 slot_bases[]; };
layout(std430, binding = 9) writeonly buffer SlotSums { uvec4 slot_sums[]; };

#define CLASS_EMPTY 0xfu
// The isolation test compares all pairs of a list; longer lists are no small isolated thing (and loops have a budget).
#define ISOLATED_AT_MOST 64u

bool shares_vertex(uint begin, uint count) {
    uvec3 common_vertices = texelFetch(topology_texels, int(texelFetch(pair_texels, int(begin)).x)).xyz;
    uint alive = 7u;
    for (uint i = 1u; i < count && alive != 0u; ++i) {
        uvec3 own = texelFetch(topology_texels, int(texelFetch(pair_texels, int(begin + i)).x)).xyz;
        for (uint k = 0u; k < 3u; ++k)
            if (!any(equal(own, uvec3(common_vertices[k]))))
                alive &= ~(1u << k);
    }
    return alive != 0u;
}

// True when the list holds whole connected components only, each smaller than half the cell. A component is whole when as
// many list members belong to it as it has triangles.
bool is_isolated(uint begin, uint count, float half_cell) {
    for (uint i = 0u; i < count; ++i) {
        int texel = int(texelFetch(pair_texels, int(begin + i)).x) * 3;
        if (texelFetch(triangle_texels, texel).w >= half_cell || texelFetch(triangle_texels, texel + 1).w > float(count))
            return false;
    }
    for (uint i = 0u; i < count; ++i) {
        int triangle = int(texelFetch(pair_texels, int(begin + i)).x);
        uint component = texelFetch(topology_texels, triangle).w;
        float found = 0.0;
        for (uint j = 0u; j < count; ++j)
            found += texelFetch(topology_texels, int(texelFetch(pair_texels, int(begin + j)).x)).w == component ? 1.0 : 0.0;
        if (found != texelFetch(triangle_texels, triangle * 3 + 1).w)
            return false;
    }
    return true;
}

uint classify(uint begin, uint count) {
    if (count == 0u)
        return CLASS_EMPTY;
    uint leaf = count == 1u ? GW_LEAF_SINGLE : GW_LEAF_LIST;
    uint reason = 0u;
    if (count <= leaf_triangles)
        reason = GW_REASON_SMALL;
    else if (count <= fan_cap && shares_vertex(begin, count))
        reason = GW_REASON_FAN;
    if (at_limit != 0u)
        return leaf | ((reason != 0u ? reason : GW_REASON_DEPTH) << 4);
    // The side of a child of a cell at `level` is 2^-level.
    bool isolated = reason != 0u && isolation != 0u && count <= ISOLATED_AT_MOST &&
                    is_isolated(begin, count, 0.5 / float(1u << level));
    if (reason != 0u && !isolated)
        return leaf | (reason << 4);
    if (count < least_pairs)
        return leaf | (GW_REASON_BUDGET << 4);
    return GW_KIND_INNER | (isolated ? GW_REASON_ISOLATED << 4 : 0u);
}

void main() {
    uint block = group_index();
    uint thread = block * 64u + gl_LocalInvocationIndex;
    uvec4 sum = uvec4(0u); // children, inner cells, their pairs, references of list leaves
    uvec4 before[SLOTS_PER_THREAD];
    uint class_of[SLOTS_PER_THREAD];
    for (uint i = 0u; i < SLOTS_PER_THREAD; ++i) {
        uint slot = thread * SLOTS_PER_THREAD + i;
        uint count = 0u;
        uint begin = 0u;
        if (slot < cell_count * 8u) {
            cell_prefixes prefixes = fetch_prefixes(slot >> 3);
            count = slot_count(prefixes, slot & 7u);
            begin = slot_begin(prefixes, slot & 7u);
        }
        uint class_here = classify(begin, count);
        uint kind = class_here & 0xfu;
        class_of[i] = class_here;
        before[i] = sum;
        sum += uvec4(kind != CLASS_EMPTY ? 1u : 0u, kind == GW_KIND_INNER ? 1u : 0u, kind == GW_KIND_INNER ? count : 0u,
                     kind == GW_LEAF_LIST ? count : 0u);
    }
    uvec4 inclusive = group_inclusive_scan(sum);
    for (uint i = 0u; i < SLOTS_PER_THREAD; ++i) {
        uint slot = thread * SLOTS_PER_THREAD + i;
        if (slot < cell_count * 8u) {
            classes[slot] = class_of[i];
            slot_bases[slot] = inclusive - sum + before[i];
        }
    }
    if (gl_LocalInvocationIndex == 63u)
        slot_sums[block] = inclusive;
}
