// At the finest level, for every marked node: it becomes a leaf with a list, whose last entry carries a flag.
#include "build/splat.glsl"

void main() {
    uint i = invocation();
    if (i >= node_count)
        return;
    uint node = node_first + i;
    if ((nodes[node * 2u] & GW_SPLAT_SPLIT) == 0u)
        return;
    nodes[node * 2u] = triangle_count + pair_count + offsets[i];
    lists[offsets[i + 1u] - 1u] |= 0x80000000u;
}
