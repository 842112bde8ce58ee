// Pixels from samples: each pixel of a block is made of the sixteen samples round it on the grid of its own block's rate, by kernels
// that are one at a sample and nothing at the others where sharpness counts, and wider towards the next rate. Where a neighbouring
// block has another rate, the samples of the grid cell, or the sample that holds it, stand in. Everything stands at wall-global
// places: no picture depends on its tile. One group makes one block.
//
// CUBIC: sharper than tents. RATE_BLEND: sharpness falls from rate to rate. EDGE_AWARE: silhouettes stay where they are; only for
// blocks in which there are any. LISTED: blocks of one of the lists of blend/edge_blocks.comp.
// variants: ; ACCUMULATE=1; CUBIC=1 LISTED=1; GAZE=1 CUBIC=1 RATE_BLEND=1 EDGE_AWARE=1 LISTED=1
// variants: GAZE=1 GAZE_SEED=1 RATE_BLEND=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
#include "trace/pixel.glsl"
#ifdef RATE_BLEND
#include "sample/spacing.glsl"
#endif
#include "blend/store_pixel.glsl"
#include "blend/samples.glsl"

#include "blend/cells.glsl"
shared vec3 colors[CELL_COUNT];
shared float corner_spacing[4];
#ifdef EDGE_AWARE
#include "blend/edges.glsl"
#endif
#ifdef LISTED
#include "blend/block_lists.glsl"
#endif

void fill_cells(int rate) {
    for (int i = int(gl_LocalInvocationIndex); i < cell_count.x * cell_count.y; i += 64) {
        ivec2 cell = cell_of(i);
        colors[i] = color_of_cell(cell, rate);
#ifdef EDGE_AWARE
        fill_guide(i, cell, rate);
#endif
    }
}

// How far the sharpness at a pixel of the block has fallen from that of its rate to that of the next: 0 to 1.
float softness_at(ivec2 within, uint rate) {
#ifdef RATE_BLEND
    vec2 share = (vec2(within) + 0.5) * 0.125;
    precise float spacing = mix(mix(corner_spacing[0], corner_spacing[1], share.x),
                                mix(corner_spacing[2], corner_spacing[3], share.x), share.y);
    return rate < frame.sampling.y ? clamp(2.0 * (log2(max(spacing, 1e-6)) - float(rate)) - 1.0, 0.0, 1.0) : 0.0;
#else
    return 0.0;
#endif
}

// Weights of four samples in a row for a place a share of the way from the second to the third.
vec4 kernel_at(float x, float softness) {
#ifdef CUBIC
    // Catmull and Rom 1974.
    precise vec4 sharp = 0.5 * vec4(x * (x * (2.0 - x) - 1.0), x * x * (3.0 * x - 5.0) + 2.0, x * (1.0 + x * (4.0 - 3.0 * x)),
                                    x * x * (x - 1.0));
#else
    precise vec4 sharp = vec4(0.0, 1.0 - x, x, 0.0);
#endif
#ifdef RATE_BLEND
    float y = 1.0 - x;
    precise vec4 soft = vec4(y * y * y, x * x * (3.0 * x - 6.0) + 4.0, y * y * (3.0 * y - 6.0) + 4.0, x * x * x) * (1.0 / 6.0);
    precise vec4 weights = sharp * (1.0 - softness) + soft * softness; // B-spline
    return weights;
#else
    return sharp;
#endif
}

// Cubics overshoot: what comes out lies between the samples, so that no edge gets a bright or a dark fringe.
vec3 blended(int corner, vec4 across, vec4 down) {
    precise vec3 sum = vec3(0.0);
    vec3 least = vec3(1e30), most = vec3(-1e30);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            vec3 color = colors[corner + j * cell_count.x + i];
            sum += (across[i] * down[j]) * color;
            least = min(least, color);
            most = max(most, color);
        }
    return clamp(sum, least, most);
}

void main() {
#ifdef LISTED
    uint index = listed_block();
    if (index == GW_NO_PLACE)
        return;
#else
    uint index = group_base + gl_WorkGroupID.x;
#endif
    uint lane = gl_LocalInvocationIndex, slot = index * 64u + lane;
    ivec2 in_chunk = place_in_chunk(index), block = frame.chunk.xy - frame.list.xy + in_chunk;
    uint word = block_of(block), rate = GW_BLOCK_RATE(word);
    place_cells(block, word);
    fill_cells(int(rate));
#ifdef RATE_BLEND
    if (lane < 4u)
        corner_spacing[lane] = spacing_at(vec2(frame.chunk.xy + in_chunk + 8 * ivec2(lane & 1u, lane >> 1)));
#endif
    barrier();
    ivec2 within = ivec2((lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u),
                         ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u));
    ivec2 pixel = block + within, cell = cell_before(pixel, int(rate));
    precise vec2 share = (vec2(pixel) + 0.5) * exp2(-float(rate)) - 0.5 - vec2(cell);
    ivec2 from = cell - 1 - first_cell;
    int corner = from.y * cell_count.x + from.x;
    float softness = softness_at(within, rate);
    vec4 across = kernel_at(share.x, softness), down = kernel_at(share.y, softness);
    vec3 color = blended(corner, across, down);
#ifdef EDGE_AWARE
    vec3 cut = cut_at_edges(color, corner, share, vec2(frame.list.xy + pixel) + 0.5);
    color = rate > 0u ? cut : color;
#endif
    bool own = rate == 0u && (word & GW_BLOCK_REACHES) == 0u;
    store_pixel(slot, own ? colors[corner + cell_count.x + 1] : color);
}
