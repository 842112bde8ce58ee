// Where a ray starts that leaves what a fragment shows, and which part of it may meet voxels.
//
// From triangles it starts with triangles only, up to where it has left every voxel that could hold the surface it comes from:
// with voxels of side h, a plane with the unit normal n lies in cells that reach up to h (|nx| + |ny| + |nz|) above it. A voxel
// is known no better than to its own side: from there the ray starts at that height. Needs shade/surface.glsl before it.
#include "common/surface_offset.glsl"

const float NEVER_CLEAR = 1e30;

struct Secondary_start {
    vec3 place, normal; // the triangle's own normal, on the side from which it is seen
    float own_side;     // of the voxel; 0 for triangles
    float agreement;    // of its normals
    vec3 back;          // unit, to where the ray came from
    float free;         // how far that way may be gone
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
    return Secondary_start(voxel ? surface.position : corner.position, voxel ? surface.normal : corner.normal,
                           voxel ? side_of_node(node) : 0.0, voxel ? surface.agreement : 1.0, back, 0.5 * t * size);
#else
    Corner_weights corner = weights_at(id, t, origin, direction);
    return Secondary_start(corner.position, corner.normal, 0.0, 1.0, back, 0.5 * t * size);
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

// accepted: error at the start; rise: of the ray above the surface per unit of t; way_out: unit, along which a voxel is left, and
// how far that is free. A shadow's ray leaves along the way back to the eye, which is free; the normal need not be: at the edge
// of a wall whose sides are not turned the same way it leads into it. A reflected ray leaves along itself. Where the way out is
// low above the surface, twice the reach must do.
Secondary_origin secondary_origin(Secondary_start start, float accepted, float rise, vec3 way_out, float free) {
    float reach = reach_of(start, accepted);
    bool voxel = start.own_side > 0.0;
    precise float way = min(reach / max(dot(way_out, start.normal), 0.5), free);
    precise vec3 lifted = start.place + way_out * way;
    Secondary_origin from;
    from.origin = voxel ? lifted : offset_from_surface(start.place, start.normal);
    from.clear = !voxel && reach > 0.0 ? min(reach / max(rise, 1e-30), NEVER_CLEAR) : 0.0;
    return from;
}
