layout(binding = 7) uniform usamplerBuffer lights; // gw_gpu_light: directional ones first, then points

uint light_count() {
    return frame.counts.y + frame.counts.z;
}
