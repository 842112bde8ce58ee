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
};

const float INVERSE_PI = 0.31830988618;

vec3 specular_at_normal(Surface surface) {
    return mix(vec3(0.04), surface.base_color, surface.metalness);
}

vec3 reflect_ambient(Surface surface, vec3 irradiance) {
    precise vec3 reflected = irradiance * INVERSE_PI *
                             (surface.base_color * (1.0 - surface.metalness) + specular_at_normal(surface));
    return reflected;
}

// Radiance towards `view` from light that comes from direction `light` (both unit, away from the surface).
vec3 reflect_light(Surface surface, vec3 view, vec3 light, vec3 irradiance) {
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
    // Where normals point all ways, 1/4 is the mean of max(n.l, 0) over them.
    precise float cosine = mix(0.25, n_l, surface.agreement);
    precise vec3 diffuse = surface.base_color * ((1.0 - surface.metalness) * INVERSE_PI * cosine);
    precise vec3 reflected = irradiance * (diffuse * (1.0 - fresnel) + fresnel * (distribution * visibility * n_l));
    return reflected;
}
