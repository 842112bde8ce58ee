// What surfaces reflect: Lambert under GGX with height-correlated Smith visibility (Heitz, Understanding the Masking-Shadowing Function
// in Microfacet-Based BRDFs, 2014) and Schlick's Fresnel term, in metalness and roughness as glTF 2.0 defines them; over them sheen
// and clearcoat. Light that leaves a microfacet for another one is given back to the highlight by its albedo (Turquin, Practical
// Multiple Scattering Compensation for Microfacet Models, 2019), and each layer leaves to those below what it does not reflect itself
// towards the viewer: under light from everywhere nothing reflects more than arrives (tests/hard/test_furnace.c).
layout(binding = 19) uniform sampler2D albedo_table; // render/albedo_table.h: cosine's root, roughness
#ifdef SHEEN
layout(binding = 24) uniform sampler2D sheen_table;
#endif

struct Surface {
    vec3 position;   // rebased
    vec3 normal;     // unit, on the ray's side
    vec3 base_color; // linear
    float alpha;
    float metalness, roughness;
    vec3 emissive;   // linear radiance
    float agreement; // of the normals that this one stands for: 1 for triangles
    vec2 albedo;     // of white and of its grazing part, towards the viewer: see_surface()
#ifdef MATERIAL_MAPS
    float occlusion; // share of the light from everywhere that arrives
#endif
#ifdef TRANSMISSION_MAPS
    float passing;   // share of the material's transmission that is there
#endif
#ifdef SPECULAR
    vec4 dielectric; // reflectance at 0 degrees, and at 90, of what is no metal
#endif
#ifdef CLEARCOAT
    float coat, coat_roughness, coat_albedo;
    vec3 coat_normal;
#endif
#ifdef SHEEN
    vec3 sheen;
    float sheen_roughness, sheen_albedo;
#endif
#ifdef UNLIT
    float lit; // 0: it shows its base colour as it is
#endif
};

const float INVERSE_PI = 0.31830988618;
const float LEAST_ALPHA = 2e-3, LEAST_COSINE = 1e-3, LEAST_SHEEN = 0.1; // as render/albedo_table.c has them

vec3 specular_at_normal(Surface surface) {
#ifdef SPECULAR
    vec3 dielectric = surface.dielectric.rgb;
#else
    vec3 dielectric = vec3(0.04);
#endif
    return mix(dielectric, surface.base_color, surface.metalness);
}

float specular_at_edge(Surface surface) {
#ifdef SPECULAR
    precise float edge = surface.dielectric.a + (1.0 - surface.dielectric.a) * surface.metalness;
    return edge;
#else
    return 1.0;
#endif
}

vec2 table_place(float roughness, float cosine) {
    return (vec2(sqrt(clamp(cosine, 0.0, 1.0)), clamp(roughness, 0.0, 1.0)) * 31.0 + 0.5) * (1.0 / 32.0);
}

// How much more a highlight holds with light that met several microfacets.
vec3 multiple_scattering(Surface surface) {
    precise vec3 more = 1.0 + specular_at_normal(surface) * (1.0 / max(surface.albedo.x, 1e-3) - 1.0);
#ifdef SINGLE_SCATTERING
    more = vec3(1.0); // the naive variant, for the test that shows why
#endif
    return more;
}

// What share of white light from everywhere the highlights bring to the viewer.
vec3 specular_albedo(Surface surface) {
    vec3 f0 = specular_at_normal(surface);
    precise vec3 once = f0 * surface.albedo.x + (specular_at_edge(surface) - f0) * surface.albedo.y;
    return clamp(once * multiple_scattering(surface), 0.0, 1.0);
}

vec3 diffuse_share(Surface surface) {
    precise vec3 below = 1.0 - specular_albedo(surface);
#ifdef WHOLE_DIFFUSE
    below = vec3(1.0); // the naive variant, for the test that shows why
#endif
    precise vec3 share = surface.base_color * (1.0 - surface.metalness) * below;
    return share;
}

// What reaches the layers below sheen and clearcoat, there and back.
float share_below(Surface surface) {
    precise float share = 1.0;
#ifdef SHEEN
    share *= 1.0 - max(max(surface.sheen.x, surface.sheen.y), surface.sheen.z) * min(surface.sheen_albedo, 1.0);
#endif
#ifdef CLEARCOAT
    share *= 1.0 - surface.coat_albedo;
#endif
    return share;
}

// Looks up what reflecting needs to know of the view; before any of the functions below.
void see_surface(inout Surface surface, vec3 view) {
    surface.albedo = textureLod(albedo_table, table_place(surface.roughness, dot(surface.normal, view)), 0.0).rg;
#ifdef SHEEN
    surface.sheen_albedo = textureLod(sheen_table, table_place(surface.sheen_roughness, dot(surface.normal, view)), 0.0).r;
#endif
#ifdef CLEARCOAT
    vec2 coat = textureLod(albedo_table, table_place(surface.coat_roughness, dot(surface.coat_normal, view)), 0.0).rg;
    precise float albedo = surface.coat * (0.04 * coat.x + 0.96 * coat.y);
    surface.coat_albedo = albedo;
    surface.emissive *= 1.0 - albedo;
#endif
}

float occlusion_of(Surface surface) {
#ifdef MATERIAL_MAPS
    return surface.occlusion;
#else
    return 1.0;
#endif
}

float passing_of(Surface surface) {
#ifdef TRANSMISSION_MAPS
    return surface.passing;
#else
    return 1.0;
#endif
}

// Normals that one footprint or voxel mixes widen its highlight. length_of: of their mean; spread: (1 - length) / length, as Toksvig
// (Mipmapping Normal Maps, 2005) adds it to 1 / s of Phong's exponent s = 2 / alpha^2 - 2.
float spread_of(float length_of) {
    precise float spread = (1.0 - length_of) / max(length_of, 1e-3);
    return spread;
}

float widened_roughness(float roughness, float spread) {
    precise float squared = roughness * roughness * roughness * roughness; // alpha^2
    precise float more = 2.0 * max(spread, 0.0) * (1.0 - squared);
    precise float widened = (squared + more) / (1.0 + more);
    return spread <= 0.0 ? roughness : sqrt(sqrt(widened));
}

// Which share of the lights taken from the environment a surface of this roughness shows as highlights, which shadows reach: smoother
// ones mirror the picture itself.
float highlight_share(float roughness) {
    return clamp(5.0 * roughness - 1.0, 0.0, 1.0);
}

float lit_of(Surface surface) {
#ifdef UNLIT
    return surface.lit;
#else
    return 1.0;
#endif
}

// What share the mirror-like part of a surface reflects towards `view` of light that is the same all over its lobe.
vec3 environment_specular(Surface surface, vec3 view) {
    precise vec3 share = specular_albedo(surface) * (occlusion_of(surface) * lit_of(surface) * share_below(surface));
    return share;
}

// The same of its clearcoat.
float environment_coat(Surface surface) {
#ifdef CLEARCOAT
    precise float share = surface.coat_albedo * (occlusion_of(surface) * lit_of(surface));
    return share;
#else
    return 0.0;
#endif
}

// Radiance towards `view` from light all around: irradiance about the normal; radiance as a lobe of the surface's roughness about the
// mirrored view sees it, and as its clearcoat's lobe does.
vec3 reflect_environment(Surface surface, vec3 view, vec3 irradiance, vec3 radiance, vec3 coat_radiance) {
    float arriving = occlusion_of(surface) * lit_of(surface);
    precise vec3 reflected = irradiance * INVERSE_PI * (diffuse_share(surface) * (arriving * share_below(surface))) +
                             radiance * environment_specular(surface, view);
#ifdef SHEEN
    precise float over_sheen = arriving;
#ifdef CLEARCOAT
    over_sheen *= 1.0 - surface.coat_albedo;
#endif
    reflected += irradiance * INVERSE_PI * surface.sheen * (min(surface.sheen_albedo, 1.0) * over_sheen);
#endif
#ifdef CLEARCOAT
    reflected += coat_radiance * environment_coat(surface);
#endif
    return reflected;
}

// Mean of max(n.l, 0) over what a viewer sees of normals that point all ways, by the cosine between view and light: the phase
// function of spheres with Lambert's law, (2 / 3 pi) (sin a + (pi - a) cos a) (Blinn, Light Reflection Functions for Simulation of
// Clouds and Dusty Surfaces, 1982), as a polynomial in cos(a / 2), 0.0033 off at most.
float cosine_of_all_ways(float cosine) {
    precise float square = clamp(0.5 + 0.5 * cosine, 0.0, 1.0);
    precise float mean = square * sqrt(square) * (0.58041 + square * (-0.00873 + square * 0.09164));
    return mean;
}

// GGX with its visibility, times the cosine to the light.
float highlight_of(float roughness, float n_l, float n_v, float n_h) {
    float a = max(roughness * roughness, LEAST_ALPHA), a2 = a * a;
    precise float spread = (n_h * n_h) * (a2 - 1.0) + 1.0;
    precise float distribution = a2 * INVERSE_PI / (spread * spread);
    precise float visibility = 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    return distribution * visibility * n_l;
}

// (1 - cosine)^5 of Schlick's term.
float grazing_part(float cosine) {
    float grazing = 1.0 - cosine;
    precise float grazing2 = grazing * grazing;
    return grazing2 * grazing2 * grazing;
}

#ifdef SHEEN
float sheen_of(Surface surface, float n_l, float n_v, float n_h) {
    float roughness = max(surface.sheen_roughness, LEAST_SHEEN);
    precise float inverse = 1.0 / (roughness * roughness);
    precise float distribution = (2.0 + inverse) * pow(max(1.0 - n_h * n_h, 1e-6), 0.5 * inverse) * (0.5 * INVERSE_PI);
    precise float visibility = 0.25 / max(n_l + n_v - n_l * n_v, 1e-3);
    return distribution * visibility * n_l / max(surface.sheen_albedo, 1.0);
}
#endif

// Radiance towards `view` from light that comes from direction `light` (both unit, away from the surface); of its highlight the share
// highlight.x, of its clearcoat's highlight.y.
vec3 reflect_light(Surface surface, vec3 view, vec3 light, vec3 irradiance, vec2 highlight) {
    vec3 n = surface.normal;
    vec3 halfway = normalize(view + light);
    float n_l = max(dot(n, light), 0.0), n_v = max(dot(n, view), LEAST_COSINE);
    float n_h = clamp(dot(n, halfway), 0.0, 1.0), v_h = clamp(dot(view, halfway), 0.0, 1.0);
    vec3 f0 = specular_at_normal(surface);
    float grazing = grazing_part(v_h);
    precise vec3 fresnel = f0 + (specular_at_edge(surface) - f0) * grazing;
    // Of a voxel's surface the share `agreement` has its normal, the rest points all ways; each is seen by its area turned to the
    // viewer, of what points all ways by 1/4.
    precise float scattered = 0.25 * (1.0 - surface.agreement);
    precise float scattered_share = scattered / (scattered + surface.agreement * n_v);
    precise float cosine = mix(n_l, cosine_of_all_ways(dot(view, light)), scattered_share);
#ifdef UNSEEN_NORMALS
    cosine = mix(0.25, n_l, surface.agreement); // the naive variant, for the test that shows why
#endif
    precise vec3 diffuse = diffuse_share(surface) * (INVERSE_PI * cosine);
    precise vec3 mirrored = fresnel * multiple_scattering(surface) * highlight_of(surface.roughness, n_l, n_v, n_h);
    precise vec3 reflected = (diffuse + mirrored * highlight.x) * share_below(surface);
#ifdef SHEEN
    precise vec3 sheen = surface.sheen * sheen_of(surface, n_l, n_v, n_h);
#ifdef CLEARCOAT
    sheen *= 1.0 - surface.coat_albedo;
#endif
    reflected += sheen;
#endif
#ifdef CLEARCOAT
    float c_l = max(dot(surface.coat_normal, light), 0.0), c_v = max(dot(surface.coat_normal, view), LEAST_COSINE);
    float c_h = clamp(dot(surface.coat_normal, halfway), 0.0, 1.0);
    precise float coat = surface.coat * (0.04 + 0.96 * grazing) * highlight_of(surface.coat_roughness, c_l, c_v, c_h);
    reflected += coat * highlight.y;
#endif
    return irradiance * reflected * lit_of(surface);
}
