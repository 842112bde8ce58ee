// Any rays, for oracles and benches: nearest triangle through the octree, by the traversal of trace/primary.comp.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 RESUME=1 COUNT=1 DOUBLE_EDGES=1
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
layout(local_size_x = 64) in;
#include "common/shared.h"
#include "common/frame.h"
uniform uint group_base;
layout(std430, binding = 3) buffer Totals { uint totals[]; };
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };
layout(std430, binding = 5) writeonly buffer NextQueue { uint next_queue[]; };
#ifdef COUNT
layout(std430, binding = 6) buffer Work { uvec4 work_of[]; };
#endif
layout(location = 0) uniform uint ray_count; // or the length of the queue
#include "trace/ray_buffer.glsl"
#include "trace/walk.glsl"
#include "trace/traverse_exact.glsl"
#include "trace/state.glsl"

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (at >= ray_count)
        return;
#ifdef RESUME
    uint slot = queue[at];
#else
    uint slot = at;
#endif
    Scaled_ray ray = load_ray(slot);
    set_ray(ray.origin, ray.direction);
    hit_t = ray.maximum;
    hit_triangle = GW_NO_TRIANGLE;
    floor_t = ray.minimum;
    floor_triangle = GW_NO_TRIANGLE;
    iterations = 0u;
    list_cursor = 0u;
#ifdef COUNT
    work = uvec4(0u);
#endif
    walking = enter_root(ray.minimum);
#ifdef RESUME
    state_load(slot);
    walking = true;
#endif
    traverse();
    if (walking && iterations >= LOOP_BUDGET) {
        state_save(slot);
        next_queue[atomicAdd(totals[2], 1u)] = slot;
    } else if (walking) {
        atomicAdd(totals[0], 1u);
    }
    store_hit(slot, ray, hit_t, hit_triangle);
#ifdef COUNT
#ifdef RESUME
    work += work_of[slot];
#endif
    work_of[slot] = work;
#endif
}
