// Diffuse and specular reflection: Lambert, and GGX with height-correlated Smith visibility (Heitz 2014) and Schlick's
// Fresnel term, in metalness and roughness as glTF 2.0 defines them.

struct Surface {
    vec3 position;   // rebased
    vec3 normal;     // unit, on the ray's side
    vec3 base_color; // linear
    float alpha;
    float metalness, roughness;
    vec3 emissive;   // linear radiance
    float agreement; // of the normals that this one stands for: 1 for triangles
#ifdef MATERIAL_MAPS
    float occlusion; // share of the light from everywhere that arrives
#endif
};

const float INVERSE_PI = 0.31830988618;

vec3 specular_at_normal(Surface surface) {
    return mix(vec3(0.04), surface.base_color, surface.metalness);
}

// What share the mirror-like part of a surface reflects towards `view` of light that is the same all over its lobe.
vec3 environment_specular(Surface surface, vec3 view) {
    return specular_at_normal(surface);
}

// Radiance towards `view` from light all around: irradiance about the normal; radiance as a lobe of the surface's roughness about the
// mirrored view sees it.
vec3 reflect_environment(Surface surface, vec3 view, vec3 irradiance, vec3 radiance) {
    precise vec3 reflected = irradiance * INVERSE_PI * (surface.base_color * (1.0 - surface.metalness)) +
                             radiance * environment_specular(surface, view);
#ifdef MATERIAL_MAPS
    reflected *= surface.occlusion;
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

// Radiance towards `view` from light that comes from direction `light` (both unit, away from the surface); of its highlight the share
// `highlight`.
vec3 reflect_light(Surface surface, vec3 view, vec3 light, vec3 irradiance, float highlight) {
    vec3 n = surface.normal;
    vec3 halfway = normalize(view + light);
    float n_l = max(dot(n, light), 0.0), n_v = max(dot(n, view), 1e-3);
    float n_h = clamp(dot(n, halfway), 0.0, 1.0), v_h = clamp(dot(view, halfway), 0.0, 1.0);
    float a = max(surface.roughness * surface.roughness, 2e-3), a2 = a * a;
    precise float spread = (n_h * n_h) * (a2 - 1.0) + 1.0;
    precise float distribution = a2 * INVERSE_PI / (spread * spread);
    precise float visibility = 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    vec3 f0 = specular_at_normal(surface);
    float grazing = 1.0 - v_h;
    precise float grazing2 = grazing * grazing;
    precise vec3 fresnel = f0 + (1.0 - f0) * (grazing2 * grazing2 * grazing);
    // Of a voxel's surface the share `agreement` has its normal, the rest points all ways; each is seen by its area turned to the
    // viewer, of what points all ways by 1/4.
    precise float scattered = 0.25 * (1.0 - surface.agreement);
    precise float scattered_share = scattered / (scattered + surface.agreement * n_v);
    precise float cosine = mix(n_l, cosine_of_all_ways(dot(view, light)), scattered_share);
#ifdef UNSEEN_NORMALS
    cosine = mix(0.25, n_l, surface.agreement); // the naive variant, for the test that shows why
#endif
    precise vec3 diffuse = surface.base_color * ((1.0 - surface.metalness) * INVERSE_PI * cosine);
    precise vec3 reflected = irradiance * (diffuse * (1.0 - fresnel) + fresnel * (distribution * visibility * n_l * highlight));
    return reflected;
}
