// Samples by the pixel that they stand for. Places are px from the list's first.
layout(std430, binding = 7) readonly buffer Sums { vec4 sums[]; };
layout(std430, binding = 10) readonly buffer Blocks { uint blocks[]; }; // of the list's grid
#ifdef EDGE_AWARE
layout(std430, binding = 21) readonly buffer Guides { uvec4 guides[]; };
#endif

// Interleaves the lowest three bits of x and y.
uint morton(uvec2 p) {
    uvec2 spread = (p & 1u) | ((p & 2u) << 1) | ((p & 4u) << 2);
    return spread.x | (spread.y << 1);
}

// Of a square of 16 pixels the first block holds the sample.
uint block_of(ivec2 pixel) {
    ivec2 block = pixel >> 3;
    uint word = blocks[block.y * frame.list.z + block.x];
    return GW_BLOCK_RATE(word) < 4u ? word : blocks[(block.y & ~1) * frame.list.z + (block.x & ~1)];
}

uint rays_of(uint block) {
    return GW_BLOCK_RATE(block) == 0u ? frame.counts.w : frame.sampling.x;
}

// Slot of the first ray of the sample that holds the pixel.
uint slot_of(ivec2 pixel, uint block) {
    return GW_BLOCK_FIRST(block) + morton(uvec2(pixel & 7) >> GW_BLOCK_RATE(block)) * rays_of(block);
}

vec3 mean_of_rays(uint first, uint rays) {
    precise vec3 sum = sums[first].rgb;
    for (uint i = 1u; i < rays; ++i)
        sum += sums[first + i].rgb;
    precise vec3 mean = sum * (1.0 / float(rays));
    return mean;
}

// The sample, or the mean of the rays of a square.
vec3 sample_at(ivec2 pixel) {
    uint block = block_of(pixel);
    return mean_of_rays(slot_of(pixel, block), rays_of(block));
}

uvec4 guide_of(uint slot) {
#ifdef EDGE_AWARE
    return guides[slot];
#else
    return uvec4(0u);
#endif
}
