// Kernel 3: every pair goes to the lists of the children that it touches, in its old order.
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(binding = 3) uniform usamplerBuffer pair_texels;
layout(binding = 4) uniform usamplerBuffer mask_texels;
layout(binding = 5) uniform usamplerBuffer thread_base_texels;
layout(binding = 6) uniform usamplerBuffer block_base_texels; // two per block: eight children

layout(std430, binding = 6) writeonly buffer PairsOut { uvec2 pairs_out[]; }; // (triangle, slot)

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
        uvec2 pair = texelFetch(pair_texels, int(pair_first + first + i)).xy;
        uint cell = pair.y - cell_first;
        uint mask = ((i < 4u ? packed_masks.x : packed_masks.y) >> (8u * (i & 3u))) & 0xffu;
        cell_prefixes p = fetch_prefixes(cell);
        // A child's list begins where its cell's lists begin plus the counts of earlier siblings; the sum is carried along.
        uint begin = sum_of(p.low) + sum_of(p.high);
        uvec4 before = p.low;
        uvec4 next = p.low_next;
        uvec4 base = base_low;
        for (uint k = 0u; k < 8u; ++k) {
            if (k == 4u) {
                before = p.high;
                next = p.high_next;
                base = base_high;
            }
            if (((mask >> k) & 1u) != 0u)
                pairs_out[begin + base[k & 3u] + count_of(running, k) - before[k & 3u]] = uvec2(pair.x, cell * 8u + k);
            begin += next[k & 3u] - before[k & 3u];
        }
        running += spread_counts(nibble_flags(mask));
    }
}
