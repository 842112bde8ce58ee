// The panel's correction, last of all: white point and brightness are gains of linear light, gamma the exponent with which the
// panel turns a code into light. Without GAMMA the panel shows sRGB.
// variants: GAMMA=1;
#include "common/color.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, rgba8) readonly uniform image2D picture;
layout(binding = 1, rgba8) writeonly uniform image2D corrected;
layout(location = 0) uniform vec4 gains; // of red, green and blue; w: 1 / the panel's gamma
uniform uint group_base;

void main() {
    const uint index = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    const ivec2 size = imageSize(picture);
    const ivec2 at = ivec2(int(index) % size.x, int(index) / size.x);
    if (at.y >= size.y)
        return;
    const vec3 light = clamp(srgb_decode(imageLoad(picture, at).rgb) * gains.rgb, 0.0, 1.0);
#ifdef GAMMA
    const vec3 code = pow(light, vec3(gains.w));
#else
    const vec3 code = srgb_encode(light);
#endif
    imageStore(corrected, at, vec4(code, 1.0));
}
