// The node of 4 x 4 x 4 children, two levels in one (wall/node_forms.h). An empty block of 2 x 2 x 2 children is left in one
// step unless WIDE_NO_SKIP.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=10 RESUME=1 COUNT=1; OCTREE_DEPTH=11 WIDE_NO_SKIP=1
#define GW_NODE_FORM_DEFINED
#define STACK_LEVELS ((OCTREE_DEPTH + 1) / 2)
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "bench/node_forms.h"
layout(binding = 4) uniform usamplerBuffer leaf_words;

uvec4 wide_masks; // of the node whose children come next: inner, leaves
uvec4 wide_links;
int wide_scale;   // of its cell

void load_wide(uint index, int s) {
    COUNT_NODE(true);
    wide_masks = texelFetch(nodes, int(index) * 2);
    wide_links = texelFetch(nodes, int(index) * 2 + 1);
    wide_scale = s;
}

void restart() {
    scale = STACK_LEVELS * 2;
    load_wide(0u, scale);
    stack_push(STACK_LEVELS, 0u);
}

// Nodes stand at even scales.
void return_to(int s) {
    scale = (s + 1) & ~1;
    if (scale != wide_scale && s <= OCTREE_DEPTH)
        load_wide(stack_pop(scale >> 1), scale);
}

bool take_step(out uvec2 leaf) {
    ivec3 sides = ivec3(uvec3(mirror, mirror >> 1, mirror >> 2) & 1u);
    ivec3 at = ((cell ^ (-sides & (GRID_SIDE - 1))) >> (scale - 2)) & 3;
    ivec3 half_at = at >> 1;
    bool one_leaf = ((wide_links.z >> uint(half_at.x | (half_at.y << 1) | (half_at.z << 2))) & 1u) != 0u;
    uint lowest = uint(half_at.x * 2 | (half_at.y << 3) | (half_at.z << 5));
    uint place = one_leaf ? lowest : uint(at.x | (at.y << 2) | (at.z << 4));
    bool upper = place >= 32u;
    uint bit = 1u << (place & 31u);
    uint inner_half = upper ? wide_masks.y : wide_masks.x, leaf_half = upper ? wide_masks.w : wide_masks.z;
    bool inner = (inner_half & bit) != 0u, found = (leaf_half & bit) != 0u;
    uint before = upper ? (inner ? wide_masks.x : wide_masks.z) : 0u;
    uint rank = uint(bitCount(before) + bitCount((inner ? inner_half : leaf_half) & (bit - 1u)));
    leaf = uvec2(0u);
    COUNT_NODE(found);
    if (inner) {
        uint index = wide_links.x + rank;
        scale -= 2;
        load_wide(index, scale);
        stack_push(scale >> 1, index);
    } else if (found) {
        uint word = texelFetch(leaf_words, int(wide_links.y + rank)).x;
        leaf = uvec2(word & GW_LEAF_WORD_LINK, (word >> GW_LEAF_WORD_KIND_SHIFT) << 16);
        scale -= one_leaf ? 1 : 2;
    } else {
#ifdef WIDE_NO_SKIP
        step_on(scale - 2);
#else
        uint block = ((inner_half | leaf_half) >> (lowest & 31u)) & 0x00330033u;
        step_on(scale - (block == 0u ? 1 : 2));
#endif
    }
    return found;
}
#include "trace/rays_main.glsl"
