// Kernel 1 of a level: for each pair, the mask of child cells that the triangle touches; for each block of pairs, how many
// touch child k.
#include "build/refine.glsl"
#include "build/triangle_box.glsl"

layout(binding = 0) uniform samplerBuffer triangle_texels;

layout(binding = 1) uniform usamplerBuffer cell_texels;
layout(binding = 3) uniform usamplerBuffer pair_texels;
layout(std430, binding = 2) writeonly buffer Masks { uvec2 masks[]; };              // a thread's eight masks
layout(std430, binding = 3) writeonly buffer ThreadBases { uvec4 thread_bases[]; }; // exclusive sums inside the block
layout(std430, binding = 4) writeonly buffer BlockSums { uvec4 block_sums[]; };

void main() {
    uint block = group_index();
    uint thread = block * 64u + gl_LocalInvocationIndex;
    uint first = thread * PAIRS_PER_THREAD;
    // The side of a child is 2^-level: its half is the quarter of the parent.
    float quarter = 0.5 / float(1u << level);
    uvec2 packed_masks = uvec2(0u);
    uint nibbles = 0u;
    for (uint i = 0u; i < PAIRS_PER_THREAD; ++i) {
        uint mask = 0u;
        if (first + i < pair_count) {
            uvec2 pair = texelFetch(pair_texels, int(pair_first + first + i)).xy;
            uvec4 cell = texelFetch(cell_texels, int(pair.y));
            int texel = int(pair.x) * 3;
            precise vec3 corner =
                vec3(float(cell.x & 0xffffu), float(cell.x >> 16), float(cell.y)) * (4.0 * quarter) - 1.0;
            mask = child_mask(texelFetch(triangle_texels, texel).xyz, texelFetch(triangle_texels, texel + 1).xyz,
                              texelFetch(triangle_texels, texel + 2).xyz, corner + 2.0 * quarter, quarter);
        }
        uint shifted = mask << (8u * (i & 3u));
        packed_masks |= i < 4u ? uvec2(shifted, 0u) : uvec2(0u, shifted);
        nibbles += nibble_flags(mask);
    }
    uvec4 counts = spread_counts(nibbles);
    uvec4 inclusive = group_inclusive_scan(counts);
    if (first < pair_count) {
        masks[thread] = packed_masks;
        thread_bases[thread] = inclusive - counts;
    }
    if (gl_LocalInvocationIndex == 63u)
        block_sums[block] = inclusive;
}
