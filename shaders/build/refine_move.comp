// Kernel 6: pairs of inner children become the next level's pairs, those of list leaves references.
#include "build/refine.glsl"
#include "build/refine_slots.glsl"

layout(std430, binding = 6) readonly buffer PairsOut { uvec2 pairs_out[]; };
layout(std430, binding = 7) readonly buffer Classes { uint classes[]; };
layout(std430, binding = 13) readonly buffer Targets { uvec2 targets[]; };
layout(std430, binding = 14) writeonly buffer PairsNext { uvec2 pairs_next[]; };
layout(std430, binding = 15) writeonly buffer References { uint references[]; };

void main() {
    uint index = group_index() * 64u + gl_LocalInvocationIndex;
    if (index >= out_count)
        return;
    uvec2 pair = pairs_out[index];
    uint kind = classes[pair.y] & 0xfu;
    uint within = index - slot_begin(pair.y >> 3, pair.y & 7u);
    uvec2 target = targets[pair.y];
    if (kind == GW_KIND_INNER)
        pairs_next[target.x + within] = uvec2(pair.x, target.y);
    else if (kind == GW_LEAF_LIST) {
        bool last = within + 1u == slot_count(pair.y >> 3, pair.y & 7u);
        references[target.x + within] = pair.x | (last ? GW_REFERENCE_LAST : 0u);
    }
}
