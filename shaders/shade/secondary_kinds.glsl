// Which secondary rays a fragment asks for, by kind. To add a kind:
//  1. a bit GW_RAY_ in common/frame.h, and GW_RAYS_OF_FRAGMENT grown by as many rays as a fragment asks of it;
//  2. an effect in GW_SECONDARY_FEATURES (render/features.h), whose define compiles in what follows;
//  3. here: when a fragment asks for it, and how many rays that are;
//  4. in shade/secondary_rays.comp: origin, direction, footprint and spread of each, tau, what of it meets triangles only;
//  5. in shade/secondary_light.glsl: how the fragment's light takes what they bring, radiance and what of a ray met nothing.
// Numbers of rays depend on atomics, what they bring does not: nothing else may be made of a number. Needs shade/surface.glsl
// before it.
#include "shade/mirror_share.glsl"

uint kinds_asked(uint id) {
    uint kinds = 0u;
#ifdef MIRROR
    kinds |= mirror_share(id) > 0.0 ? GW_RAY_REFLECTED : 0u;
#endif
    return kinds;
}

uint rays_of(uint kinds) {
    return kinds & GW_RAY_REFLECTED;
}
