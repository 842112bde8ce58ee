// The node of Weier et al. 2014, 64 bits (wall/node_forms.h): children contiguous, empty ones included, so that a child's
// place needs no mask, but an empty one must be read to be known.
//
// variants: OCTREE_DEPTH=11 TRIANGLE_COUNT=1000u; OCTREE_DEPTH=9 TRIANGLE_COUNT=1000u RESUME=1 COUNT=1
#define GW_NODE_FORM_DEFINED
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "bench/node_forms.h"

void restart() {
    scale = SCALE_ABOVE_ROOT;
    node_word = 0u - mirror; // from here the octant that the mirrored ray sees first is node 0
}

void return_to(int s) {
    scale = s;
    node_word = stack_pop(s);
}

bool take_step(out uvec2 leaf) {
    int child_scale = scale - 1;
    uint word = NODE(node_word + octant_at(child_scale)).x;
    COUNT_NODE(true);
    uint index = word & GW_SEED_INDEX;
    bool inner = word < GW_SEED_LEAF;
    bool single = index < TRIANGLE_COUNT;
    leaf = uvec2(single ? index : index - TRIANGLE_COUNT, (single ? GW_LEAF_SINGLE : GW_LEAF_LIST) << 16);
    if (word == GW_SEED_EMPTY) {
        step_on(child_scale);
        return false;
    }
    scale = child_scale;
    if (inner) {
        node_word = index;
        stack_push(child_scale, index);
    }
    return !inner;
}
#include "trace/rays_main.glsl"
