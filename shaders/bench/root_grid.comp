// A dense grid of cells of one level above the shipped nodes: the walk starts and returns there instead of at the root.
//
// variants: OCTREE_DEPTH=11 OWN_GRID_LEVEL=5; OCTREE_DEPTH=6 OWN_GRID_LEVEL=5 RESUME=1 COUNT=1
#define GW_NODE_FORM_DEFINED
#define OWN_GRID_SCALE (OCTREE_DEPTH - OWN_GRID_LEVEL)
#define STACK_LEVELS OWN_GRID_SCALE
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "bench/node_forms.h"
layout(binding = 4) uniform usamplerBuffer root_grid;

void restart() {
    scale = SCALE_ABOVE_ROOT;
    node_word = 0u;
}

void return_to(int s) {
    bool above = s > OWN_GRID_SCALE;
    scale = above ? SCALE_ABOVE_ROOT : s;
    node_word = above ? 0u : stack_pop(s);
}

bool take_step(out uvec2 leaf) {
    int child_scale = scale - 1;
    bool valid, found = false;
    uint index = child_at(node_word, octant_at(child_scale), valid);
    uvec2 node = uvec2(0u);
    if (scale == SCALE_ABOVE_ROOT) {
        ivec3 sides = ivec3(uvec3(mirror, mirror >> 1, mirror >> 2) & 1u);
        ivec3 at = (cell ^ (-sides & (GRID_SIDE - 1))) >> OWN_GRID_SCALE;
        node = texelFetch(root_grid, (((at.z << OWN_GRID_LEVEL) | at.y) << OWN_GRID_LEVEL) | at.x).xy;
        COUNT_NODE(true);
        child_scale = int(node.y & 0xffu);
        valid = (node.y & GW_GRID_PRESENT) != 0u;
        node_word = node.x;
    } else {
        COUNT_NODE(valid);
        if (valid) {
            node = NODE(index);
            node_word = GW_NODE_KIND(node.y) == GW_KIND_INNER ? node_word_of(index, node) : node_word;
        }
    }
    leaf = node;
    if (valid) {
        scale = child_scale;
        found = GW_NODE_KIND(node.y) != GW_KIND_INNER;
        if (!found)
            stack_push(child_scale, node_word);
    } else {
        step_on(child_scale);
    }
    return found;
}
#include "trace/rays_main.glsl"
