// Light from everything that shines on a surface.
#ifdef SHADOWS
#include "shade/visibilities.glsl"
#else
#include "shade/light_list.glsl"
#define VISIBILITY(fragment, light) 1.0
#endif
#include "shade/area_light.glsl"

// fragment: which of the dispatch it is.
vec3 light_surface(Surface surface, vec3 view, uint fragment) {
    precise vec3 radiance = surface.emissive + reflect_environment(surface, view, irradiance_around(surface), radiance_around(surface, view));
#ifdef DIRECTIONAL_LIGHTS
    for (uint i = 0u; i < frame.counts.y; ++i) {
        float highlight = 1.0;
#ifdef ENVIRONMENT
        highlight = light_row(i, 0).w > 0.0 ? highlight_share(surface.roughness) : 1.0;
#endif
        radiance += reflect_light(surface, view, point_of_light(i, surface.position).towards, light_row(i, 1).xyz, highlight) * VISIBILITY(fragment, i);
    }
#endif
#if defined(POINT_LIGHTS) || defined(SPOT_LIGHTS)
    for (uint i = frame.counts.y; i < frame.counts.y + frame.counts.z; ++i) {
        Light_point point = point_of_light(i, surface.position);
        vec3 intensity = light_row(i, 1).xyz * point.share;
        precise float metres = max(max(point.distance, 1e-12) * frame.eye.w, 1e-3);
        vec3 towards = point.towards / max(length_precise(point.towards), 1e-12);
        intensity *= share_of_light(i, towards, metres);
        radiance += reflect_light(surface, view, towards, intensity / (metres * metres), 1.0) * VISIBILITY(fragment, i);
    }
#endif
    return radiance;
}
