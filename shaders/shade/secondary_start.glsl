// Where a ray starts that leaves what a fragment shows, and which part of it may meet voxels.
//
// From triangles it starts with triangles only, up to where it has left every voxel that could hold the surface it comes from:
// with voxels of side h, a plane with the unit normal n lies in cells that reach up to h (|nx| + |ny| + |nz|) above it. A voxel
// is known no better than to its own side: a reflected ray starts from there at that height, a shadow's as near as the voxel's
// shape allows. Needs shade/surface.glsl before it.
#include "common/surface_offset.glsl"

const float NEVER_CLEAR = 1e30;

struct Secondary_start {
    vec3 place, normal; // the triangle's own normal, on the side from which it is seen
    float own_side;     // of the voxel; 0 for triangles
    float agreement;    // of its normals
    vec3 back;          // unit, to where the ray came from
    float height;       // of the voxel's place above the middle of its slab, along the normal
    float within;       // how far on the ray stays in the voxel
    float slab_half;    // of its thickness
    float slab_share;   // how much the voxel is a slab and not a cloud
};

#ifdef LOD
float side_of_node(uint node) {
    float side = 2.0;
    for (int i = 1; i < 16; ++i)
        side = node >= frame.level_begin[i >> 2][i & 3] ? 0.5 * side : side;
    return side;
}
#endif

// id, t: of the fragment; origin, direction: of the ray that met it.
Secondary_start secondary_start(uint id, float t, vec3 origin, vec3 direction) {
    float size = length_precise(direction);
    precise vec3 back = -direction / size;
#ifdef LOD
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uint node = voxel ? id & ~GW_FRAGMENT_VOXEL : 0u;
    Corner_weights corner = weights_at(voxel ? 0u : id, t, origin, direction);
    Surface surface = surface_of_voxel(node, t, origin, direction);
    float side = side_of_node(node);
    uvec3 payload = PAYLOAD(node);
    vec3 normal = payload_normal(payload);
    Voxel_shape shape = voxel_shape(payload, normal);
    // The ray entered the cell here: a little further on, beyond rounding, it is inside.
    precise vec3 inside = (surface.position - back * max(side * (1.0 / 2048.0), 5e-7) + 1.0) / side;
    precise vec3 place = (surface.position + 1.0) / side - floor(inside) - 0.5;
    precise float height = side * (dot(normal, place) - shape.slab_centre);
    precise vec3 ends = (0.5 + sign(back) * place) / max(abs(back), vec3(1e-6));
    float within = side * max(min(min(ends.x, ends.y), ends.z), 0.0);
    return Secondary_start(voxel ? surface.position : corner.position, voxel ? surface.normal : corner.normal,
                           voxel ? side : 0.0, voxel ? surface.agreement : 1.0, back,
                           dot(normal, surface.normal) < 0.0 ? -height : height, within,
                           side * shape.slab_half, shape.slab_share);
#else
    Corner_weights corner = weights_at(id, t, origin, direction);
    return Secondary_start(corner.position, corner.normal, 0.0, 1.0, back, 0.0, 0.0, 0.0, 0.0);
#endif
}

// The side of the coarsest voxel that stands for its contents at this accepted error; 0 if none does.
float coarsest_voxel(float accepted) {
    precise float side = 2.0 * accepted;
    const float finest = 2.0 / float(1 << OCTREE_DEPTH);
    return side >= finest ? uintBitsToFloat(floatBitsToUint(side) & 0x7f800000u) : 0.0;
}

// How high above the surface no voxel holds it any more.
float reach_of(Secondary_start start, float accepted) {
    float side = max(coarsest_voxel(accepted), start.own_side);
#ifdef NO_REACH
    side = 0.0; // the naive variant, for the test that shows why
#endif
    precise float reach = side * (abs(start.normal.x) + abs(start.normal.y) + abs(start.normal.z));
    return reach;
}

struct Secondary_origin {
    vec3 origin;
    float clear; // t up to which only triangles count
};

// accepted: error at the start; rise: of the ray above the surface per unit of t; from_voxel: where it starts from a voxel.
Secondary_origin secondary_origin(Secondary_start start, float accepted, float rise, vec3 from_voxel) {
    float reach = reach_of(start, accepted);
    bool voxel = start.own_side > 0.0;
    Secondary_origin from;
    from.origin = voxel ? from_voxel : offset_from_surface(start.place, start.normal);
    from.clear = !voxel && reach > 0.0 ? min(reach / max(rise, 1e-30), NEVER_CLEAR) : 0.0;
    return from;
}

// A place that no voxel reaches which could hold what the one at the start does, along a unit direction. Where that is low above the
// surface, twice the reach must do.
vec3 out_of_reach(Secondary_start start, float accepted, vec3 direction) {
    precise float way = reach_of(start, accepted) / max(dot(direction, start.normal), 0.5);
    precise vec3 place = start.place + direction * way;
    return place;
}

// Where a shadow's ray leaves a voxel. A cloud is left where the ray entered it: what is in it and beside it stands in its light.
// A slab must not: it is left where the ray that met it is above it, and above the slabs of neighbours of its own size and of
// the coarsest one.
vec3 shadow_origin(Secondary_start start, float accepted) {
    precise float above = start.slab_half + 2.0 * SLAB_HALF * max(coarsest_voxel(accepted), start.own_side);
#ifdef NO_REACH
    above = 0.0; // the naive variant, for the test that shows why
#endif
    float facing = max(dot(start.back, start.normal), 1e-3);
    precise float way = clamp((above - start.height) / facing, -start.within, start.own_side);
    precise float lack = max(above - (start.height + way * facing), 0.0);
    precise vec3 origin = start.place + start.slab_share * (way * start.back + lack * start.normal);
    return origin;
}

// The same towards a light that is `distance` away. What is seen of a lit room through a joint of its voxels, or lit through one,
// is the brighter the nearer the light: up to near_light times the reach the ray leaves along the way back to the eye, which is free, out of
// the reach of all of them, from twice that on as above. (The normal need not be free: at the edge of a wall whose sides are not turned the
// same way it leads into it.)
vec3 shadow_origin_near(Secondary_start start, float accepted, float distance) {
    float near = clamp(2.0 - distance / max(frame.secondary.z * reach_of(start, accepted), 1e-30), 0.0, 1.0);
#ifdef ALWAYS_OUT_OF_REACH
    near = 1.0; // the naive variant, for the test that shows why
#endif
    precise vec3 origin = mix(shadow_origin(start, accepted), out_of_reach(start, accepted, start.back), near);
    return origin;
}
