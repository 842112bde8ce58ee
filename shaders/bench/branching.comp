// The shipped nodes by a step with branches instead of selects, from the root.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=9 RESUME=1 COUNT=1
#define GW_NODE_FORM_DEFINED
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"

void restart() {
    scale = SCALE_ABOVE_ROOT;
    node_word = WORD_ABOVE_ROOT;
}

void return_to(int s) {
    scale = s;
    node_word = stack_pop(s);
}

bool take_step(out uvec2 leaf) {
    int child_scale = scale - 1;
    bool valid, found = false;
    uint index = child_at(node_word, octant_at(child_scale), valid);
    COUNT_NODE(valid);
    leaf = uvec2(0u);
    if (valid) {
        uvec2 node = NODE(index);
        scale = child_scale;
        found = GW_NODE_KIND(node.y) != GW_KIND_INNER;
        leaf = node;
        if (!found) {
            node_word = node_word_of(index, node);
            stack_push(child_scale, node_word);
        }
    } else {
        step_on(child_scale);
    }
    return found;
}
#include "trace/rays_main.glsl"
