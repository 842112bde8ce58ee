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
#ifdef LOD
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uint node = voxel ? id & ~GW_FRAGMENT_VOXEL : 0u;
    Corner_weights corner = weights_at(voxel ? 0u : id, t, origin, direction);
    Surface surface = surface_of_voxel(node, t, origin, direction);
    return Secondary_start(voxel ? surface.position : corner.position, voxel ? surface.normal : corner.normal,
                           voxel ? side_of_node(node) : 0.0, voxel ? surface.agreement : 1.0);
#else
    Corner_weights corner = weights_at(id, t, origin, direction);
    return Secondary_start(corner.position, corner.normal, 0.0, 1.0);
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

// accepted: error at the start; rise: of the ray above the surface per unit of t.
Secondary_origin secondary_origin(Secondary_start start, float accepted, float rise) {
    float reach = reach_of(start, accepted);
    bool voxel = start.own_side > 0.0;
    precise vec3 lifted = start.place + start.normal * reach;
    Secondary_origin from;
    // Also towards a light behind the voxel: the ray then goes back through all that the voxel shows, whole, so that the edge of
    // a closed wall stays dark, and passes beside what is turned to the light.
    from.origin = voxel ? lifted : offset_from_surface(start.place, start.normal);
    from.clear = !voxel && reach > 0.0 ? min(reach / max(rise, 1e-30), NEVER_CLEAR) : 0.0;
    return from;
}
