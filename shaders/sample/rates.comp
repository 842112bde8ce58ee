// Rate of every block of the grid: the side, as log2, of the largest squares of pixels that may share a ray, from what the
// sharpest viewer resolves anywhere in the block (Guenter et al., Foveated 3D Graphics, 2012). A function of the plane, the
// wall-global block and the frame state only.
//
// variants: ; GAZE=1; GAZE=1 WIDE_SQUARES=1 RATE_BLEND=1; GAZE=1 GAZE_SEED=1 RATE_BLEND=1
#include "sample/grid.glsl"
#include "trace/pixel.glsl"
layout(std430, binding = 0) writeonly buffer Rates { uint rates[]; };

#ifdef GAZE
#include "sample/spacing.glsl"

// Acuity falls with the distance from the gaze, so a square's least spacing lies at a corner, or inside the ellipse, where the
// centre or a corner finds it small enough. x: the least, y: the greatest at a corner.
vec2 spacings_of(vec2 first) {
    vec4 corners = vec4(spacing_at(first), spacing_at(first + vec2(8.0, 0.0)), spacing_at(first + vec2(0.0, 8.0)),
                        spacing_at(first + vec2(8.0)));
    float least = min(min(corners.x, corners.y), min(corners.z, corners.w));
    return vec2(min(least, spacing_at(first + vec2(4.0))), max(max(corners.x, corners.y), max(corners.z, corners.w)));
}

// The block's word without its first sample.
uint word_of(ivec2 first) {
    vec2 spacings = spacings_of(vec2(first));
    uint rate = 0u;
#ifndef GAZE_SEED
    for (uint i = 0u; i < frame.sampling.y; ++i)
        rate += spacings.x >= float(2u << i) ? 1u : 0u;
#endif
#if defined(WIDE_SQUARES) && !defined(GAZE_SEED)
    // A square of 16 pixels needs four blocks that allow it; all four find the same.
    float wide = 1e30;
    for (int i = 0; i < 4; ++i)
        wide = min(wide, spacings_of(vec2((first & ~15) + 8 * ivec2(i & 1, i >> 1))).x);
    rate = wide >= 16.0 ? 4u : min(rate, 3u);
#endif
#ifdef RATE_BLEND
    bool reaches = rate > 0u || (frame.sampling.y > 0u && spacings.y > 1.4);
#else
    bool reaches = rate > 0u;
#endif
    return rate << 28 | (reaches ? GW_BLOCK_REACHES : 0u);
}
#endif

void main() {
    uint block = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (block >= uint(frame.list.w))
        return;
    uint word = 0u;
#ifdef GAZE
    if (frame.counts.x > 0u)
        word = word_of(frame.list.xy + 8 * ivec2(block % uint(frame.list.z), block / uint(frame.list.z)));
#endif
    rates[block] = word;
}
