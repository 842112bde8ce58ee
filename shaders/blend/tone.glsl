// From linear light to the codes of the screen: exposure, curve, sRGB, dither; and how bright the picture is.
#include "common/color.glsl"

#ifdef METERING
layout(std430, binding = 30) buffer Luminances { uint luminances[]; }; // GW_LUMINANCE_BINS

// Counts the light of one pixel in 16, those at wall-global multiples of 4: before exposure, so that what it leads to has no
// part in it. A bin is a quarter of an octave, by the bits of the float; what is darker than all of them is in the first.
void meter(ivec2 wall, vec3 color) {
    precise float luminance = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
    int bin = int(floatBitsToUint(max(luminance, 0.0)) >> 21) - GW_LUMINANCE_FIRST;
    bool counts = ((wall.x | wall.y) & 3) == 0 && all(greaterThanEqual(wall, frame.window.xy)) && all(lessThan(wall, frame.window.zw));
    if (counts && frame.tone.w > 0.0)
        atomicAdd(luminances[clamp(bin, 0, GW_LUMINANCE_BINS - 1)], 1u);
}
#endif

// Narkowicz, ACES Filmic Tone Mapping Curve, 2016: a rational fit of the curve of the Academy Color Encoding System.
vec3 filmic(vec3 color) {
    vec3 x = clamp(color, 0.0, 1e4);
    precise vec3 curved = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
    return curved;
}

// Between -1/2 and 1/2, each multiple of 1/64 from the middle once in every 8 x 8 pixels of the wall, so its mean is 0: the
// matrix of Bayer, An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures, 1973.
float threshold_at(ivec2 wall) {
    uvec2 p = uvec2(wall) & 7u;
    uint x = p.x ^ p.y, y = p.y;
    uint order = (x & 1u) << 5 | (y & 1u) << 4 | (x & 2u) << 2 | (y & 2u) << 1 | (x & 4u) >> 1 | (y & 4u) >> 2;
    return (float(order) - 31.5) * (1.0 / 64.0);
}

// Linear colour to a pixel of the picture: RGBA8, red in the lowest byte. wall: the wall-global pixel.
uint encode_pixel(ivec2 wall, vec3 color) {
    precise vec3 light = color;
#ifdef EXPOSURE
    light *= frame.tone.x;
#endif
#ifdef TONE
    light = frame.tone.y > 0.0 ? filmic(light) : light;
#endif
    precise vec3 code = srgb_encode(light) * 255.0 + 0.5;
#ifdef DITHER
    // What is a code already stays one; colours apart, so that the pattern is not one of light and dark.
    code += frame.tone.z * vec3(threshold_at(wall), threshold_at(wall + ivec2(3, 5)), threshold_at(wall + ivec2(6, 2)));
#endif
    uvec3 bytes = uvec3(code);
    return bytes.r | (bytes.g << 8) | (bytes.b << 16) | 0xff000000u;
}
