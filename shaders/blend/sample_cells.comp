// Samples of squares to the cells of their rates.
//
// variants: ; EDGE_AWARE=1; GAZE=1 RATE_BLEND=1 EDGE_AWARE=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
#define SPARSE 1
#include "trace/pixel.glsl"
#include "blend/samples.glsl"
#define WRITE_CELLS 1
#include "blend/cells.glsl"

void main() {
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex, word = samples[slot];
    uint rate = GW_SAMPLE_RATE(word);
    if (word == GW_NO_SAMPLE || rate == 0u || GW_SAMPLE_WHICH(word) != 0u)
        return;
    ivec2 pixel = ivec2(GW_SAMPLE_X(word), GW_SAMPLE_Y(word));
    write_cell(pixel >> rate, rate, mean_of_rays(slot, frame.sampling.x), guide_of(slot), pixel, rate);
}
