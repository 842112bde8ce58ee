layout(binding = 7) uniform usamplerBuffer lights; // gw_gpu_light: directional ones first, then those with a place; gw_emissive_slot

uint light_count() {
    return frame.counts.y + frame.counts.z;
}

vec4 light_row(uint light, int row) {
    return uintBitsToFloat(texelFetch(lights, int(light) * GW_LIGHT_ROWS + row));
}

// What a cone and a range leave of a light with a place, seen along the unit direction `towards` from `metres` away
// (KHR_lights_punctual).
float share_of_light(uint light, vec3 towards, float metres) {
#if defined(SPOT_LIGHTS) || defined(EMISSIVE_LIGHTS)
#ifdef SPOT_LIGHTS
    vec4 shape = light_row(light, 3);
    precise float cone = clamp(shape.y - shape.x * dot(light_row(light, 2).xyz, towards), 0.0, 1.0);
#else
    const float cone = 1.0;
#endif
    precise float squared = metres * metres * light_row(light, 1).w;
    precise float share = cone * cone * max(1.0 - squared * squared, 0.0);
    return share;
#else
    return 1.0;
#endif
}

#if defined(LOD) || defined(UNTIL_COARSE)
layout(location = 3) uniform uint kept_begin; // behind the visibilities of all fragments

// With SHADOWS, GW_KEPT_WORDS for each ray and light: visibility of the last shadow ray of earlier rounds, or GW_NO_PLACE; t from
// which the last one left; the place of the last one of this round, or GW_NO_PLACE.
uint kept_place(uint slot, uint light) {
    return kept_begin + (slot * light_count() + light) * GW_KEPT_WORDS;
}
#endif
