// Top-down, for every node of the level: a marked one gets eight children, one with two triangles a pair. At the finest level
// marked ones wait for their lists, with a count of zero.
#include "build/splat.glsl"

void main() {
    uint i = invocation();
    if (i >= node_count)
        return;
    uint node = node_first + i;
    uint first = nodes[node * 2u];
    uint second = nodes[node * 2u + 1u];
    if ((first & GW_SPLAT_SPLIT) != 0u) {
        if (level == depth) {
            nodes[node * 2u + 1u] = 0u;
            return;
        }
        uint child = atomicAdd(counters[0], 8u);
        nodes[node * 2u] = GW_SPLAT_INNER | child;
        if (child + 8u <= capacity)
            for (uint k = 0u; k < 16u; ++k)
                nodes[child * 2u + k] = GW_SPLAT_NONE;
    } else if (second != GW_SPLAT_NONE) {
        uint pair = atomicAdd(counters[1], 2u);
        pairs[pair] = first;
        pairs[pair + 1u] = second;
        nodes[node * 2u] = triangle_count + pair;
    }
}
