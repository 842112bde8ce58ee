// Light from everything that shines on a surface.
#ifdef SHADOWS
#include "shade/visibilities.glsl"
#else
#include "shade/light_list.glsl"
#define VISIBILITY(fragment, light) 1.0
#endif
#include "shade/area_light.glsl"

#ifdef EMISSIVE_LIGHTS
// A point of an emissive surface stands for a part of it, so its highlight is as wide as that part looks (Karis, Real Shading in Unreal
// Engine 4, 2013).
Surface widened_by(Surface surface, float angle) {
    precise float wide = sqrt(min(surface.roughness * surface.roughness + angle, 1.0));
    surface.roughness = angle > 0.0 ? wide : surface.roughness;
#ifdef CLEARCOAT
    precise float wide_coat = sqrt(min(surface.coat_roughness * surface.coat_roughness + angle, 1.0));
    surface.coat_roughness = angle > 0.0 ? wide_coat : surface.coat_roughness;
#endif
    return surface;
}
#endif

// Which share of a light's highlights lights bring that were taken from the environment; of the clearcoat's in y.
vec2 highlights_of_environment(Surface surface) {
    vec2 share = vec2(1.0);
#ifdef ENVIRONMENT
    share.x = highlight_share(surface.roughness);
#ifdef CLEARCOAT
    share.y = highlight_share(surface.coat_roughness);
#endif
#endif
    return share;
}

// fragment: which of the dispatch it is; seen: what share of the highlights of surfaces that emit light secondary rays bring, and of
// those of its clearcoat.
vec3 light_surface(Surface surface, vec3 view, uint fragment, vec2 seen) {
    precise vec3 radiance = surface.emissive + reflect_environment(surface, view, irradiance_around(surface), radiance_around(surface, view),
                                                                   radiance_around_coat(surface, view));
#ifdef DIRECTIONAL_LIGHTS
    for (uint i = 0u; i < frame.counts.y; ++i) {
        vec2 highlight = light_row(i, 0).w > 0.0 ? highlights_of_environment(surface) : vec2(1.0);
        radiance += reflect_light(surface, view, point_of_light(i, surface.position).towards, light_row(i, 1).xyz, highlight) * VISIBILITY(fragment, i);
    }
#endif
#if defined(POINT_LIGHTS) || defined(SPOT_LIGHTS) || defined(EMISSIVE_LIGHTS)
    for (uint i = frame.counts.y; i < frame.counts.y + frame.counts.z; ++i) {
        Light_point point = point_of_light(i, surface.position);
        vec3 intensity = light_row(i, 1).xyz * point.share;
        precise float metres = max(max(point.distance, 1e-12) * frame.eye.w, 1e-3);
        vec3 towards = point.towards / max(length_precise(point.towards), 1e-12);
        intensity *= share_of_light(i, towards, metres);
        Surface lit = surface;
        vec2 highlight = vec2(1.0);
#ifdef EMISSIVE_LIGHTS
        lit = widened_by(surface, point.angle);
        highlight = is_emissive(i) ? 1.0 - seen : vec2(1.0);
#endif
        radiance += reflect_light(lit, view, towards, intensity / (metres * metres), highlight) * VISIBILITY(fragment, i);
    }
#endif
    return radiance;
}
