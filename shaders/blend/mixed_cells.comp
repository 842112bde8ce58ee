// Cells that patches of a mixed region read in blocks of other rates. One group makes those of one region; what several regions read
// is written by each, the same.
//
// variants: ; EDGE_AWARE=1; GAZE=1 RATE_BLEND=1 EDGE_AWARE=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
#include "trace/pixel.glsl"
#include "blend/samples.glsl"
#define WRITE_CELLS 1
#include "blend/cells.glsl"
#include "blend/lists.glsl"

// Mean over the cell's quarters: four samples where the block there has the next finer rate, one and the same where it has the
// cell's or a coarser one.
vec3 color_of_cell(ivec2 first, int half_side) {
    first += half_side >> 1;
    precise vec3 sum = sample_at(first) + sample_at(first + ivec2(half_side, 0));
    sum += sample_at(first + ivec2(0, half_side)) + sample_at(first + half_side);
    return sum * 0.25;
}

void main() {
    uint at = listed_group();
    if (at >= list_length(MIXED_REGIONS))
        return;
    uint entry = lists[list_begin(MIXED_REGIONS) + at], rate = entry >> 26, side = patches_across(rate) + 3u;
    uint lane = gl_LocalInvocationIndex;
    ivec2 cell = cell_of_region(place_of(entry), rate) - 1 + ivec2(lane % side, lane / side);
    int half_side = (1 << rate) >> 1;
    ivec2 first = cell << rate, met = first + (half_side >> 1);
    if (lane >= side * side || GW_BLOCK_RATE(block_of(first)) == rate)
        return;
    uint block = block_of(met), met_rate = GW_BLOCK_RATE(block);
    write_cell(cell, rate, color_of_cell(first, half_side), guide_of(slot_of(met, block)), met & -(1 << met_rate), met_rate);
}
