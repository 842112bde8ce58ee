// Top-down, for every fragment: its triangle goes into the node's two words; a third triangle marks the node.
#include "build/splat.glsl"

void main() {
    uint i = invocation();
    if (i >= fragment_count)
        return;
    uint triangle = fragments[i * FRAGMENT_WORDS + 6u];
    uint at;
    uint node = find_node(fragments[i * FRAGMENT_WORDS], level, at);
    if (at != level)
        return;
    uint first = atomicCompSwap(nodes[node * 2u], GW_SPLAT_NONE, triangle) & GW_SPLAT_INDEX;
    if (first == GW_SPLAT_NONE || first == triangle)
        return;
    uint second = atomicCompSwap(nodes[node * 2u + 1u], GW_SPLAT_NONE, triangle);
    if (second == GW_SPLAT_NONE || second == triangle)
        return;
    atomicOr(nodes[node * 2u], GW_SPLAT_SPLIT);
}
