// Sums of inner nodes: a quarter of the sum of their children, in child order.
// variants: GW_EMISSION=1;
#include "build/payload.glsl"

layout(binding = 0) uniform samplerBuffer child_sums; // of the level below

// Node in level, first child in its level, mask of children.
layout(std430, binding = 1) readonly buffer Jobs { uvec4 jobs[]; };

void main() {
    uint index = job_index();
    if (index >= job_count)
        return;
    uvec4 job = jobs[index];
    surface_sum sum = empty_sum();
    int child = int(job.y);
    for (uint k = 0u; k < 8u; ++k) {
        if (((job.z >> k) & 1u) == 0u)
            continue;
        int texel = child * int(SUM_ROWS);
        surface_sum part = unpack_sum(texelFetch(child_sums, texel), texelFetch(child_sums, texel + 1),
                                      texelFetch(child_sums, texel + 2), texelFetch(child_sums, texel + 3));
        precise vec3 place = 0.5 * (part.moment + vec3(k & 1u, (k >> 1) & 1u, k >> 2) * part.area);
        part.moment = place;
#ifdef GW_EMISSION
        part.emission = texelFetch(child_sums, texel + 4).xyz;
#endif
        add_surface(sum, part);
        ++child;
    }
    sum.area *= 0.25;
    sum.color *= 0.25;
    sum.normal *= 0.25;
    sum.aligned *= 0.25;
    sum.roughness *= 0.25;
    sum.metalness *= 0.25;
    sum.moment *= 0.25;
#ifdef GW_EMISSION
    sum.emission *= 0.25;
#endif
    store_sum(job.x - node_first, sum);
}
