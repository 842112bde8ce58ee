// The rule of Weier, Hinkenjann and Slusallek (2014): the viewer's elliptic cone meets the wall in an ellipse; inside, triangles
// are exact; outside, the distance d along the wall from the ellipse lets voxels grow by log2(1 + d / seed_distance) octree levels.

// Far beyond what any octree distinguishes; where a gaze does not meet the wall.
#define FARTHEST_SEED_DISTANCE 1023.0

// From the ellipse towards its centre, over seed_distance; 0 inside. point: of the wall's plane, from the rendering eye.
float seed_distance_of(gw_viewer viewer, vec3 point) {
    precise vec3 normal = vec3(frame.step_x.y * frame.step_y.z - frame.step_x.z * frame.step_y.y,
                               frame.step_x.z * frame.step_y.x - frame.step_x.x * frame.step_y.z,
                               frame.step_x.x * frame.step_y.y - frame.step_x.y * frame.step_y.x);
    precise float to_wall = dot(frame.corner.xyz - viewer.eye.xyz, normal);
    precise float along = dot(viewer.forward.xyz, normal);
    precise float centre = to_wall / along; // where the gaze meets the wall
    precise vec3 towards = point - viewer.eye.xyz;
    precise float x = dot(towards, viewer.right.xyz) / viewer.up.w;
    precise float y = dot(towards, viewer.up.xyz) / viewer.forward.w;
    precise float beyond = sqrt(x * x + y * y) - dot(towards, viewer.forward.xyz);
    precise vec3 from_centre = towards - viewer.forward.xyz * centre;
    // The line from the centre to the point leaves the cone at a share centre / (beyond + centre) of the way.
    precise float distance_ = beyond / (beyond + centre) * length_precise(from_centre) * frame.step_x.w;
    bool meets = centre > 0.0 && centre < 1e30;
    return !meets ? FARTHEST_SEED_DISTANCE : beyond <= 0.0 ? 0.0 : min(distance_, FARTHEST_SEED_DISTANCE);
}

// Least over all viewers.
float seed_distance_at(vec3 point) {
    float least = FARTHEST_SEED_DISTANCE;
    for (uint i = 0u; i < frame.counts.x; ++i)
        least = min(least, seed_distance_of(frame.viewers[i], point));
    return least;
}
