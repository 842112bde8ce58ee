// Kernel 6: pairs of inner children become the next level's pairs, those of list leaves references.
#include "build/refine.glsl"

layout(binding = 3) uniform usamplerBuffer pair_texels;   // of all children
layout(binding = 4) uniform usamplerBuffer target_texels; // per slot, see refine_emit.comp

layout(std430, binding = 14) writeonly buffer PairsNext { uvec2 pairs_next[]; };
layout(std430, binding = 15) writeonly buffer References { uint references[]; };

void main() {
    uint index = group_index() * 64u + gl_LocalInvocationIndex;
    if (index >= out_count)
        return;
    uvec2 pair = texelFetch(pair_texels, int(index)).xy;
    uvec4 target = texelFetch(target_texels, int(pair.y));
    if (target.w == GW_KIND_INNER)
        pairs_next[index + target.x] = uvec2(pair.x, target.y);
    else if (target.w == GW_LEAF_LIST)
        references[index + target.x] = pair.x | (index + 1u == target.z ? GW_REFERENCE_LAST : 0u);
}
