// Which blocks and regions of the chunk are made by which kernel. One invocation looks at one block of the list's grid, and at the
// region that begins in it.
//
// variants: ; WIDE_SQUARES=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
layout(std430, binding = 1) readonly buffer Counts { uint block_samples[]; }; // of sample/count.comp
layout(std430, binding = 10) readonly buffer Blocks { uint blocks[]; };
#include "blend/lists.glsl"
shared uint counts[OPEN_LISTS], begins[OPEN_LISTS];

ivec2 grid_size() {
    return ivec2(frame.list.z, frame.list.w / frame.list.z);
}

// Rate of a block of the grid, as a bit; of the border's for places outside.
uint rate_bit(ivec2 block) {
    ivec2 at = clamp(block, ivec2(0), grid_size() - 1);
    return 1u << GW_BLOCK_RATE(blocks[at.y * frame.list.z + at.x]);
}

// Bits of the rates whose cells round the region all lie in blocks of that rate: the sixteen or more that its patches read.
uint even_rates(ivec2 region) {
    uint near = ~0u, far = ~0u;
    for (int j = -1; j <= 2; ++j)
        for (int i = -1; i <= 2; ++i) {
            uint bit = rate_bit(region + ivec2(i, j));
            near &= max(i, j) < 2 ? bit : ~0u;
            far &= bit;
        }
    uint even = (near & 6u) | (far & 8u);
#ifdef WIDE_SQUARES
    uint wide = ~0u;
    for (int j = -3; j <= 3; j += 2)
        for (int i = -3; i <= 3; i += 2)
            wide &= rate_bit(region + ivec2(i, j));
    even |= wide & 16u;
#endif
    return even;
}

// Bits of the rates of which patches of the region have pixels in the chunk.
uint wanted_rates(ivec2 region) {
    uint bits = 0u;
    for (int k = 0; k < 4; ++k) {
        ivec2 block = region + ivec2(k & 1, k >> 1);
        bits |= in_chunk(block) ? rate_bit(block) : 0u;
    }
    bool wide = (region.x & region.y & 1) == 1;
    return bits & (wide ? 30u : 14u);
}

// Of lists of a rate.
uint rate_of_list(uint list) {
    return list < 3u ? 0u : ((list - 3u) & 3u) + 1u;
}

void main() {
    uint index = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (gl_LocalInvocationIndex < OPEN_LISTS)
        counts[gl_LocalInvocationIndex] = 0u;
    barrier();
    ivec2 block = ivec2(index % uint(frame.list.z), index / uint(frame.list.z));
    uint word = blocks[index], wanted = wanted_rates(block), mixed = wanted & ~even_rates(block);
    bool fine = in_chunk(block) && GW_BLOCK_RATE(word) == 0u, soft = fine && (word & GW_BLOCK_REACHES) != 0u;
    uint many[OPEN_LISTS], places[OPEN_LISTS];
    many[OWN_BLOCKS] = fine && !soft ? 1u : 0u;
    many[SOFT_BLOCKS] = soft ? 1u : 0u;
    many[MIXED_REGIONS] = uint(bitCount(mixed));
    for (uint rate = 1u; rate <= 4u; ++rate) {
        many[REGIONS_OF(rate)] = (wanted >> rate) & 1u;
        many[SAMPLED_OF(rate)] = GW_BLOCK_RATE(word) == rate && block_samples[index] > 0u ? 1u : 0u;
    }
    for (uint list = 0u; list < OPEN_LISTS; ++list)
        if (many[list] > 0u)
            places[list] = atomicAdd(counts[list], many[list]);
    barrier();
    if (gl_LocalInvocationIndex < OPEN_LISTS) {
        uint list = gl_LocalInvocationIndex, across = patches_across(rate_of_list(list));
        begins[list] = list_begin(list) + extend_list(list, counts[list], list < 3u ? 1u : 64u / (across * across));
    }
    barrier();
    for (uint list = 0u; list < OPEN_LISTS; ++list)
        if (many[list] > 0u && list != MIXED_REGIONS)
            lists[begins[list] + places[list]] = packed_place(block, rate_of_list(list));
    uint at = begins[MIXED_REGIONS] + places[MIXED_REGIONS];
    for (uint rate = 1u; rate <= 4u; ++rate)
        if (((mixed >> rate) & 1u) != 0u)
            lists[at++] = packed_place(block, rate);
}
