// Adds to a fragment's light what its secondary rays bring.
#include "shade/secondary_kinds.glsl"
layout(std430, binding = 18) readonly buffer Radiance { vec4 radiance_of[]; }; // by number; w: what of the ray met nothing
layout(std430, binding = 19) readonly buffer Asked { uint asked_of[]; };      // of each fragment

#ifdef MIRROR
// What a mirror reflects, in place of what it reflects of the light from everywhere.
vec3 with_reflected(vec3 lit, Surface surface, vec3 view, uint id, uint asked) {
    bool none = (GW_ASKED_KINDS(asked) & GW_RAY_REFLECTED) == 0u;
    vec3 radiance = radiance_of[none ? 0u : GW_ASKED_FIRST(asked)].rgb;
    float share = none ? 0.0 : mirror_share(id);
    float grazing = 1.0 - clamp(dot(surface.normal, view), 0.0, 1.0);
    precise float grazing2 = grazing * grazing;
    precise vec3 fresnel = surface.base_color + (1.0 - surface.base_color) * (grazing2 * grazing2 * grazing);
    precise vec3 added = share * (fresnel * radiance - environment_specular(surface, view) * radiance_around(surface, view));
    return none ? lit : lit + added;
}
#endif

vec3 with_secondary(vec3 lit, Surface surface, vec3 view, uint id, uint fragment) {
    uint asked = asked_of[fragment];
#ifdef MIRROR
    lit = with_reflected(lit, surface, view, id, asked);
#endif
    return lit;
}
