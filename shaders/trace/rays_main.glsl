// Needs trace/rays.glsl and a traversal before it.
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
    atomicMax(totals[GW_TOTAL_ITERATIONS], iterations);
#ifdef RESUME
    work += work_of[slot];
#endif
    work_of[slot] = work;
#endif
}
