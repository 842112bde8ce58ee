// A still view once more from the sums of its samples, because exposure, curve or dither are others than when it was drawn.
//
// variants: ; TONE=1 EXPOSURE=1 DITHER=1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
#include "blend/tone.glsl"
layout(std430, binding = 8) writeonly buffer Pixels { uint pixels[]; };
layout(std430, binding = 14) readonly buffer Accumulated { vec4 accumulated[]; };

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex, wide = uint(frame.chunk.z * 8);
    precise vec3 mean = accumulated[at].rgb * frame.accumulation.z;
    pixels[at] = encode_pixel(frame.chunk.xy + ivec2(at % wide, at / wide), mean);
}
