// A pixel's linear colour to the picture. With ACCUMULATE it is one sample of a still view: it is added to those before it, in
// their order, and the picture shows their mean.
#include "blend/tone.glsl"
layout(std430, binding = 8) writeonly buffer Pixels { uint pixels[]; }; // the chunk's, row by row
#ifdef ACCUMULATE
layout(std430, binding = 14) buffer Accumulated { vec4 accumulated[]; }; // likewise
#endif

// place: in the chunk.
void store_pixel(ivec2 place, vec3 color) {
    uint at = uint(place.y * frame.chunk.z * 8 + place.x);
    precise vec3 mean = color;
#ifdef ACCUMULATE
    precise vec3 sum = frame.accumulation.w > 0.0 ? accumulated[at].rgb + color : color;
    accumulated[at] = vec4(sum, 1.0);
    mean = sum * frame.accumulation.z;
#endif
#ifdef METERING
    meter(frame.chunk.xy + place, mean);
#endif
    pixels[at] = encode_pixel(frame.chunk.xy + place, mean);
}
