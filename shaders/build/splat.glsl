// The paper's build loop (Weier et al. 2014, section 3; bench only): fragments fall down the tree by compare-and-swap, level by
// level. What its kernels share.
//
// A node is two words. Inner: GW_SPLAT_INNER | first of eight children. Being built: two triangles or GW_SPLAT_NONE; a third
// one marks it GW_SPLAT_SPLIT. Leaf: its triangle; or triangles + index of its pair; or triangles + pairs + index of its list.
#define GW_SPLAT_INNER 0x80000000u
#define GW_SPLAT_SPLIT 0x40000000u
#define GW_SPLAT_INDEX 0x3fffffffu
#define GW_SPLAT_NONE 0x3fffffffu
#define FRAGMENT_WORDS 7u

layout(location = 0) uniform uint group_base;
layout(location = 1) uniform uint fragment_count;
layout(location = 2) uniform uint depth;      // of the finest level
layout(location = 3) uniform uint level;      // that is worked on
layout(location = 4) uniform uint node_first; // nodes of that level
layout(location = 5) uniform uint node_count;
layout(location = 6) uniform uint triangle_count;
layout(location = 7) uniform uint pair_count;
layout(location = 8) uniform uint capacity; // nodes that there is room for

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 1) buffer Nodes { uint nodes[]; };
layout(std430, binding = 2) buffer Counters { uint counters[]; }; // nodes, pairs' triangles
layout(std430, binding = 3) buffer Pairs { uint pairs[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; }; // of the finest level's lists, [node_count + 1]
layout(std430, binding = 5) buffer Lists { uint lists[]; };
layout(std430, binding = 6) buffer Voxels { uint voxels[]; }; // a node's colour with a count in alpha, normal

uint invocation() {
    return (gl_WorkGroupID.x + group_base) * 64u + gl_LocalInvocationIndex;
}

// The node that holds the fragment, no deeper than `deepest`; at: its level.
uint find_node(uint code, uint deepest, out uint at) {
    uint node = 0u;
    at = 0u;
    while (at < deepest && (nodes[node * 2u] & GW_SPLAT_INNER) != 0u) {
        node = (nodes[node * 2u] & GW_SPLAT_INDEX) + ((code >> (3u * (depth - 1u - at))) & 7u);
        at++;
    }
    return node;
}
