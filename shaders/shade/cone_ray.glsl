// A cone about the normal that asks how much of it is covered, and by what: a ray whose footprint grows as fast as it may without
// meeting the plane that it leaves. A voxel that stands for its contents is up to twice as wide as the footprint, and a plane with the
// normal n lies in voxels of side v up to v (|nx| + |ny| + |nz|) above it; half of the ray's own height is left for what bends. Needs
// shade/secondary_ray.glsl and shade/frame_about.glsl before it.

// How much of its height above the plane that it leaves a ray may be wide, twice over and in the plane's extent: a voxel up to twice as
// wide as the footprint reaches half of the height, and the other half is left for what bends. Wider covers flat surfaces by themselves.
const float cone_growth = 0.25;
// Sine of the least angle between a ray and the plane: flatter ones hardly grow, meet the most cells, and count the least, as the cosine.
const float cone_least_rise = 0.05;

// which: of the frame's cones.
Secondary_ray cone_ray(Met met, uint which) {
    vec4 cone = frame.cones[min(which, 5u)];
    mat3 about = frame_about(met.normal);
    vec3 plane = met.start.normal;
    precise vec3 direction = about[0] * cone.x + about[1] * cone.y + about[2] * cone.z;
    // Shading normals lead below the surface that is there.
    direction += plane * max(cone_least_rise - dot(direction, plane), 0.0);
    direction /= max(length_precise(direction), 1e-6);
    float rise = max(dot(direction, plane), 0.5 * cone_least_rise);
    float extent = abs(plane.x) + abs(plane.y) + abs(plane.z);
    precise float growth = cone_growth * rise / extent;
    precise float accepted = met.ray.tau * met.width;
    Secondary_origin from = secondary_origin(met.start, accepted, rise, shadow_origin(met.start, accepted));
    precise float clear = max(from.clear, met.start.own_side > 0.0 ? 0.0 : 4.0 * accepted * extent / rise);
    Secondary_ray next;
    next.origin = from.origin;
    next.direction = direction;
    next.width = accepted;
    next.growth = growth;
    next.tau = 1.0;
    next.clear = clear;
    next.part = 0.0;
#ifdef TRANSMISSION
    next.skipped = GW_NO_TRIANGLE;
#endif
    return next;
}
