// Rasterised voxeliser, stage 3: one extended fragment of 28 bytes (Weier et al. 2014, Table 1) for every pixel of every
// triangle: Morton code, colour, normal, triangle.
#include "build/voxelise.glsl"

layout(location = 0) noperspective in float depth;
layout(location = 1) flat in vec4 box;
layout(location = 2) flat in vec2 reach;
layout(location = 3) flat in vec3 normal;
layout(location = 4) flat in int axis;
layout(location = 5) flat in uint triangle;

layout(binding = 0, offset = 0) uniform atomic_uint fragment_count;
layout(std430, binding = 0) writeonly buffer Fragments { uint fragments[]; };
layout(binding = 1) uniform usamplerBuffer colors; // RGBA8 of each triangle
layout(location = 2) uniform uint capacity;

// Bits 0-9 to bits 0, 3, 6 ...
uint spread(uint v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}

void main() {
    vec2 pixel = gl_FragCoord.xy;
    if (any(lessThan(pixel, box.xy)) || any(greaterThan(pixel, box.zw)))
        discard;
    // The enlarged rim lies outside of the triangle: its plane is followed no further than the triangle reaches.
    float within = clamp(depth, reach.x, reach.y);
    uvec3 voxel = uvec3(clamp(ivec3(floor(vec3(pixel, within))), ivec3(0), ivec3(int(resolution) - 1)));
    voxel = turn_back(voxel, axis);
    uint at = atomicCounterIncrement(fragment_count);
    if (at < capacity) {
        uint begin = at * 7u;
        fragments[begin] = spread(voxel.x) | (spread(voxel.y) << 1) | (spread(voxel.z) << 2);
        fragments[begin + 1u] = 0u; // the upper half of the code: used beyond 1024 voxels a side
        fragments[begin + 2u] = texelFetch(colors, int(triangle)).x;
        fragments[begin + 3u] = floatBitsToUint(normal.x);
        fragments[begin + 4u] = floatBitsToUint(normal.y);
        fragments[begin + 5u] = floatBitsToUint(normal.z);
        fragments[begin + 6u] = triangle;
    }
}
