// Checks one level of a finished octree, one node per invocation, and hands the cells of the children down. The first
// failure in node order wins (atomicMin), so the report does not depend on the order of execution.
#include "common/shared.h"
#include "build/triangle_box.glsl"

layout(location = 0) uniform uint group_base;
layout(location = 1) uniform uint node_first; // of this level
layout(location = 2) uniform uint node_last;  // one past
layout(location = 3) uniform uint level;
layout(location = 4) uniform uint node_count;
layout(location = 5) uniform uint reference_count;
layout(location = 6) uniform uint triangle_count;
layout(location = 7) uniform uint box_count;

layout(binding = 0) uniform samplerBuffer triangle_texels;
layout(binding = 1) uniform usamplerBuffer node_texels;
layout(binding = 2) uniform usamplerBuffer reference_texels;
layout(binding = 3) uniform usamplerBuffer payload_texels;
layout(binding = 4) uniform usamplerBuffer box_texels; // only of octrees with dense leaves

layout(std430, binding = 0) buffer Failure { uint first_failure; };      // node << 4 | check
layout(std430, binding = 1) buffer Cells { uint cells[]; };              // [node][2]: x | y << 16, z
layout(std430, binding = 2) buffer Parents { uint parent_counts[]; };    // how many inner nodes claim this child

layout(local_size_x = 64) in;

// The checks, by number; build/octree_validate.c has their texts in the same order.
#define CHECK_KIND 1u
#define CHECK_MASK 2u
#define CHECK_CHILD_RANGE 3u
#define CHECK_LEAF_BIT 4u
#define CHECK_REFERENCE 5u
#define CHECK_ORDER 6u
#define CHECK_OVERLAP 7u
#define CHECK_AREA 8u

// An invocation's loops have a budget: of longer lists the first entries are checked.
#define MOST_ENTRIES 4096u
#define MOST_BOX_LEVELS 256u

void fail(uint node, uint check) {
    atomicMin(first_failure, (node << 4) | check);
}

// The first reference of a leaf's list; 0 if its boxes do not lead to one. The boxes themselves are checked by the host.
uint list_start(uvec2 words) {
    if (GW_NODE_KIND(words.y) != GW_LEAF_DENSE)
        return words.x;
    uint box = words.x;
    for (uint i = 0u; i < MOST_BOX_LEVELS && box < box_count; ++i) {
        if (GW_BOX_TRIANGLES(texelFetch(box_texels, int(box) * 2 + 1).w) != 0u)
            return texelFetch(box_texels, int(box) * 2).w;
        ++box;
    }
    return 0u;
}

// The list of a leaf: ids in range and rising, an end inside the array, every triangle touching the cell.
void check_leaf(uint leaf, uvec2 words, vec3 parent_centre, float quarter, uint octant) {
    bool single = GW_NODE_KIND(words.y) == GW_LEAF_SINGLE;
    uint start = list_start(words);
    uint previous = 0u;
    bool more = true;
    for (uint i = 0u; more && i < MOST_ENTRIES; ++i) {
        if (!single && (start == 0u || start + i >= reference_count)) {
            fail(leaf, CHECK_REFERENCE);
            return;
        }
        uint entry = single ? (words.x | GW_REFERENCE_LAST) : texelFetch(reference_texels, int(start + i)).x;
        uint triangle = entry & GW_REFERENCE_ID;
        if (triangle >= triangle_count) {
            fail(leaf, CHECK_REFERENCE);
            return;
        }
        if (i > 0u && triangle <= previous)
            fail(leaf, CHECK_ORDER);
        previous = triangle;
        int texel = int(triangle) * 3;
        uint mask = child_mask(texelFetch(triangle_texels, texel).xyz, texelFetch(triangle_texels, texel + 1).xyz,
                               texelFetch(triangle_texels, texel + 2).xyz, parent_centre, quarter);
        if (((mask >> octant) & 1u) == 0u)
            fail(leaf, CHECK_OVERLAP);
        more = (entry & GW_REFERENCE_LAST) == 0u;
    }
}

float stored_area(uint code) {
    float root = float(code) * (4.0 / 4095.0);
    return root * root;
}

// How far a stored area may be off: half a step of the code, and a little for the rounding of the sums.
float area_step(uint code) {
    return 0.51 * (stored_area(code + 1u) - stored_area(code)) + 1e-6;
}

void check_inner(uint node, uvec2 words) {
    uint valid = GW_NODE_VALID(words.y);
    uint leaves = GW_NODE_LEAVES(words.y);
    uint children = uint(bitCount(valid));
    if (valid == 0u || (leaves & ~valid) != 0u) {
        fail(node, CHECK_MASK);
        return;
    }
    if (words.x < node_last || words.x + children > node_count) {
        fail(node, CHECK_CHILD_RANGE);
        return;
    }
    uvec2 cell = uvec2(cells[node * 2u], cells[node * 2u + 1u]);
    uvec3 place = uvec3(cell.x & 0xffffu, cell.x >> 16, cell.y);
    float quarter = 0.5 / float(1u << level);
    precise vec3 centre = vec3(place) * (4.0 * quarter) - 1.0 + 2.0 * quarter;
    uint child = words.x;
    float area = 0.0;
    float slack = 0.0;
    bool saturated = false;
    for (uint k = 0u; k < 8u; ++k) {
        if (((valid >> k) & 1u) == 0u)
            continue;
        uvec2 below = texelFetch(node_texels, int(child)).xy;
        bool is_leaf = GW_NODE_KIND(below.y) != GW_KIND_INNER;
        if (is_leaf != (((leaves >> k) & 1u) != 0u))
            fail(node, CHECK_LEAF_BIT);
        uvec3 inside = place * 2u + uvec3(k & 1u, (k >> 1) & 1u, k >> 2);
        cells[child * 2u] = inside.x | (inside.y << 16);
        cells[child * 2u + 1u] = inside.z;
        atomicAdd(parent_counts[child], 1u);
        if (is_leaf)
            check_leaf(child, below, centre, quarter, k);
        uint code = GW_PAYLOAD_AREA_CODE(texelFetch(payload_texels, int(child)).z);
        saturated = saturated || code == 4095u;
        area += stored_area(code);
        slack += area_step(code);
        child++;
    }
    uvec4 payload = texelFetch(payload_texels, int(node));
    uint own = GW_PAYLOAD_AREA_CODE(payload.z);
    bool solid = (payload.x & GW_PAYLOAD_TWO_SIDED) != 0u && payload.y >> 24 == GW_PAYLOAD_SOLID; // the seed rule's
    bool full = own == 4095u && area > 4.0 * stored_area(own); // more than can be stored
    if (!saturated && !full && !solid && abs(4.0 * stored_area(own) - area) > slack + 4.0 * area_step(own))
        fail(node, CHECK_AREA);
}

void main() {
    uint node = node_first + (gl_WorkGroupID.x + group_base) * 64u + gl_LocalInvocationIndex;
    if (node >= node_last)
        return;
    uvec2 words = texelFetch(node_texels, int(node)).xy;
    uint kind = GW_NODE_KIND(words.y);
    if (kind > GW_LEAF_DENSE || (node == 0u && kind != GW_KIND_INNER))
        fail(node, CHECK_KIND);
    else if (kind == GW_KIND_INNER)
        check_inner(node, words);
    else if (GW_NODE_VALID(words.y) != 0u || GW_NODE_LEAVES(words.y) != 0u)
        fail(node, CHECK_MASK);
}
