// What a ray sees that meets nothing, and the light from everywhere: the same all around, or by direction with ENVIRONMENT. Needs
// trace/pixel.glsl and shade/surface.glsl before it.

#ifdef ENVIRONMENT
layout(binding = 20) uniform sampler2D environment_seen;            // radiance by direction, as render/environment.h says
layout(binding = 21) uniform sampler2DArray environment_blurred;    // of what no light stands for, GW_ENVIRONMENT_LAYERS

vec2 environment_place(vec3 direction) {
    bool upright = abs(direction.x) + abs(direction.z) <= 0.0;
    precise float turn = atan(direction.x, upright ? 1.0 : -direction.z);
    precise float down = acos(clamp(direction.y, -1.0, 1.0));
    return vec2(turn * (0.5 * INVERSE_PI) + 0.5 - frame.environment.x, down * INVERSE_PI);
}

// Mean radiance over so wide a cone about a unit direction.
vec3 environment_within(vec3 direction, float angle) {
    return textureLod(environment_seen, environment_place(direction), log2(max(angle * frame.environment.y, 1.0))).rgb;
}

vec3 environment_layer(vec2 place, int layer) {
    return textureLod(environment_blurred, vec3(place, float(layer)), 0.0).rgb;
}
#endif

// What a ray sees that meets nothing; unlit: without what lights stand for, which bring it where the ray comes from.
vec3 radiance_behind(Pixel_ray ray, bool unlit) {
#ifdef ENVIRONMENT
    float size = length_precise(ray.direction);
    vec3 rest = environment_layer(environment_place(ray.direction / size), 0);
    vec3 seen = unlit ? rest : environment_within(ray.direction / size, ray.width / size);
    return frame.environment.z > 0.0 ? seen : frame.background.rgb;
#else
    return frame.background.rgb;
#endif
}

// Light from everywhere on a surface; of a voxel what has no normal takes the mean.
vec3 irradiance_around(Surface surface) {
#ifdef ENVIRONMENT
    vec3 facing = environment_layer(environment_place(surface.normal), GW_ENVIRONMENT_LAYERS - 1);
    precise vec3 sum = frame.ambient.rgb + mix(frame.environment_mean.rgb, facing, surface.agreement) * (1.0 / INVERSE_PI);
    return frame.environment.z > 0.0 ? sum : frame.ambient.rgb;
#else
    return frame.ambient.rgb;
#endif
}

// What a roughness makes of it about the view that a normal mirrors: up to 0.2 the picture over a cone as wide as the lobe, from 0.4 on
// what is blurred for it, in between both.
vec3 radiance_of_lobe(vec3 normal, float roughness, vec3 view) {
    vec3 ambient = frame.ambient.rgb * INVERSE_PI;
#ifdef ENVIRONMENT
    precise vec3 mirrored = normal * (2.0 * dot(normal, view)) - view;
    vec3 sharp = environment_within(mirrored, 2.5 * roughness * roughness);
    float layer = clamp(roughness - 0.4, 0.0, 0.6) * 5.0;
    int lower = min(int(layer), GW_ENVIRONMENT_LAYERS - 3);
    vec2 place = environment_place(mirrored);
    vec3 blurred = mix(environment_layer(place, lower), environment_layer(place, lower + 1), layer - float(lower));
    precise vec3 sum = ambient + mix(sharp, blurred, highlight_share(roughness));
    return frame.environment.z > 0.0 ? sum : ambient;
#else
    return ambient;
#endif
}

vec3 radiance_around(Surface surface, vec3 view) {
    return radiance_of_lobe(surface.normal, surface.roughness, view);
}

// As the surface's clearcoat sees it.
vec3 radiance_around_coat(Surface surface, vec3 view) {
#ifndef CLEARCOAT
    return vec3(0.0);
#elif defined(COAT_AS_BASE)
    return radiance_around(surface, view); // the naive variant, for the test that shows why
#else
    return radiance_of_lobe(surface.coat_normal, surface.coat_roughness, view);
#endif
}
