// At the finest level, for every fragment in a marked node: counts it (FILL=0), or puts its triangle into the node's list and
// counts down (FILL=1).
// variants: FILL=0; FILL=1
#include "build/splat.glsl"

void main() {
    uint i = invocation();
    if (i >= fragment_count)
        return;
    uint at;
    uint node = find_node(fragments[i * FRAGMENT_WORDS], depth, at);
    if (at != depth || (nodes[node * 2u] & GW_SPLAT_SPLIT) == 0u)
        return;
#if FILL
    uint left = atomicAdd(nodes[node * 2u + 1u], 0xffffffffu);
    lists[offsets[node - node_first] + left - 1u] = fragments[i * FRAGMENT_WORDS + 6u];
#else
    atomicAdd(nodes[node * 2u + 1u], 1u);
#endif
}
