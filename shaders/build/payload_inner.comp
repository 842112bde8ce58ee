// Sums of inner nodes: a quarter of the sum of their children, in child order.
#include "build/payload.glsl"

layout(binding = 0) uniform samplerBuffer child_sums; // of the level below

// Node in level, first child in its level, number of children.
layout(std430, binding = 1) readonly buffer Jobs { uvec4 jobs[]; };

void main() {
    uint index = job_index();
    if (index >= job_count)
        return;
    uvec4 job = jobs[index];
    surface_sum sum = empty_sum();
    for (uint i = 0u; i < job.z; ++i) {
        int texel = int(job.y + i) * 3;
        add_surface(sum, unpack_sum(texelFetch(child_sums, texel), texelFetch(child_sums, texel + 1),
                                    texelFetch(child_sums, texel + 2)));
    }
    sum = surface_sum(sum.area * 0.25, sum.color * 0.25, sum.normal * 0.25, sum.aligned * 0.25, sum.roughness * 0.25,
                      sum.metalness * 0.25);
    store_sum(job.x - node_first, sum);
}
