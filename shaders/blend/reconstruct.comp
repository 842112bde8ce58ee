// Pixels from samples: each pixel of a coarse block blends the four samples round it on the grid of its own block's rate. Where a
// neighbouring block has another rate, the sample that holds the grid point stands in, so that rates meet without a seam.
// A pixel of its own keeps its sample, or the mean of its rays. Everything stands at wall-global places: no picture depends on its tile.
//
// variants: ; ACCUMULATE=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
layout(std430, binding = 7) readonly buffer Sums { vec4 sums[]; };
layout(std430, binding = 10) readonly buffer Blocks { uint blocks[]; }; // of the list's grid
layout(location = 0) uniform uint pixel_slots;
#include "blend/store_pixel.glsl"

// Interleaves the lowest three bits of x and y.
uint morton(uvec2 p) {
    uvec2 spread = (p & 1u) | ((p & 2u) << 1) | ((p & 4u) << 2);
    return spread.x | (spread.y << 1);
}

// pixel: relative to the list's first pixel. Of a square of 16 pixels the first block holds the sample.
uint block_of(ivec2 pixel) {
    ivec2 block = pixel >> 3;
    uint word = blocks[block.y * frame.list.z + block.x];
    return GW_BLOCK_RATE(word) < 4u ? word : blocks[(block.y & ~1) * frame.list.z + (block.x & ~1)];
}

// The sample, or the mean of the rays of a square.
vec3 sample_at(ivec2 pixel) {
    uint block = block_of(pixel);
    uint rate = GW_BLOCK_RATE(block);
    uint rays = rate == 0u ? frame.counts.w : frame.sampling.x;
    uint first = GW_BLOCK_FIRST(block) + morton(uvec2(pixel & 7) >> rate) * rays;
    precise vec3 sum = sums[first].rgb;
    for (uint i = 1u; i < rays; ++i)
        sum += sums[first + i].rgb;
    precise vec3 mean = sum * (1.0 / float(rays));
    return mean;
}

void main() {
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (slot >= pixel_slots)
        return;
    uint block = slot >> 6, lane = slot & 63u, per_row = uint(frame.chunk.z);
    ivec2 within = ivec2((lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u),
                         ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u));
    ivec2 pixel = frame.chunk.xy - frame.list.xy + 8 * ivec2(block % per_row, block / per_row) + within;
    int rate = int(GW_BLOCK_RATE(block_of(pixel)));
    int side = 1 << rate;
    // The grid point up and left of the pixel's centre, and how far between it and the next the pixel lies.
    precise vec2 place = (vec2(pixel) + 0.5) * (1.0 / float(side)) - 0.5;
    vec2 base = floor(place);
    precise vec2 share = place - base;
    ivec2 first = ivec2(base) * side + (side >> 1);
    precise vec3 upper = sample_at(first) * (1.0 - share.x) + sample_at(first + ivec2(side, 0)) * share.x;
    precise vec3 lower = sample_at(first + ivec2(0, side)) * (1.0 - share.x) + sample_at(first + ivec2(side)) * share.x;
    precise vec3 color = upper * (1.0 - share.y) + lower * share.y;
    store_pixel(slot, rate == 0 ? sample_at(pixel) : color);
}
