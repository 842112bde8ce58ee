// Kernel 5: nodes of the children, cells of the next level, and the masks of their parents.
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(location = 7) uniform uint reference_first; // references that stand before this window's, on this level

layout(std430, binding = 1) readonly buffer CellsIn { uvec4 cells_in[]; };
layout(std430, binding = 6) readonly buffer PairsOut { uvec2 pairs_out[]; };
layout(std430, binding = 7) readonly buffer Classes { uint classes[]; };
layout(std430, binding = 8) readonly buffer SlotBases { uvec4 slot_bases[]; };
layout(std430, binding = 9) readonly buffer SlotBlockBases { uvec4 slot_block_bases[]; };
layout(std430, binding = 10) writeonly buffer Children { uvec4 children[]; };    // link, bits, cell xy, cell z
layout(std430, binding = 11) writeonly buffer CellsOut { uvec4 cells_out[]; };   // xy, z, first pair, pairs
layout(std430, binding = 12) writeonly buffer Parents { uvec2 parents[]; };      // first child in the window, masks
layout(std430, binding = 13) writeonly buffer Targets { uvec2 targets[]; };      // per slot: place of its list, inner index

void main() {
    uint slot = group_index() * 64u + gl_LocalInvocationIndex;
    if (slot >= cell_count * 8u)
        return;
    uint cell = slot >> 3;
    uint child = slot & 7u;
    uvec4 base = slot_bases[slot] + slot_block_bases[slot / SLOTS_PER_BLOCK];
    uint class_here = classes[slot];
    uint kind = class_here & 0xfu;
    uint count = slot_count(cell, child);
    uvec4 parent = cells_in[cell_first + cell];
    uint x = 2u * (parent.x & 0xffffu) + (child & 1u);
    uint y = 2u * (parent.x >> 16) + ((child >> 1) & 1u);
    uint z = 2u * parent.y + (child >> 2);
    if (kind != 0xfu) {
        uint link = kind == GW_LEAF_SINGLE ? pairs_out[slot_begin(cell, child)].x : reference_first + base.w;
        children[base.x] = uvec4(kind == GW_KIND_INNER ? 0u : link, class_here << 16, x | (y << 16), z);
        targets[slot] = uvec2(kind == GW_KIND_INNER ? base.z : base.w, base.y);
        if (kind == GW_KIND_INNER)
            cells_out[base.y] = uvec4(x | (y << 16), z, base.z, count);
    }
    if (child == 0u) {
        uint masks = 0u;
        for (uint k = 0u; k < 8u; ++k) {
            uint sibling = classes[slot + k] & 0xfu;
            masks |= sibling == 0xfu ? 0u : sibling == GW_KIND_INNER ? 1u << k : 0x101u << k;
        }
        parents[cell] = uvec2(base.x, masks);
    }
}
