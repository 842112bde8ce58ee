// Samples by the pixel or grid cell that they stand for. Places are px from the list's first.
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

// The sample, or the mean of the rays of a square.
vec3 sample_at(ivec2 pixel) {
    uint block = block_of(pixel), rays = rays_of(block), first = slot_of(pixel, block);
    precise vec3 sum = sums[first].rgb;
    for (uint i = 1u; i < rays; ++i)
        sum += sums[first + i].rgb;
    precise vec3 mean = sum * (1.0 / float(rays));
    return mean;
}

// Mean over the cell's quarters: four samples where the block there has the next finer rate, one and the same where it has the
// cell's or a coarser one.
vec3 color_of_cell(ivec2 cell, int rate) {
    ivec2 first = cell << rate;
    int half_side = (1 << rate) >> 1;
    if (rate == 0)
        return sample_at(first);
    first += half_side >> 1;
    precise vec3 sum = sample_at(first) + sample_at(first + ivec2(half_side, 0));
    sum += sample_at(first + ivec2(0, half_side)) + sample_at(first + half_side);
    return sum * 0.25;
}
