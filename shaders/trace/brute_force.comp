// Any rays against a range of all triangles, with the same test as the octree's: the oracle of the traversal. The host
// goes through the ranges; the best hit so far stays in the hits.
//
// variants: ; DOUBLE_EDGES=1
layout(local_size_x = 64) in;
#include "common/shared.h"
#include "common/frame.h"
#include "trace/fetch.glsl"
#include "trace/triangle.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Rays { vec4 rays[]; };
layout(std430, binding = 1) buffer Hits { uvec2 hits[]; };
layout(location = 0) uniform uint ray_count;
layout(location = 1) uniform uvec2 range; // first triangle, past the last

void main() {
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (slot >= ray_count)
        return;
    vec4 start = rays[slot * 2u], aim = rays[slot * 2u + 1u];
    vec3 size = abs(aim.xyz);
    bool finite = all(lessThan(abs(start.xyz), vec3(1e30))) && all(lessThan(size, vec3(1e30))) && any(greaterThan(size, vec3(0.0)));
    set_ray(start.xyz, aim.xyz);
    hit_t = uintBitsToFloat(hits[slot].x);
    hit_triangle = hits[slot].y;
    floor_t = start.w;
    floor_triangle = GW_NO_TRIANGLE;
    if (range.x == 0u) {
        hit_t = aim.w;
        hit_triangle = GW_NO_TRIANGLE;
    }
    for (uint id = range.x; id < range.y && finite; ++id)
        test_triangle(id);
    hits[slot] = uvec2(floatBitsToUint(hit_t), hit_triangle);
}
