// How many samples each block has: none where no pixel of the chunk reads it. Leaves in each block the samples before it in its
// group, and the sum of each group.
//
// variants: ; WIDE_SQUARES=1
#include "sample/grid.glsl"
#include "sample/scan.glsl"
#ifdef WIDE_SQUARES
#define REACH 4
#else
#define REACH 2
#endif
layout(std430, binding = 0) readonly buffer Rates { uint rates[]; };
layout(std430, binding = 1) writeonly buffer Counts { uint counts[]; };     // of each block
layout(std430, binding = 2) writeonly buffer GroupSums { uvec2 group_sums[]; }; // samples, coarse blocks of the chunk
layout(std430, binding = 10) writeonly buffer Blocks { uint blocks[]; };

bool in_chunk(ivec2 block) {
    ivec2 first = (frame.chunk.xy - frame.list.xy) / 8, size = ivec2(frame.chunk.z, frame.chunk.w / frame.chunk.z);
    return all(greaterThanEqual(block, first)) && all(lessThan(block, first + size));
}

// Whether a pixel of the chunk reads the block: all of the chunk is read, and of the rim what a block near it reaches: two blocks
// away, as two samples do at a rate of 8; one from pixels of their own; four from squares of 16.
bool is_read(ivec2 block) {
    bool read = in_chunk(block);
    for (int v = -REACH; v <= REACH; ++v)
        for (int u = -REACH; u <= REACH; ++u) {
            ivec2 other = block + ivec2(u, v);
            uint word = in_chunk(other) ? rates[index_of(other)] : 0u;
            int reach = GW_BLOCK_RATE(word) == 4u ? 4 : GW_BLOCK_RATE(word) == 0u ? 1 : 2;
            read = read || ((word & GW_BLOCK_REACHES) != 0u && max(abs(u), abs(v)) <= reach);
        }
    return read;
}

uint count_of(ivec2 block, uint rate) {
#ifdef WIDE_SQUARES
    if (rate == 4u) {
        bool read = is_read(block) || is_read(block + ivec2(1, 0)) || is_read(block + ivec2(0, 1)) || is_read(block + 1);
        return (block.x & 1) == 0 && (block.y & 1) == 0 && read ? frame.sampling.x : 0u;
    }
#endif
    return !is_read(block) ? 0u : rate == 0u ? 64u * frame.counts.w : (64u >> (2u * rate)) * frame.sampling.x;
}

void main() {
    ivec2 block = block_of_invocation();
    uint word = rates[index_of(block)], rate = GW_BLOCK_RATE(word);
    uint count = count_of(block, rate);
    uint before = group_inclusive_scan(count) - count;
    uint samples = scan_values[63];
    barrier();
    group_inclusive_scan(rate > 0u && in_chunk(block) ? 1u : 0u);
    blocks[index_of(block)] = word | before;
    counts[index_of(block)] = count;
    if (gl_LocalInvocationIndex == 63u)
        group_sums[group_base + gl_WorkGroupID.x] = uvec2(samples, scan_values[63]);
}
