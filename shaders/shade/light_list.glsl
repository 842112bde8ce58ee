layout(binding = 7) uniform usamplerBuffer lights; // gw_gpu_light: directional ones first, then points

uint light_count() {
    return frame.counts.y + frame.counts.z;
}

#if defined(LOD) || defined(UNTIL_COARSE)
layout(location = 3) uniform uint kept_begin; // behind the visibilities of all fragments

// With SHADOWS, GW_KEPT_WORDS for each ray and light: visibility of the last shadow ray of earlier rounds, or GW_NO_PLACE; t from
// which the last one left; the place of the last one of this round, or GW_NO_PLACE.
uint kept_place(uint slot, uint light) {
    return kept_begin + (slot * light_count() + light) * GW_KEPT_WORDS;
}
#endif
