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

// From four fifths of glossy_roughness on rays bring less and less, so that a map of roughness shows no line there.
float share_by_roughness(float roughness, float limit) {
    precise float share = clamp(5.0 - 5.0 * roughness / max(limit, 1e-6), 0.0, 1.0);
    return limit > 0.0 ? share : 0.0;
}

// Of a voxel the roughness of its surface counts, not how its normals lie apart, or it would stop to reflect at a gaze's border.
float glossy_share(uint id, Surface surface, out float roughness) {
    float limit = frame.environment.w;
    roughness = surface.roughness;
#ifdef LOD
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uvec3 payload = PAYLOAD(voxel ? id & ~GW_FRAGMENT_VOXEL : 0u);
    roughness = voxel ? float(GW_PAYLOAD_ROUGHNESS_CODE(payload.z)) * (1.0 / 63.0) : roughness;
    limit = voxel && !GW_PAYLOAD_HAS_NORMAL(payload.y) ? 0.0 : limit;
#endif
    float share = share_by_roughness(roughness, limit);
    return reflects_as_gloss(id) ? share : 0.0;
}

#ifdef CLEARCOAT
// Of its coat, which voxels do not have. A mirror's counts, too.
float coat_share(uint id, Surface surface) {
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    bool sheer = !voxel && (TRIANGLE(voxel ? 0u : id, 0).w & GW_TRIANGLE_SHEER) != 0u;
    precise float share = share_by_roughness(surface.coat_roughness, frame.environment.w);
#ifdef DULL_COATS
    share = 0.0; // the naive variant, for the test that shows why
#endif
    return voxel || sheer || surface.coat <= 0.0 ? 0.0 : share;
}
#endif

// Both lobes of a surface.
struct Glosses {
    Gloss base;
#ifdef CLEARCOAT
    Gloss coat;
    vec3 coat_normal;
#endif
};

Glosses glosses_at(Pixel_ray ray, uint id, float t) {
    Glosses glosses;
    vec3 view = -ray.direction / length_precise(ray.direction);
    Surface surface = surface_of_fragment(id, t, ray);
    see_surface(surface, view);
    vec3 reflected = environment_specular(surface, view);
    glosses.base.share = glossy_share(id, surface, glosses.base.roughness);
    precise float part = glosses.base.share * max(reflected.x, max(reflected.y, reflected.z));
    glosses.base.part = part;
#ifdef CLEARCOAT
    glosses.coat.share = coat_share(id, surface);
    glosses.coat.roughness = surface.coat_roughness;
    precise float coat_part = glosses.coat.share * environment_coat(surface);
    glosses.coat.part = coat_part;
    glosses.coat_normal = surface.coat_normal;
#endif
    return glosses;
}
