// Kernel 2: at the first pair of each cell, how many pairs of the window before it touch child k. The counts and places of
// all child lists follow from differences and sums of these.
#include "build/refine.glsl"

layout(std430, binding = 0) readonly buffer PairsIn { uvec2 pairs_in[]; };
layout(std430, binding = 1) readonly buffer CellsIn { uvec4 cells_in[]; };
layout(std430, binding = 2) readonly buffer Masks { uvec2 masks[]; };
layout(std430, binding = 3) readonly buffer ThreadBases { uvec4 thread_bases[]; };
layout(std430, binding = 4) readonly buffer BlockBases { uint block_bases[]; };  // [block][8]
layout(std430, binding = 5) writeonly buffer Prefixes { uint prefixes[]; };      // [cell + 1][8]; the host writes the last

void main() {
    uint block = group_index();
    uint thread = block * 64u + gl_LocalInvocationIndex;
    uint first = thread * PAIRS_PER_THREAD;
    if (first >= pair_count)
        return;
    uvec2 packed_masks = masks[thread];
    uvec4 running = thread_bases[thread];
    for (uint i = 0u; i < PAIRS_PER_THREAD && first + i < pair_count; ++i) {
        uint index = pair_first + first + i;
        uint cell = pairs_in[index].y;
        if (cells_in[cell].z == index) {
            uint at = (cell - cell_first) * 8u;
            for (uint k = 0u; k < 8u; ++k)
                prefixes[at + k] = block_bases[block * 8u + k] + count_of(running, k);
        }
        uint mask = ((i < 4u ? packed_masks.x : packed_masks.y) >> (8u * (i & 3u))) & 0xffu;
        running += spread_counts(nibble_flags(mask));
    }
}
