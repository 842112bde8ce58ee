// The ray that goes through a surface. It starts before the surface, on its own line, so that it meets the surfaces of other media
// that lie in the same place, and never meets the triangle that it comes through. Its footprint goes on as Igehy tells (Tracing
// Ray Differentials, 1999): in the plane of incidence angles grow by k = eta cos / cos', and a surface whose normals turn by w over
// the footprint bends its rays together or apart by (1 - k) w; across that plane k is eta. The wider of the two counts. Needs
// shade/secondary_ray.glsl and shade/transmission.glsl before it.

const float BEFORE_SURFACE = 1.0 / 65536.0; // as common/surface_offset.glsl

Secondary_ray refracted_ray(Met met, Optics optics, vec3 tint) {
    vec3 n = optics.normal;
    precise vec3 bent = optics.eta * met.direction + (optics.eta * optics.cosine - optics.cosine_beyond) * n;
    precise float beyond = dot(bent, met.start.normal);
    bent = beyond < -1e-3 ? bent : bent - (beyond + 1e-3) * met.start.normal;
    precise vec3 direction = bent / max(length_precise(bent), 1e-6);
    float sinking = max(-dot(direction, met.start.normal), 1.0 / 64.0);

    float turn = met.voxel ? 0.0 : curvature_of(met.id).y * met.width;
    turn = clamp(meets_back(met.id, met.direction) ? -turn : turn, -1.0, 1.0);
    precise float in_plane = optics.eta * optics.cosine / max(optics.cosine_beyond, 0.05);
    precise float within = in_plane * met.growth - (1.0 - in_plane) * turn;
    precise float across = optics.eta * met.growth - (optics.cosine_beyond - optics.eta * optics.cosine) * turn;
    float growth = clamp(abs(within) > abs(across) ? within : across, -2.0, 2.0);
    Secondary_ray next;
    precise vec3 origin = met.start.place - direction * (BEFORE_SURFACE / sinking);
    bool sheet = !optics.boundary;
#ifdef SKIP_COINCIDENT
    sheet = true; // the naive variant, for the test that shows why
#endif
    next.origin = sheet ? offset_from_surface(met.start.place, -met.start.normal) : origin;
    next.direction = direction;
    next.width = met.width;
    next.growth = growth;
#ifdef FORGET_FOOTPRINT
    next.width = next.growth = 0.0; // the naive variant, for the test that shows why
#endif
    next.tau = met.ray.tau;
    next.clear = min(reach_of(met.start, met.ray.tau * met.width) / sinking, NEVER_CLEAR);
    next.part = (1.0 - optics.reflectance) * optics.share * max(tint.r, max(tint.g, tint.b));
    next.media = optics.beyond;
    next.skipped = met.id;
    return next;
}
