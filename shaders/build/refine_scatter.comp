// Kernel 3: every pair goes to the lists of the children that it touches, in its old order.
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(std430, binding = 0) readonly buffer PairsIn { uvec2 pairs_in[]; };
layout(std430, binding = 2) readonly buffer Masks { uvec2 masks[]; };
layout(std430, binding = 3) readonly buffer ThreadBases { uvec4 thread_bases[]; };
layout(std430, binding = 4) readonly buffer BlockBases { uint block_bases[]; };
layout(std430, binding = 6) writeonly buffer PairsOut { uvec2 pairs_out[]; }; // (triangle, slot)

void main() {
    uint block = group_index();
    uint thread = block * 64u + gl_LocalInvocationIndex;
    uint first = thread * PAIRS_PER_THREAD;
    if (first >= pair_count)
        return;
    uvec2 packed_masks = masks[thread];
    uvec4 running = thread_bases[thread];
    for (uint i = 0u; i < PAIRS_PER_THREAD && first + i < pair_count; ++i) {
        uvec2 pair = pairs_in[pair_first + first + i];
        uint cell = pair.y - cell_first;
        uint mask = ((i < 4u ? packed_masks.x : packed_masks.y) >> (8u * (i & 3u))) & 0xffu;
        // A child's list begins where its cell's lists begin plus the counts of earlier siblings; the sum is carried along.
        uint begin = 0u;
        for (uint k = 0u; k < 8u; ++k)
            begin += prefixes[cell * 8u + k];
        for (uint k = 0u; k < 8u; ++k) {
            uint before = prefixes[cell * 8u + k];
            if (((mask >> k) & 1u) != 0u)
                pairs_out[begin + block_bases[block * 8u + k] + count_of(running, k) - before] =
                    uvec2(pair.x, cell * 8u + k);
            begin += prefixes[cell * 8u + 8u + k] - before;
        }
        running += spread_counts(nibble_flags(mask));
    }
}
