// Pixels from samples: each pixel of a block is made of the sixteen samples round it on the grid of its own block's rate, by kernels
// that are one at a sample and nothing at the others where sharpness counts, and wider towards the next rate. Where a neighbouring
// block has another rate, the samples of the grid cell, or the sample that holds it, stand in. Everything stands at wall-global
// places: no picture depends on its tile. One group makes one block.
//
// CUBIC: sharper than tents. RATE_BLEND: sharpness falls from rate to rate. EDGE_AWARE: silhouettes stay where they are.
// variants: ; ACCUMULATE=1; CUBIC=1; GAZE=1 CUBIC=1 RATE_BLEND=1 EDGE_AWARE=1; GAZE=1 GAZE_SEED=1 RATE_BLEND=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
#include "trace/pixel.glsl"
#ifdef RATE_BLEND
#include "sample/spacing.glsl"
#endif
#include "blend/store_pixel.glsl"
#include "blend/samples.glsl"

// The grid cells that a block's pixels read: columns and rows of at most 11.
#define MOST_CELLS 11
#define CELL_COUNT (MOST_CELLS * MOST_CELLS)
shared vec3 colors[CELL_COUNT];
shared float corner_spacing[4];
ivec2 first_cell, cell_count; // on the grid of the block's rate
#ifdef EDGE_AWARE
#include "blend/edges.glsl"
#endif

ivec2 cell_before(ivec2 pixel, int rate) {
    return rate == 0 ? pixel : (pixel - (1 << rate >> 1)) >> rate; // its centre is not right of, not below the pixel's
}

void fill_cells(ivec2 block, uint word) {
    int rate = int(GW_BLOCK_RATE(word));
    first_cell = cell_before(block, rate) - 1;
    cell_count = cell_before(block + 7, rate) + 3 - first_cell;
    // Blocks that reach nothing know only their own samples.
    bool reaches = (word & GW_BLOCK_REACHES) != 0u;
    ivec2 least = reaches ? first_cell : block, most = reaches ? first_cell + cell_count : block + 7;
    for (int i = int(gl_LocalInvocationIndex); i < cell_count.x * cell_count.y; i += 64) {
        ivec2 cell = clamp(first_cell + ivec2(i % cell_count.x, i / cell_count.x), least, most);
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
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    uint lane = gl_LocalInvocationIndex, index = slot >> 6, per_row = uint(frame.chunk.z);
    ivec2 in_chunk = 8 * ivec2(index % per_row, index / per_row);
    ivec2 block = frame.chunk.xy - frame.list.xy + in_chunk;
    uint word = block_of(block), rate = GW_BLOCK_RATE(word);
    fill_cells(block, word);
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
