// How much of each light reaches each fragment.
#include "shade/light_list.glsl"
layout(std430, binding = 15) buffer Visibilities { uint visibilities[]; };

float visibility_at(uint place) {
    uint word = visibilities[place];
    return uintBitsToFloat((word & GW_SERVED) != 0u ? visibilities[word & ~GW_SERVED] : word);
}

#define VISIBILITY(fragment, light) visibility_at((fragment) * light_count() + (light))

#if defined(LOD) || defined(UNTIL_COARSE)
// The last ray may serve fragments of later rounds, which use its place for themselves.
void keep_visibilities(uint slot) {
    for (uint light = 0u; light < light_count(); ++light) {
        uint kept = kept_place(slot, light), last = visibilities[kept + 2u];
        if (last != GW_NO_PLACE)
            visibilities[kept] = visibilities[last];
    }
}
#endif
