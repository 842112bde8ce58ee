// What the payload kernels share: the sums that a node carries upwards. All are proportional to area, in units of the
// face area of the node's own cell, so a parent's sums are a quarter of its children's. Sums run in child order and list
// order, precise: the same bits on every device.
//
// With GW_SEED_RULE (payload_rule = seed, the averaging of Weier et al. 2014) every triangle of a leaf and every child of
// an inner cell weighs 1, whatever its area: `area` counts them, `aligned` is the normal that a zero sum falls back to, and
// `moment` holds the sum of opacities and 1 + the highest triangle id, whose normal that is.
#include "common/shared.h"

struct surface_sum {
    float area;     // of the surface in the cell, after alpha
    vec3 color;     // linear colour times area
    vec3 normal;    // normals times area
    vec3 aligned;   // the same with each addend turned to the side of the sum so far: opposed normals do not cancel
    float metalness; // times area
    // What a surface reflects at its normal, times area; and roughness, times both: of a mirror beside chalk, the mirror's
    // roughness is what highlights show.
    float reflectance, roughness;
    vec3 moment; // place in the cell, 0..1 along each axis, times area
#ifndef GW_SEED_RULE
    vec3 squares, products; // of places: xx, yy, zz and yz, zx, xy, times area; every part counts at its centroid
#endif
#ifdef GW_EMISSION
    vec3 emission; // emitted radiance times area
#endif
};

// Rows of a node's sums: octree_payload.c (sum_rows) counts them alike.
#ifdef GW_SEED_RULE
#define PLACE_ROWS 4u
#define NO_SQUARES
#else
#define PLACE_ROWS 6u
#define NO_SQUARES , vec3(0.0), vec3(0.0)
#endif
#ifdef GW_EMISSION
#define SUM_ROWS (PLACE_ROWS + 1u)
#define NO_EMISSION , vec3(0.0)
#else
#define SUM_ROWS PLACE_ROWS
#define NO_EMISSION
#endif

layout(location = 0) uniform uint group_base;
layout(location = 1) uniform uint job_count;
layout(location = 2) uniform uint node_first; // first node of the window, relative to its level

layout(std430, binding = 0) buffer Sums { vec4 sums[]; }; // [node in window][SUM_ROWS]

layout(local_size_x = 64) in;

uint job_index() {
    return (gl_WorkGroupID.x + group_base) * 64u + gl_LocalInvocationIndex;
}

surface_sum empty_sum() {
    return surface_sum(0.0, vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, vec3(0.0) NO_SQUARES NO_EMISSION);
}

void add_surface(inout surface_sum sum, surface_sum addend) {
#ifdef GW_SEED_RULE
    bool later = addend.aligned != vec3(0.0) && addend.moment.y >= sum.moment.y;
    sum.aligned = later ? addend.aligned : sum.aligned;
    sum.moment = vec3(sum.moment.x + addend.moment.x, max(sum.moment.y, addend.moment.y), 0.0);
#else
    precise float side = sum.aligned.x * addend.aligned.x + sum.aligned.y * addend.aligned.y + sum.aligned.z * addend.aligned.z;
    precise vec3 aligned = sum.aligned + (side < 0.0 ? -addend.aligned : addend.aligned);
    precise vec3 moment = sum.moment + addend.moment;
    precise vec3 squares = sum.squares + addend.squares;
    precise vec3 products = sum.products + addend.products;
    sum.aligned = aligned;
    sum.moment = moment;
    sum.squares = squares;
    sum.products = products;
#endif
    precise float area = sum.area + addend.area;
    precise vec3 color = sum.color + addend.color;
    precise vec3 normal = sum.normal + addend.normal;
    precise float roughness = sum.roughness + addend.roughness;
    precise float metalness = sum.metalness + addend.metalness;
    precise float reflectance = sum.reflectance + addend.reflectance;
    sum.area = area;
    sum.color = color;
    sum.normal = normal;
    sum.roughness = roughness;
    sum.metalness = metalness;
    sum.reflectance = reflectance;
#ifdef GW_EMISSION
    precise vec3 emission = sum.emission + addend.emission;
    sum.emission = emission;
#endif
}

// The sums whose rows begin at `row`, read by fetch(row).
#define LOAD_SUM(sum, row, fetch)                                                                                        \
    surface_sum sum = surface_sum(fetch(row).x, fetch(row).yzw, fetch(row + 1u).xyz, fetch(row + 2u).xyz,                \
                                  fetch(row + 2u).w, fetch(row + 3u).w, fetch(row + 1u).w,                               \
                                  fetch(row + 3u).xyz NO_SQUARES NO_EMISSION);                                           \
    LOAD_SQUARES(sum, row, fetch)                                                                                        \
    LOAD_EMISSION(sum, row, fetch)
#ifdef GW_SEED_RULE
#define LOAD_SQUARES(sum, row, fetch)
#else
#define LOAD_SQUARES(sum, row, fetch)                                                                                    \
    sum.squares = fetch(row + 4u).xyz;                                                                                   \
    sum.products = fetch(row + 5u).xyz;
#endif
#ifdef GW_EMISSION
#define LOAD_EMISSION(sum, row, fetch) sum.emission = fetch(row + PLACE_ROWS).xyz;
#else
#define LOAD_EMISSION(sum, row, fetch)
#endif

#define STORED_ROW(row) sums[row]

surface_sum load_sum(uint node) {
    uint row = node * SUM_ROWS;
    LOAD_SUM(sum, row, STORED_ROW)
    return sum;
}

void store_sum(uint node, surface_sum sum) {
    uint row = node * SUM_ROWS;
    sums[row] = vec4(sum.area, sum.color);
    sums[row + 1u] = vec4(sum.normal, sum.roughness);
    sums[row + 2u] = vec4(sum.aligned, sum.metalness);
    sums[row + 3u] = vec4(sum.moment, sum.reflectance);
#ifndef GW_SEED_RULE
    sums[row + 4u] = vec4(sum.squares, 0.0);
    sums[row + 5u] = vec4(sum.products, 0.0);
#endif
#ifdef GW_EMISSION
    sums[row + PLACE_ROWS] = vec4(sum.emission, 0.0);
#endif
}
