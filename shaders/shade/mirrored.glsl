// Adds to a fragment's light what it mirrors, in place of what it reflects of the light from everywhere.
#include "shade/mirror_share.glsl"
layout(std430, binding = 18) readonly buffer Reflections { vec4 reflections[]; };     // radiance
layout(std430, binding = 19) readonly buffer Reflection_of { uint reflection_of[]; }; // of each fragment

vec3 mirrored(vec3 lit, Surface surface, vec3 view, uint id, uint fragment) {
    uint number = reflection_of[fragment];
    bool none = number == GW_NO_REFLECTION;
    vec3 radiance = reflections[none ? 0u : number].rgb;
    float share = none ? 0.0 : mirror_share(id);
    float grazing = 1.0 - clamp(dot(surface.normal, view), 0.0, 1.0);
    precise float grazing2 = grazing * grazing;
    precise vec3 fresnel = surface.base_color + (1.0 - surface.base_color) * (grazing2 * grazing2 * grazing);
    precise vec3 added = share * (fresnel * radiance - environment_specular(surface, view) * frame.ambient.rgb * INVERSE_PI);
    return none ? lit : lit + added;
}
