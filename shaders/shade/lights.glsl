// Light from everything that shines on a surface, without shadows.
layout(binding = 7) uniform usamplerBuffer lights; // gw_gpu_light: directional ones first, then points

vec3 light_surface(Surface surface, vec3 view) {
    precise vec3 radiance = surface.emissive + reflect_ambient(surface, frame.ambient.rgb);
#ifdef DIRECTIONAL_LIGHTS
    for (uint i = 0u; i < frame.counts.y; ++i) {
        vec3 towards = uintBitsToFloat(texelFetch(lights, int(i) * 2).xyz);
        vec3 irradiance = uintBitsToFloat(texelFetch(lights, int(i) * 2 + 1).xyz);
        radiance += reflect_light(surface, view, towards, irradiance);
    }
#endif
#ifdef POINT_LIGHTS
    for (uint i = frame.counts.y; i < frame.counts.y + frame.counts.z; ++i) {
        vec3 to_light = uintBitsToFloat(texelFetch(lights, int(i) * 2).xyz) - surface.position;
        vec3 intensity = uintBitsToFloat(texelFetch(lights, int(i) * 2 + 1).xyz);
        float rebased = max(length_precise(to_light), 1e-12);
        precise float metres = max(rebased * frame.eye.w, 1e-3);
        radiance += reflect_light(surface, view, to_light / rebased, intensity / (metres * metres));
    }
#endif
    return radiance;
}
