// Light from everything that shines on a surface.
#ifdef SHADOWS
#include "shade/visibilities.glsl"
#else
#include "shade/light_list.glsl"
#define VISIBILITY(fragment, light) 1.0
#endif

// fragment: which of the dispatch it is.
vec3 light_surface(Surface surface, vec3 view, uint fragment) {
    precise vec3 radiance = surface.emissive + reflect_environment(surface, view, frame.ambient.rgb, frame.ambient.rgb * INVERSE_PI);
#ifdef DIRECTIONAL_LIGHTS
    for (uint i = 0u; i < frame.counts.y; ++i) {
        vec3 towards = uintBitsToFloat(texelFetch(lights, int(i) * 2).xyz);
        vec3 irradiance = uintBitsToFloat(texelFetch(lights, int(i) * 2 + 1).xyz);
        radiance += reflect_light(surface, view, towards, irradiance) * VISIBILITY(fragment, i);
    }
#endif
#ifdef POINT_LIGHTS
    for (uint i = frame.counts.y; i < frame.counts.y + frame.counts.z; ++i) {
        vec3 to_light = uintBitsToFloat(texelFetch(lights, int(i) * 2).xyz) - surface.position;
        vec3 intensity = uintBitsToFloat(texelFetch(lights, int(i) * 2 + 1).xyz);
        float rebased = max(length_precise(to_light), 1e-12);
        precise float metres = max(rebased * frame.eye.w, 1e-3);
        radiance += reflect_light(surface, view, to_light / rebased, intensity / (metres * metres)) * VISIBILITY(fragment, i);
    }
#endif
    return radiance;
}
