// Kernel 5: nodes of the children, cells of the next level, and the masks of their parents.
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(location = 7) uniform uint reference_first; // references that stand before this window's, on this level

layout(binding = 1) uniform usamplerBuffer cell_texels;
layout(binding = 3) uniform usamplerBuffer pair_texels; // of all children
layout(std430, binding = 7) readonly buffer Classes { uint classes[]; };
layout(std430, binding = 8) readonly buffer SlotBases { uvec4 slot_bases[]; };
layout(std430, binding = 9) readonly buffer SlotBlockBases { uvec4 slot_block_bases[]; };
layout(std430, binding = 10) writeonly buffer Children { uvec4 children[]; };    // link (inner: pairs), bits, cell xy, cell z
layout(std430, binding = 11) writeonly buffer CellsOut { uvec4 cells_out[]; };   // xy, z, first pair, pairs
layout(std430, binding = 12) writeonly buffer Parents { uvec2 parents[]; };      // first child in the window, masks
layout(std430, binding = 13) writeonly buffer Targets { uvec4 targets[]; }; // per slot: what to add to the
// place of a pair, index of the inner cell, place after the list, kind

void main() {
    uint slot = group_index() * 64u + gl_LocalInvocationIndex;
    if (slot >= cell_count * 8u)
        return;
    uint cell = slot >> 3;
    uint child = slot & 7u;
    uvec4 base = slot_bases[slot] + slot_block_bases[slot / SLOTS_PER_BLOCK];
    uint class_here = classes[slot];
    uint kind = class_here & 0xfu;
    cell_prefixes prefixes = fetch_prefixes(cell);
    uint count = slot_count(prefixes, child);
    uint begin = slot_begin(prefixes, child);
    uvec4 parent = texelFetch(cell_texels, int(cell_first + cell));
    uint x = 2u * (parent.x & 0xffffu) + (child & 1u);
    uint y = 2u * (parent.x >> 16) + ((child >> 1) & 1u);
    uint z = 2u * parent.y + (child >> 2);
    if (kind != 0xfu) {
        uint link = kind == GW_LEAF_SINGLE ? texelFetch(pair_texels, int(begin)).x : reference_first + base.w;
        children[base.x] = uvec4(kind == GW_KIND_INNER ? count : link, class_here << 16, x | (y << 16), z);
        targets[slot] = uvec4((kind == GW_KIND_INNER ? base.z : base.w) - begin, base.y, begin + count, kind);
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
