// Samples of a rate to its cells, an invocation a sample: the mean of its rays.
//
// variants: ; EDGE_AWARE=1; GAZE=1 RATE_BLEND=1 EDGE_AWARE=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
layout(location = 0) uniform uint rate;
#include "trace/pixel.glsl"
#include "blend/samples.glsl"
#define WRITE_CELLS 1
#include "blend/cells.glsl"
#include "blend/lists.glsl"

void main() {
    uint at = listed_group() * 64u + gl_LocalInvocationIndex, list = SAMPLED_OF(rate);
    uint across = patches_across(rate), many = across * across, lane = at % many;
    if (at / many >= list_length(list))
        return;
    ivec2 block = place_of(lists[list_begin(list) + at / many]);
    uint first = GW_BLOCK_FIRST(blocks[block.y * frame.list.z + block.x]) + lane * frame.sampling.x;
    ivec2 pixel = 8 * block + (ivec2((lane & 1u) | ((lane >> 1) & 2u), ((lane >> 1) & 1u) | ((lane >> 2) & 2u)) << rate);
    write_cell(pixel >> rate, rate, mean_of_rays(first, frame.sampling.x), guide_of(first), pixel, rate);
}
