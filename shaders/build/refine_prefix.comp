// Kernel 2: at the first pair of each cell, how many pairs of the window before it touch child k. The counts and places of
// all child lists follow from differences and sums of these.
#include "build/refine.glsl"

layout(binding = 1) uniform usamplerBuffer cell_texels;
layout(binding = 3) uniform usamplerBuffer pair_texels;
layout(binding = 4) uniform usamplerBuffer mask_texels;
layout(binding = 5) uniform usamplerBuffer thread_base_texels;
layout(binding = 6) uniform usamplerBuffer block_base_texels; // two per block: eight children

layout(std430, binding = 5) writeonly buffer Prefixes { uvec4 prefixes[]; }; // [cell + 1][2]; the host writes the last

void main() {
    uint block = group_index();
    uint thread = block * 64u + gl_LocalInvocationIndex;
    uint first = thread * PAIRS_PER_THREAD;
    if (first >= pair_count)
        return;
    uvec2 packed_masks = texelFetch(mask_texels, int(thread)).xy;
    uvec4 running = texelFetch(thread_base_texels, int(thread));
    uvec4 base_low = texelFetch(block_base_texels, int(block) * 2);
    uvec4 base_high = texelFetch(block_base_texels, int(block) * 2 + 1);
    for (uint i = 0u; i < PAIRS_PER_THREAD && first + i < pair_count; ++i) {
        uint index = pair_first + first + i;
        uint cell = texelFetch(pair_texels, int(index)).y;
        if (texelFetch(cell_texels, int(cell)).z == index) {
            uint at = (cell - cell_first) * 2u;
            prefixes[at] = base_low + ((running.xxyy >> uvec4(0u, 16u, 0u, 16u)) & 0xffffu);
            prefixes[at + 1u] = base_high + ((running.zzww >> uvec4(0u, 16u, 0u, 16u)) & 0xffffu);
        }
        uint mask = ((i < 4u ? packed_masks.x : packed_masks.y) >> (8u * (i & 3u))) & 0xffu;
        running += spread_counts(nibble_flags(mask));
    }
}
