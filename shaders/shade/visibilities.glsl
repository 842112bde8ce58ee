// How much of each light reaches each fragment.
#include "shade/light_list.glsl"
layout(std430, binding = 15) buffer Visibilities { uint visibilities[]; };

#ifdef TRANSMISSION
// As trace/shadow.comp has left it, where the ray to the light went through.
vec3 visibility_at(uint place) {
    uint word = visibilities[place];
    uint from = (word & GW_SERVED) != 0u ? word & ~GW_SERVED : place;
    float visibility = uintBitsToFloat(visibilities[from]);
    uint word_of_colors = visibilities[from + uint(visibilities.length()) / 2u];
    uvec3 code = uvec3(word_of_colors, word_of_colors >> 10, word_of_colors >> 20) & 1023u;
    vec3 root = mix(vec3(code) * (1.0 / 1023.0), vec3(1.0), equal(code, uvec3(1023u))); // white is exact
    precise vec3 seen = visibility * (root * root);
    return seen;
}
#else
float visibility_at(uint place) {
    uint word = visibilities[place];
    return uintBitsToFloat((word & GW_SERVED) != 0u ? visibilities[word & ~GW_SERVED] : word);
}
#endif

#define VISIBILITY(fragment, light) visibility_at((fragment) * light_count() + (light))

#if defined(LOD) || defined(UNTIL_COARSE)
// The last ray may serve fragments of later rounds, which use its place for themselves.
void keep_visibilities(uint slot) {
    for (uint light = 0u; light < light_count(); ++light) {
        uint kept = kept_place(slot, light), last = visibilities[kept + 2u];
        if (last == GW_NO_PLACE)
            continue;
        visibilities[kept] = visibilities[last];
#ifdef TRANSMISSION
        uint colors = uint(visibilities.length()) / 2u;
        visibilities[kept + colors] = visibilities[last + colors];
#endif
    }
}
#endif
