// For every fragment: its colour enters its leaf's running mean, whose count stands in alpha (Crassin and Green 2012), its
// normal the leaf's sum. Without float atomics, which OpenGL lacks, a sum is a loop of compare-and-swap as well.
#include "build/splat.glsl"

void add_normal(uint word, float value) {
    uint seen = voxels[word];
    for (;;) {
        uint was = atomicCompSwap(voxels[word], seen, floatBitsToUint(uintBitsToFloat(seen) + value));
        if (was == seen)
            return;
        seen = was;
    }
}

void add_color(uint word, vec3 color) {
    uint seen = 0u;
    for (;;) {
        vec4 mean = unpackUnorm4x8(seen) * 255.0;
        float count = min(mean.a, 254.0);
        vec3 now = (mean.rgb * count + color) / (count + 1.0);
        uint was = atomicCompSwap(voxels[word], seen, packUnorm4x8(vec4(now, count + 1.0) / 255.0));
        if (was == seen)
            return;
        seen = was;
    }
}

void main() {
    uint i = invocation();
    if (i >= fragment_count)
        return;
    uint at;
    uint node = find_node(fragments[i * FRAGMENT_WORDS], depth, at);
    uint begin = i * FRAGMENT_WORDS;
    add_color(node * 4u, unpackUnorm4x8(fragments[begin + 2u]).rgb * 255.0);
    for (uint k = 0u; k < 3u; ++k)
        add_normal(node * 4u + 1u + k, uintBitsToFloat(fragments[begin + 3u + k]));
}
