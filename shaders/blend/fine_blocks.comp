// Pixels of blocks at full rate, one group a block. A pixel is the mean of its rays. SOFT: where sharpness falls to that of pairs, its
// neighbours join it, up to a B-spline of 3 x 3; a neighbour that has no ray of its own stands for itself with its square's.
//
// variants: ; ACCUMULATE=1; ACCUMULATE=1 TONE=1 EXPOSURE=1 DITHER=1 METERING=1; GAZE=1 SOFT=1; GAZE=1 GAZE_SEED=1 SOFT=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
#include "blend/store_pixel.glsl"
#include "blend/samples.glsl"
#include "blend/lists.glsl"

#ifdef SOFT
#include "trace/pixel.glsl"
#include "sample/spacing.glsl"
#define LIST SOFT_BLOCKS
#define SIDE 10
shared vec3 colors[SIDE * SIDE];
shared float corner_spacing[4];

void fill(ivec2 first) {
    uint lane = gl_LocalInvocationIndex;
    for (uint i = lane; i < uint(SIDE * SIDE); i += 64u)
        colors[i] = sample_at(first - 1 + ivec2(i % uint(SIDE), i / uint(SIDE)));
    if (lane < 4u)
        corner_spacing[lane] = spacing_at(vec2(frame.list.xy + first + 8 * ivec2(lane & 1u, lane >> 1)));
    barrier();
}

// How far the sharpness at a pixel of the block has fallen to that of pairs: 0 to 1.
float softness_at(ivec2 within) {
    vec2 share = (vec2(within) + 0.5) * 0.125;
    precise float spacing = mix(mix(corner_spacing[0], corner_spacing[1], share.x),
                                mix(corner_spacing[2], corner_spacing[3], share.x), share.y);
    return clamp(2.0 * log2(max(spacing, 1e-6)) - 1.0, 0.0, 1.0);
}

vec3 row_at(int at) {
    precise vec3 sum = colors[at - 1] + 4.0 * colors[at] + colors[at + 1];
    return sum;
}

vec3 color_at(ivec2 first, ivec2 within) {
    int at = (within.y + 1) * SIDE + within.x + 1;
    float softness = softness_at(within);
    precise vec3 soft = (row_at(at - SIDE) + 4.0 * row_at(at) + row_at(at + SIDE)) * (1.0 / 36.0);
    precise vec3 color = colors[at] * (1.0 - softness) + soft * softness;
    return color;
}
#else
#define LIST OWN_BLOCKS
void fill(ivec2 first) {
}

vec3 color_at(ivec2 first, ivec2 within) {
    return sample_at(first + within);
}
#endif

void main() {
    uint at = listed_group();
    if (at >= list_length(LIST))
        return;
    ivec2 first = 8 * place_of(lists[list_begin(LIST) + at]);
    fill(first);
    uint lane = gl_LocalInvocationIndex;
    ivec2 within = ivec2(lane & 7u, lane >> 3);
    store_pixel(frame.list.xy - frame.chunk.xy + first + within, color_at(first, within));
}
