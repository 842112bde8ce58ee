// The reflected rays of one batch of mirrors: about the shading normal, unless that leads below the surface. The footprint goes
// on from the mirror, wider by what the mirror's curvature spreads the rays of one footprint: twice the angle by which its
// normals turn over it (Igehy, Tracing Ray Differentials, 1999). Like a shadow's ray it starts with triangles only
// (shade/shadow_ray.glsl), or above the voxel that it leaves.
//
// variants: OCTREE_DEPTH=11 SMOOTH_NORMALS=1; OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 SMOOTH_NORMALS=1 FRAGMENTS=8u
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 17) writeonly buffer Reflected_rays { vec4 reflected_rays[]; };
layout(std430, binding = 20) readonly buffer Mirrors { uint mirrors[]; };
layout(location = 0) uniform uvec2 batch; // first mirror, number of them
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "shade/surface.glsl"
#include "shade/secondary_start.glsl"

// How far the normals turn over a unit of the triangle, at most.
float curvature_of(uint triangle) {
    float curvature = 0.0;
#ifdef SMOOTH_NORMALS
    uvec4 face = texelFetch(faces, int(triangle));
    uvec3 words = uvec3(texelFetch(vertices, int(face.x)).x, texelFetch(vertices, int(face.y)).x,
                        texelFetch(vertices, int(face.z)).x);
    for (int i = 0; i < 3; ++i) {
        int next = i == 2 ? 0 : i + 1;
        vec3 side = uintBitsToFloat(TRIANGLE(triangle, next).xyz) - uintBitsToFloat(TRIANGLE(triangle, i).xyz);
        precise vec3 turn = vertex_normal(words[next]) - vertex_normal(words[i]);
        curvature = max(curvature, length_precise(turn) / max(length_precise(side), 1e-12));
    }
    curvature = any(equal(words, uvec3(NO_NORMAL))) ? 0.0 : curvature;
#ifdef FLAT_MIRRORS
    curvature = 0.0; // the naive variant, for the test that shows why
#endif
#endif
    return curvature;
}

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    bool present = at < batch.y;
    uint fragment = mirrors[batch.x + (present ? at : 0u)], word = fragment * GW_FRAGMENT_WORDS;
    uint id = fragments[word];
    float t = uintBitsToFloat(fragments[word + 1u]);
    Pixel_square square;
    Pixel_ray ray = ray_of_slot(fragment / FRAGMENTS, square);
    float size = length_precise(ray.direction), width = footprint_at(ray, t);
    Secondary_start start = secondary_start(id, t, ray.origin, ray.direction);
    vec3 d = ray.direction / size;
#ifdef LOD
    bool voxel = start.own_side > 0.0;
#else
    const bool voxel = false;
#endif
    vec3 shading = voxel ? start.normal : surface_of_triangle(id, t, ray.origin, ray.direction, width).normal;
    precise vec3 reflected = d - shading * (2.0 * dot(d, shading));
    precise vec3 flat_one = d - start.normal * (2.0 * dot(d, start.normal));
    reflected = dot(reflected, start.normal) > 0.0 ? reflected : flat_one;
    // Normals of a voxel that agree by a turn at angles of about sqrt(2 (1 - a)) from their mean.
    precise float turn = voxel ? sqrt(2.0 * (1.0 - start.agreement)) : curvature_of(id) * width;
    precise float spread = ray.width / size + 2.0 * min(turn, 1.0);
    float accepted = ray.tau * width;
    Secondary_origin from = secondary_origin(start, accepted, dot(reflected, start.normal),
                                             out_of_reach(start, accepted, reflected));
    uint row = at * GW_REFLECTED_ROWS;
    reflected_rays[row] = vec4(from.origin, width);
    reflected_rays[row + 1u] = vec4(reflected, spread);
    reflected_rays[row + 2u] = vec4(present ? ray.tau : -1.0, from.clear, 0.0, 0.0);
}
