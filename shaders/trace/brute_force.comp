// Any rays against a range of all triangles, with the same test as the octree's: the oracle of the traversal. The host
// goes through the ranges; the best hit so far stays in the hits.
//
// variants: ; DOUBLE_EDGES=1
layout(local_size_x = 64) in;
#include "common/shared.h"
#include "common/frame.h"
#include "trace/fetch.glsl"
#include "trace/triangle.glsl"
#include "trace/ray_buffer.glsl"
uniform uint group_base;
layout(location = 0) uniform uint ray_count;
layout(location = 1) uniform uvec2 range; // first triangle, past the last

void main() {
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (slot >= ray_count)
        return;
    Scaled_ray ray = load_ray(slot);
    vec3 size = abs(ray.direction);
    bool traced = finite(ray.origin) && finite(ray.direction) && any(greaterThan(size, vec3(0.5)));
    set_ray(ray.origin, ray.direction);
    uvec2 before = hits[slot];
    bool first = range.x == 0u;
    hit_triangle = first ? GW_NO_TRIANGLE : before.y;
    hit_t = hit_triangle == GW_NO_TRIANGLE ? ray.maximum : uintBitsToFloat(before.x) * ray.to_scaled;
    floor_t = ray.minimum;
    floor_triangle = GW_NO_TRIANGLE;
    for (uint id = range.x; id < range.y && traced; ++id)
        test_triangle(id);
    store_hit(slot, ray, hit_t, hit_triangle);
}
