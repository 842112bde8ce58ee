// What of a surface is neither mirror nor rough: how much it reflects of what stands round it. Needs shade/mirror_share.glsl and
// trace/pixel.glsl before it.

struct Gloss {
    float share;     // of its highlight that rays bring; the rest takes the light from everywhere
    float roughness; // of the lobe
    float part;      // of white light from everywhere that rays bring, at most
};

// Mirrors and what lets light through have rays of their own.
bool reflects_as_gloss(uint id) {
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    bool sheer = !voxel && (TRIANGLE(voxel ? 0u : id, 0).w & GW_TRIANGLE_SHEER) != 0u;
    return !sheer && mirror_share(id) <= 0.0;
}

// Of a voxel the roughness of its surface counts, not how its normals lie apart, or it would stop to reflect at a gaze's border. From
// four fifths of glossy_roughness on rays bring less and less, so that a map of roughness shows no line there.
float glossy_share(uint id, Surface surface, out float roughness) {
    float limit = frame.environment.w;
    roughness = surface.roughness;
#ifdef LOD
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uvec3 payload = PAYLOAD(voxel ? id & ~GW_FRAGMENT_VOXEL : 0u);
    roughness = voxel ? float(GW_PAYLOAD_ROUGHNESS_CODE(payload.z)) * (1.0 / 63.0) : roughness;
    limit = voxel && !GW_PAYLOAD_HAS_NORMAL(payload.y) ? 0.0 : limit;
#endif
    precise float share = clamp(5.0 - 5.0 * roughness / max(limit, 1e-6), 0.0, 1.0);
    return limit > 0.0 && reflects_as_gloss(id) ? share : 0.0;
}

Gloss gloss_at(Pixel_ray ray, uint id, float t) {
    Gloss gloss;
    vec3 view = -ray.direction / length_precise(ray.direction);
    Surface surface = surface_of_fragment(id, t, ray);
    see_surface(surface, view);
    vec3 reflected = environment_specular(surface, view);
    gloss.share = glossy_share(id, surface, gloss.roughness);
    precise float part = gloss.share * max(reflected.x, max(reflected.y, reflected.z));
    gloss.part = part;
    return gloss;
}
