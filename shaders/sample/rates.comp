// Rate of every block of the grid: the side, as log2, of the largest squares of pixels that may share a ray, from what the
// sharpest viewer resolves anywhere in the block (Guenter et al., Foveated 3D Graphics, 2012). A function of the plane, the
// wall-global block and the frame state only.
//
// variants: ; GAZE=1; GAZE=1 WIDE_SQUARES=1
#include "sample/grid.glsl"
#include "trace/pixel.glsl"
layout(std430, binding = 0) writeonly buffer Rates { uint rates[]; };

#ifdef GAZE
// Spacing of samples, in pixels, that the sharpest viewer resolves at a place of the plane.
float spacing_at(vec2 place) {
    precise vec3 point = frame.corner.xyz + frame.step_x.xyz * place.x + frame.step_y.xyz * place.y;
    precise float spacing = acuity_at(point).width / max(pixel_width(point), 1e-30);
    return spacing;
}

// Acuity falls with the distance from the gaze, so a square's least spacing lies at a corner, or inside the ellipse, where the
// centre or a corner finds it small enough.
float least_spacing(vec2 first) {
    float least = min(min(spacing_at(first), spacing_at(first + vec2(8.0, 0.0))),
                      min(spacing_at(first + vec2(0.0, 8.0)), spacing_at(first + vec2(8.0))));
    return min(least, spacing_at(first + vec2(4.0)));
}

uint rate_of(ivec2 first) {
    float least = least_spacing(vec2(first));
    uint rate = 0u;
    for (uint i = 0u; i < frame.sampling.y; ++i)
        rate += least >= float(2u << i) ? 1u : 0u;
#ifdef WIDE_SQUARES
    // A square of 16 pixels needs four blocks that allow it; all four find the same.
    float wide = 1e30;
    for (int i = 0; i < 4; ++i)
        wide = min(wide, least_spacing(vec2((first & ~15) + 8 * ivec2(i & 1, i >> 1))));
    rate = wide >= 16.0 ? 4u : min(rate, 3u);
#endif
    return rate;
}
#endif

void main() {
    uint block = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (block >= uint(frame.list.w))
        return;
    uint rate = 0u;
#ifdef GAZE
    if (frame.counts.x > 0u)
        rate = rate_of(frame.list.xy + 8 * ivec2(block % uint(frame.list.z), block / uint(frame.list.z)));
#endif
    rates[block] = rate << 28 | (rate > 0u ? GW_BLOCK_REACHES : 0u);
}
