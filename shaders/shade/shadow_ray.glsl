// The ray from what a fragment shows to a light, and which part of it may meet voxels.
//
// Its width is that of the primary ray where it ends: constant towards a directional light, shrinking to 0 at a point light,
// as the beam from the pixel's footprint does. From triangles it starts with triangles only, up to where it has left every
// voxel that could hold the surface it comes from: with voxels of side h, a plane with the unit normal n lies in cells that
// reach up to h (|nx| + |ny| + |nz|) above it. A voxel is known no better than to its own side: from there the ray starts at
// that height. Needs shade/surface.glsl and shade/light_list.glsl before it.
#include "common/surface_offset.glsl"

// A point light is met a little before its place: it may lie in the plane of a lamp.
const float BEFORE_POINT_LIGHT = 1.0 - 1.0 / 1048576.0;
const float NEVER_CLEAR = 1e30;

struct Shadow_ray {
    bool needed;      // false: no light comes from there whatever stands between
    vec3 origin, direction; // rebased; t = 1 at a point light, unit length towards a directional one
    float maximum;    // t of the light
    float width;      // rebased units, at t = 0
    float narrowing;  // per unit of t
    float clear;      // t up to which only triangles count
};

// The side of the coarsest voxel that stands for its contents at this accepted error; 0 if none does.
float coarsest_voxel(float accepted) {
    precise float side = 2.0 * accepted;
    const float finest = 2.0 / float(1 << OCTREE_DEPTH);
    return side >= finest ? uintBitsToFloat(floatBitsToUint(side) & 0x7f800000u) : 0.0;
}

float reach_of_voxel(float side, vec3 n) {
#ifdef NO_REACH
    side = 0.0; // for the test that shows why
#endif
    precise float reach = side * (abs(n.x) + abs(n.y) + abs(n.z));
    return reach;
}

#ifdef LOD
float side_of_node(uint node) {
    float side = 2.0;
    for (int i = 1; i < 16; ++i)
        side = node >= frame.level_begin[i >> 2][i & 3] ? 0.5 * side : side;
    return side;
}
#endif

// id, t: of the fragment; eye, ray, tau: those of the ray that met it.
Shadow_ray shadow_ray_of(uint id, float t, vec3 eye, vec3 direction, float width, float tau, uint light) {
    vec3 vector = uintBitsToFloat(texelFetch(lights, int(light) * 2).xyz);
    bool point = light >= frame.counts.y;
    bool voxel = false;
    vec3 place, normal;
    float own = 0.0, agreement = 1.0;
#ifdef LOD
    voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uint node = voxel ? id & ~GW_FRAGMENT_VOXEL : 0u;
    Corner_weights corner = weights_at(voxel ? 0u : id, t, eye, direction);
    Surface of_voxel = surface_of_voxel(node, t, eye, direction);
    own = voxel ? side_of_node(node) : 0.0;
    agreement = voxel ? of_voxel.agreement : 1.0;
    place = voxel ? of_voxel.position : corner.position;
    normal = voxel ? of_voxel.normal : corner.normal;
#else
    Corner_weights corner = weights_at(id, t, eye, direction);
    place = corner.position;
    normal = corner.normal;
#endif
    Shadow_ray ray;
    vec3 towards = point ? vector - place : vector;
    precise float rise = dot(towards, normal);
    // Light from behind reaches no surface; what lies in a voxel faces all ways as far as its normals disagree.
    ray.needed = rise > 0.0 || agreement < 1.0;
    ray.width = width;
    ray.narrowing = point ? width : 0.0;
    ray.maximum = point ? BEFORE_POINT_LIGHT : 1e30;
    precise float accepted = frame.secondary.x * tau * width;
    float reach = reach_of_voxel(max(coarsest_voxel(accepted), own), normal);
    bool near = point && reach > 0.5 * length_precise(towards);
    bool lift = voxel && rise > 0.0 && !near;
    precise vec3 lifted = place + normal * reach;
    ray.origin = lift ? lifted : offset_from_surface(place, normal);
    ray.direction = point ? vector - ray.origin : vector;
    ray.clear = near ? NEVER_CLEAR : voxel ? 0.0 : reach > 0.0 ? min(reach / max(rise, 1e-30), NEVER_CLEAR) : 0.0;
    return ray;
}
