// Inner nodes of 12 bytes, leaves of 4 in an array of their own (wall/node_forms.h): what a step needs to know of its node no
// longer fits the stack's word, so that holds the node's index, fetched again on the way up.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=9 RESUME=1 COUNT=1
#define GW_NODE_FORM_DEFINED
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "bench/node_forms.h"
layout(binding = 4) uniform usamplerBuffer leaf_words;

uvec3 short_node; // whose children come next
int short_scale;  // of its cell

void load_short(uint index, int s) {
    COUNT_NODE(true);
    short_scale = s;
    short_node = texelFetch(nodes, int(index)).xyz;
}

void restart() {
    scale = OCTREE_DEPTH;
    load_short(0u, scale);
    stack_push(OCTREE_DEPTH, 0u);
}

void return_to(int s) {
    scale = s;
    if (s != short_scale && s <= OCTREE_DEPTH)
        load_short(stack_pop(s), s);
}

bool take_step(out uvec2 leaf) {
    int child_scale = scale - 1;
    uint bit = 1u << octant_at(child_scale);
    uint valid = GW_NODE_VALID(short_node.z), leaves = GW_NODE_LEAVES(short_node.z);
    bool found = (leaves & bit) != 0u;
    uint siblings = (found ? leaves : valid & ~leaves) & (bit - 1u);
    uint index = (found ? short_node.y : short_node.x) + uint(bitCount(siblings));
    leaf = uvec2(0u);
    if ((valid & bit) == 0u) {
        step_on(child_scale);
    } else if (found) {
        uint word = texelFetch(leaf_words, int(index)).x;
        COUNT_NODE(true);
        leaf = uvec2(word & GW_LEAF_WORD_LINK, (word >> GW_LEAF_WORD_KIND_SHIFT) << 16);
        scale = child_scale;
    } else {
        scale = child_scale;
        load_short(index, scale);
        stack_push(child_scale, index);
    }
    return found;
}
#include "trace/rays_main.glsl"
