// All crossings of a ray, one after another: how many triangles it enters by, and leaves by. Instead of t and triangle. A ray
// that the loop budget cuts off is counted as a cap hit.
//
// variants: OCTREE_DEPTH=9; OCTREE_DEPTH=9 FAST_TRIANGLES=1 DENSE_LEAVES=1
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 9
#endif
#include "trace/rays.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"

void main() {
    uint slot = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (slot >= ray_count)
        return;
    Scaled_ray ray = load_ray(slot);
    set_ray(ray.origin, ray.direction);
    floor_t = ray.minimum;
    floor_triangle = GW_NO_TRIANGLE;
    iterations = 0u;
#ifdef COUNT
    work = uvec4(0u);
#endif
    uint fronts = 0u, backs = 0u;
    bool ended = false, cut = false;
    for (uint crossings = 0u; crossings < 256u && !ended && !cut; ++crossings) {
        iterations = 0u; // of one crossing: the rays of the tests cross few triangles
        hit_t = ray.maximum;
        hit_triangle = GW_NO_TRIANGLE;
        list_cursor = 0u;
        walking = enter_root(ray.minimum);
        traverse();
        cut = walking;
        ended = hit_triangle == GW_NO_TRIANGLE;
        fronts += uint(!ended && (hit_triangle & GW_HIT_BACK) == 0u);
        backs += uint(!ended && (hit_triangle & GW_HIT_BACK) != 0u);
        floor_t = hit_t;
        floor_triangle = hit_triangle;
    }
    if (!ended || cut)
        atomicAdd(totals[0], 1u);
    hits[slot] = uvec2(fronts, backs);
}
