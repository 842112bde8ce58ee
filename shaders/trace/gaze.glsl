// What each viewer's eye can tell at a point of the wall: how far tau may go there and how wide a footprint is enough.
//
// Eccentricity is the angle from the gaze ray at that viewer's eye. The smallest resolvable period grows with it as
// MAR(e) = smallest + slope * e degrees (Guenter et al. 2012); samples half a period apart suffice.

struct Acuity {
    float tau;   // footprints
    float width; // ray units: spacing of samples that the viewer cannot tell apart
};

// point: relative to the rendering eye, ray units.
Acuity acuity_of(gw_viewer viewer, vec3 point) {
    precise vec3 towards = point - viewer.eye.xyz;
    precise float x = dot(towards, viewer.right.xyz);
    precise float y = dot(towards, viewer.up.xyz);
    precise float z = dot(towards, viewer.forward.xyz);
    precise float across = sqrt(x * x + y * y);
    float from_axis = angle_degrees(across, abs(z));
    float eccentricity = z < 0.0 ? 180.0 - from_axis : from_axis;

    // Half-angle of the ellipse in the direction of (x, y).
    float half_width = max(viewer.eye.w, 1e-3), half_height = max(viewer.right.w, 1e-3);
    precise vec2 scaled = vec2(x / half_width, y / half_height);
    precise float spread = sqrt(scaled.x * scaled.x + scaled.y * scaled.y);
    precise float half_angle = spread > 0.0 ? across / spread : half_height;

    precise float outside = eccentricity - half_angle;
    precise float ramp = frame.accuracy.z > 0.0 ? clamp(outside / frame.accuracy.z, 0.0, 1.0) : (outside > 0.0 ? 1.0 : 0.0);
    precise float smooth_ramp = ramp * ramp * (3.0 - 2.0 * ramp);
    precise float blurred = max(outside - frame.accuracy.w, 0.0);
    precise float pitch = 0.5 * (frame.acuity.y + frame.acuity.x * blurred) * 0.017453292519943295;

    Acuity result;
    precise float tau = frame.accuracy.y + (frame.accuracy.x - frame.accuracy.y) * smooth_ramp;
    precise float width = length_precise(towards) * min(pitch, 1.0);
    result.tau = tau;
    result.width = width;
    return result;
}

// Angle between the gaze and a point, at the eye of the viewer for whom it is least; degrees.
float eccentricity_at(vec3 point) {
    float least = 180.0;
    for (uint i = 0u; i < frame.counts.x; ++i) {
        gw_viewer viewer = frame.viewers[i];
        precise vec3 towards = point - viewer.eye.xyz;
        precise float z = dot(towards, viewer.forward.xyz);
        float from_axis = angle_degrees(length_precise(towards - viewer.forward.xyz * z), abs(z));
        least = min(least, z < 0.0 ? 180.0 - from_axis : from_axis);
    }
    return least;
}

// Smallest tau and width over all viewers.
Acuity acuity_at(vec3 point) {
    Acuity best = acuity_of(frame.viewers[0], point);
    for (uint i = 1u; i < frame.counts.x; ++i) {
        Acuity other = acuity_of(frame.viewers[i], point);
        best.tau = min(best.tau, other.tau);
        best.width = min(best.width, other.width);
    }
    return best;
}
