// What is left of light after a way through a medium, in rebased units (Beer and Lambert).
vec3 left_of_light(uvec2 media, float way) {
#ifdef ABSORPTION
    uint medium = innermost_medium(media);
    vec3 absorption = extension_row(max(medium, 1u) - 1u, GW_EXTENSION_ATTENUATION).rgb;
    precise vec3 depth = absorption * max(way, 0.0);
    precise vec3 left = exp(-min(depth, vec3(80.0)));
    return medium == 0u ? vec3(1.0) : left;
#else
    return vec3(1.0);
#endif
}
