// Light from everything that shines on a surface.
#ifdef SHADOWS
#include "shade/visibilities.glsl"
#else
#include "shade/light_list.glsl"
#define VISIBILITY(fragment, light) 1.0
#endif

// fragment: which of the dispatch it is.
vec3 light_surface(Surface surface, vec3 view, uint fragment) {
    precise vec3 radiance = surface.emissive + reflect_environment(surface, view, irradiance_around(surface), radiance_around(surface, view));
#ifdef DIRECTIONAL_LIGHTS
    for (uint i = 0u; i < frame.counts.y; ++i) {
        vec4 towards = light_row(i, 0);
        float highlight = 1.0;
#ifdef ENVIRONMENT
        highlight = towards.w > 0.0 ? highlight_share(surface.roughness) : 1.0;
#endif
        radiance += reflect_light(surface, view, towards.xyz, light_row(i, 1).xyz, highlight) * VISIBILITY(fragment, i);
    }
#endif
#if defined(POINT_LIGHTS) || defined(SPOT_LIGHTS)
    for (uint i = frame.counts.y; i < frame.counts.y + frame.counts.z; ++i) {
        vec3 to_light = light_row(i, 0).xyz - surface.position;
        vec3 intensity = light_row(i, 1).xyz;
        float rebased = max(length_precise(to_light), 1e-12);
        precise float metres = max(rebased * frame.eye.w, 1e-3);
        vec3 towards = to_light / rebased;
        intensity *= share_of_light(i, towards, metres);
        radiance += reflect_light(surface, view, towards, intensity / (metres * metres), 1.0) * VISIBILITY(fragment, i);
    }
#endif
    return radiance;
}
