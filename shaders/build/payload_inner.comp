// Sums of inner nodes: a quarter of the sum of their children, in child order.
// variants: GW_EMISSION=1; GW_SEED_RULE=1
#include "build/payload.glsl"
#include "common/fixed_math.glsl"

layout(binding = 0) uniform samplerBuffer child_sums; // of the level below

// Node in level, first child in its level, mask of children.
layout(std430, binding = 1) readonly buffer Jobs { uvec4 jobs[]; };

// What child k adds to its parent.
surface_sum child_part(surface_sum part, uint k) {
#ifdef GW_SEED_RULE
    // The child's voxel: its mean, its normal made a unit again.
    precise float square = part.normal.x * part.normal.x + part.normal.y * part.normal.y + part.normal.z * part.normal.z;
    precise vec3 unit = part.normal * gw_reciprocal(gw_square_root(square));
    float inverse = gw_reciprocal(part.area);
    part.normal = unit == vec3(0.0) ? part.aligned : unit;
    part.aligned = part.normal;
    precise vec3 color = part.color * inverse;
    part.color = color;
    part.roughness *= inverse;
    part.metalness *= inverse;
    part.reflectance *= inverse;
    part.moment.x *= inverse;
#ifdef GW_EMISSION
    precise vec3 emission = part.emission * inverse;
    part.emission = emission;
#endif
    part.area = 1.0;
#else
    // Places p of the child are (p + corner) / 2 in its parent.
    vec3 corner = vec3(k & 1u, (k >> 1) & 1u, k >> 2);
    precise vec3 place = 0.5 * (part.moment + corner * part.area);
    precise vec3 squares = 0.25 * (part.squares + corner * (2.0 * part.moment + corner * part.area));
    precise vec3 products = 0.25 * (part.products + corner.yzx * part.moment.zxy + corner.zxy * part.moment.yzx +
                                    corner.yzx * corner.zxy * part.area);
    part.moment = place;
    part.squares = squares;
    part.products = products;
#endif
    return part;
}

#define CHILD_ROW(row) texelFetch(child_sums, int(row))

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
        LOAD_SUM(part, uint(child) * SUM_ROWS, CHILD_ROW)
        add_surface(sum, child_part(part, k));
        ++child;
    }
#ifndef GW_SEED_RULE
    sum.area *= 0.25;
    sum.color *= 0.25;
    sum.normal *= 0.25;
    sum.aligned *= 0.25;
    sum.roughness *= 0.25;
    sum.metalness *= 0.25;
    sum.reflectance *= 0.25;
    sum.moment *= 0.25;
    sum.squares *= 0.25;
    sum.products *= 0.25;
#ifdef GW_EMISSION
    sum.emission *= 0.25;
#endif
#endif
    store_sum(job.x - node_first, sum);
}
