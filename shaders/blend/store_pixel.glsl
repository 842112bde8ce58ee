// A pixel's linear colour to the picture. With ACCUMULATE it is one sample of a still view: it is added to those before it, in
// their order, and the picture shows their mean.
#include "common/color.glsl"
layout(std430, binding = 8) writeonly buffer Pixels { uint pixels[]; };
#ifdef ACCUMULATE
layout(std430, binding = 14) buffer Accumulated { vec4 accumulated[]; };
#endif

void store_pixel(uint slot, vec3 color) {
    precise vec3 mean = color;
#ifdef ACCUMULATE
    precise vec3 sum = frame.accumulation.w > 0.0 ? accumulated[slot].rgb + color : color;
    accumulated[slot] = vec4(sum, 1.0);
    mean = sum * frame.accumulation.z;
#endif
    pixels[slot] = encode_pixel(mean);
}
