// Which secondary rays a fragment asks for, by kind. To add a kind:
//  1. a bit GW_RAY_ in common/frame.h, and GW_RAYS_OF_FRAGMENT grown by as many rays as a fragment asks of it;
//  2. an effect in GW_SECONDARY_FEATURES (render/features.h), whose define compiles in what follows;
//  3. here: when a fragment asks for it, and how many rays that are;
//  4. in shade/secondary_rays.comp: origin, direction, footprint and spread of each, tau, what of it meets triangles only;
//  5. in shade/secondary_light.glsl: how the fragment's light takes what they bring, radiance and what of a ray met nothing.
// Numbers of rays depend on atomics, what they bring does not: nothing else may be made of a number. Needs shade/surface.glsl
// and trace/pixel.glsl before it.
#include "shade/mirror_share.glsl"

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

uint kinds_asked(Pixel_ray ray, uint id, float weight) {
    uint kinds = 0u;
#ifdef MIRROR
    kinds |= worth_asking(ray, throughput_of(ray, weight) * mirror_share(id)) ? GW_RAY_REFLECTED : 0u;
#endif
    return kinds;
}

uint rays_of(uint kinds) {
    return kinds & GW_RAY_REFLECTED;
}
