// Adds to a fragment's light what its secondary rays bring.
#include "shade/secondary_kinds.glsl"
layout(std430, binding = 18) readonly buffer Radiance { vec4 radiances[]; };
layout(std430, binding = 19) readonly buffer Asked { uint asked_of[]; }; // of each fragment

// What the ray of this number brings; w: what of it met nothing.
vec4 radiance_of(uint number) {
#ifdef DIFFUSE
    return radiances[number * GW_BROUGHT_ROWS_DIFFUSE];
#else
    return radiances[number];
#endif
}

#ifdef MIRROR
// What a mirror reflects, in place of what it reflects of the light from everywhere.
vec3 with_reflected(vec3 lit, Surface surface, vec3 view, uint id, uint asked) {
    bool none = (GW_ASKED_KINDS(asked) & GW_RAY_REFLECTED) == 0u;
    vec3 radiance = radiance_of(none ? 0u : GW_ASKED_FIRST(asked)).rgb;
    float share = none ? 0.0 : mirror_share(id);
    float grazing = 1.0 - clamp(dot(surface.normal, view), 0.0, 1.0);
    precise float grazing2 = grazing * grazing;
    precise vec3 fresnel = surface.base_color + (1.0 - surface.base_color) * (grazing2 * grazing2 * grazing);
    precise vec3 added = share * (fresnel * radiance - environment_specular(surface, view) * radiance_around(surface, view));
    return none ? lit : lit + added;
}
#endif

#ifdef GLOSSY
// What stands round a nearly smooth lobe, in place of the light from everywhere that it keeps away.
vec3 changed_by(vec4 brought, vec3 around) {
    precise vec3 changed = brought.rgb + (brought.w - 1.0) * around;
    return changed;
}

#ifdef CLEARCOAT
vec3 with_glossy_coat(vec3 lit, Surface surface, vec3 view, uint id, uint asked) {
    uint kinds = GW_ASKED_KINDS(asked);
    bool none = (kinds & GW_RAY_COAT) == 0u;
    vec4 brought = radiance_of(none ? 0u : GW_ASKED_FIRST(asked) + coat_ray_of(kinds));
    float share = coat_share(id, surface);
    precise vec3 added = lit + share * environment_coat(surface) * changed_by(brought, radiance_around_coat(surface, view));
    return none || share <= 0.0 ? lit : added;
}
#endif

vec3 with_glossy(vec3 lit, Surface surface, vec3 view, uint id, uint asked) {
    bool none = (GW_ASKED_KINDS(asked) & GW_RAY_REFLECTED) == 0u;
    vec4 brought = radiance_of(none ? 0u : GW_ASKED_FIRST(asked));
    float roughness, share = glossy_share(id, surface, roughness);
    precise vec3 added = lit + share * environment_specular(surface, view) * changed_by(brought, radiance_around(surface, view));
    return none || share <= 0.0 ? lit : added;
}
#endif

#ifdef TRANSMISSION
// The light from everywhere, from straight on over a wide cone; unlit: without what lights stand for. These shine through what lets
// light through already (shade/shadow_ray.glsl), on what a cone or a rough lobe's ray starts from, too.
vec3 radiance_beyond(vec3 view, bool unlit) {
    vec3 ambient = frame.ambient.rgb * INVERSE_PI;
#ifdef ENVIRONMENT
#ifdef LAMPS_TWICE
    unlit = false; // the naive variant, for the test that shows why
#endif
    vec3 rest = environment_layer(environment_place(-view), 0);
    precise vec3 sum = ambient + (unlit ? rest : environment_within(-view, 0.5));
    return frame.environment.z > 0.0 ? sum : ambient;
#else
    return ambient;
#endif
}

// What a surface that lets light through reflects and lets through; for what was not asked for the light from everywhere stands. lit
// is what the rest of it sends, its part of the light from everywhere included; unlit: as above.
vec3 with_transmitted(vec3 lit, Surface surface, vec3 view, Optics optics, uint asked, bool unlit) {
    vec3 around = radiance_around(surface, view);
    uint first = GW_ASKED_FIRST(asked), kinds = GW_ASKED_KINDS(asked);
    bool reflects = (kinds & GW_RAY_REFLECTED) != 0u, refracts = (kinds & GW_RAY_REFRACTED) != 0u;
    vec3 reflected = radiance_of(reflects ? first : 0u).rgb;
    vec3 through = radiance_of(refracts ? first + (reflects ? 1u : 0u) : 0u).rgb;
    reflected = reflects ? reflected : around;
    through = refracts ? through : radiance_beyond(view, unlit);
    precise vec3 added = optics.reflectance * reflected - environment_specular(surface, view) * around +
                         (1.0 - optics.reflectance) * optics.share * tint_of(optics, surface.base_color) * through;
    return optics.sheer ? lit + added : lit;
}
#endif

#ifdef CONES
// Of light by each further bounce: white rooms would never end.
const float MOST_PASSED_ON = 0.9;

// What of the light from everywhere is covered is not there, and what the cones meet shines instead. That is covered itself: as much as
// what the cones start from, for what lies in one nook covers each other.
vec3 with_cones(vec3 lit, Surface surface, vec3 view, uint asked) {
    uint kinds = GW_ASKED_KINDS(asked);
    bool none = (kinds & GW_RAY_CONES) == 0u;
    precise vec4 sum = vec4(0.0);
    precise vec4 everywhere = vec4(0.0);
    for (uint i = 0u; i < frame.sampling.z; ++i) {
        uint number = none ? 0u : GW_ASKED_FIRST(asked) + first_cone_of(kinds) + i;
        sum += radiance_of(number);
#ifdef DIFFUSE
        everywhere += radiances[number * GW_BROUGHT_ROWS_DIFFUSE + 1u];
#endif
    }
    precise vec4 mean = sum / float(max(frame.sampling.z, 1u));
    precise vec4 uncovered = everywhere / float(max(frame.sampling.z, 1u));
    precise vec3 irradiance = vec3(0.0);
#ifdef OCCLUSION
    irradiance += (frame.sampling.w & GW_CONES_OCCLUDE) != 0u ? irradiance_around(surface) * (mean.w - 1.0) : vec3(0.0);
#endif
#ifdef DIFFUSE
    precise vec3 bounced = max(mean.rgb - uncovered.rgb * (1.0 - mean.w), vec3(0.0));
#ifdef UNCOVERED_BOUNCE
    bounced = mean.rgb; // the naive variant, for the test that shows why
#endif
    // What goes on: in one nook each bounce is the one before, times what of it is met and reflected again.
    precise float again = (frame.sampling.w & GW_CONES_ALL) != 0u ? min(uncovered.w, MOST_PASSED_ON) : 0.0;
    bounced /= 1.0 - again;
    irradiance += (frame.sampling.w & GW_CONES_LIGHT) != 0u ? bounced / INVERSE_PI : vec3(0.0);
#endif
    precise vec3 added = lit + reflect_environment(surface, view, irradiance, vec3(0.0), vec3(0.0));
    return none ? lit : added;
}
#endif

vec3 with_secondary(vec3 lit, Surface surface, vec3 view, uint id, uint fragment) {
    uint asked = asked_of[fragment];
#ifdef MIRROR
    lit = with_reflected(lit, surface, view, id, asked);
#endif
#ifdef GLOSSY
    lit = with_glossy(lit, surface, view, id, asked);
#ifdef CLEARCOAT
    lit = with_glossy_coat(lit, surface, view, id, asked);
#endif
#endif
#ifdef CONES
    lit = with_cones(lit, surface, view, asked);
#endif
    return lit;
}
