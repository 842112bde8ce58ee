// Which secondary rays a fragment asks for, by kind. To add a kind:
//  1. a bit GW_RAY_ in common/frame.h, and GW_RAYS_OF_FRAGMENT grown by as many rays as a fragment asks of it;
//  2. an effect in GW_SECONDARY_FEATURES (render/features.h), whose define compiles in what follows;
//  3. here: when a fragment asks for it, and how many rays that are;
//  4. in shade/secondary_rays.comp: origin, direction, footprint and spread of each, tau, what of it meets triangles only;
//  5. in shade/secondary_light.glsl: how the fragment's light takes what they bring, radiance and what of a ray met nothing.
// Numbers of rays depend on atomics, what they bring does not: nothing else may be made of a number. Needs shade/surface.glsl
// and trace/pixel.glsl before it.
#include "shade/mirror_share.glsl"
#ifdef GLOSSY
#include "shade/glossy_share.glsl"
#endif

// What share of a pixel depends on a fragment of that weight, at most.
float throughput_of(Pixel_ray ray, float weight) {
#ifdef REFLECTED
    precise float throughput = ray.throughput * weight;
    return throughput;
#else
    return weight;
#endif
}

// Whether a secondary ray is worth its cost that the share `part` of a pixel depends on.
bool worth_asking(Pixel_ray ray, float part) {
    precise float least = frame.secondary.w * (1.0 + ray.tau);
    return part > 0.0 && part >= least;
}

#ifdef CONES
// What share of a fragment reflects light all ways, at most.
float diffuse_share_of(uint id) {
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    int material = int(texelFetch(faces, int(voxel ? 0u : id)).w) * 3;
    float metalness = uintBitsToFloat(texelFetch(materials, material + 1).w);
#ifdef MATERIAL_MAPS
    metalness = 0.0; // a texture has it
#endif
#ifdef LOD
    uvec3 payload = PAYLOAD(voxel ? id & ~GW_FRAGMENT_VOXEL : 0u);
    metalness = voxel ? float(GW_PAYLOAD_METALNESS_CODE(payload.z)) * (1.0 / 63.0) : metalness;
#endif
    return 1.0 - metalness;
}
#endif

#ifdef TRANSMISSION
#include "shade/transmission.glsl"

// The media that a ray starts in.
uvec2 media_of_start(uint slot) {
#ifdef REFLECTED
    return given_rays[slot * GW_SECONDARY_ROWS + 3u].xy;
#else
    return frame.media.xy;
#endif
}

uint refraction_asked(Pixel_ray ray, uint id, float t, float weight, uvec2 media) {
    uint kinds = 0u;
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    Surface surface = surface_of_triangle(voxel ? 0u : id, t, ray.origin, ray.direction, footprint_at(ray, t));
    Optics optics = optics_of(id, ray.direction / length_precise(ray.direction), surface.normal, surface.metalness, passing_of(surface), media);
    float throughput = throughput_of(ray, weight);
    bool counts = optics.sheer && !optics.passed;
    kinds |= counts && worth_asking(ray, throughput * optics.reflectance) ? GW_RAY_REFLECTED : 0u;
    kinds |= counts && worth_asking(ray, throughput * (1.0 - optics.reflectance) * optics.share) ? GW_RAY_REFRACTED : 0u;
    return kinds;
}
#endif

#ifdef GLOSSY
uint gloss_asked(Pixel_ray ray, uint id, float t, float weight) {
    Glosses glosses = glosses_at(ray, id, t);
    float throughput = throughput_of(ray, weight);
    uint kinds = worth_asking(ray, throughput * glosses.base.part) ? GW_RAY_REFLECTED : 0u;
#ifdef CLEARCOAT
    kinds |= worth_asking(ray, throughput * glosses.coat.part) ? GW_RAY_COAT : 0u;
#endif
    return kinds;
}
#endif

// media: that the ray is in where it meets this, with TRANSMISSION.
uint kinds_asked(Pixel_ray ray, uint id, float t, float weight, uvec2 media) {
    uint kinds = 0u;
#ifdef TRANSMISSION
    kinds |= refraction_asked(ray, id, t, weight, media);
#endif
#ifdef GLOSSY
    kinds |= gloss_asked(ray, id, t, weight);
#endif
#ifdef MIRROR
    kinds |= worth_asking(ray, throughput_of(ray, weight) * mirror_share(id)) ? GW_RAY_REFLECTED : 0u;
#endif
#ifdef CONES
    bool cones = frame.sampling.z > 0u && worth_asking(ray, throughput_of(ray, weight) * diffuse_share_of(id));
    kinds |= cones ? GW_RAY_CONES : 0u;
#endif
    return kinds;
}

// Which of a fragment's rays its clearcoat reflects, if any; and of cones the first.
uint coat_ray_of(uint kinds) {
    return uint(bitCount(kinds & (GW_RAY_REFLECTED | GW_RAY_REFRACTED)));
}

uint first_cone_of(uint kinds) {
    return uint(bitCount(kinds & (GW_RAY_REFLECTED | GW_RAY_REFRACTED | GW_RAY_COAT)));
}

uint rays_of(uint kinds) {
    return first_cone_of(kinds) + ((kinds & GW_RAY_CONES) != 0u ? frame.sampling.z : 0u);
}
