// Each block's samples, in Morton order, the rays of one pixel together; blocks point at their first sample.
#include "sample/grid.glsl"
layout(std430, binding = 1) readonly buffer Counts { uint counts[]; };
layout(std430, binding = 2) readonly buffer GroupSums { uvec2 group_sums[]; };
layout(std430, binding = 9) writeonly buffer Samples { uint samples[]; };
layout(std430, binding = 10) buffer Blocks { uint blocks[]; };

void main() {
    ivec2 block = block_of_invocation();
    uint word = blocks[index_of(block)], rate = GW_BLOCK_RATE(word), count = counts[index_of(block)];
    uint first = GW_BLOCK_FIRST(word) + group_sums[group_base + gl_WorkGroupID.x].x;
    uint rays = rate == 0u ? frame.counts.w : frame.sampling.x, ray_bits = uint(findMSB(rays));
    blocks[index_of(block)] = word + group_sums[group_base + gl_WorkGroupID.x].x;
    uint corner = uint(block.x * 8) | uint(block.y * 8) << 12 | rate << 24;
    for (uint i = 0u; i < count; ++i) {
        uint lane = i >> ray_bits;
        uint column = (lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u);
        uint row = ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u);
        samples[first + i] = corner + ((column << rate) | (row << rate) << 12 | (i & (rays - 1u)) << 27);
    }
}
