// Bottom-up, for every inner node of the level: the plain mean of its children that have something; normals of unit length.
// What the children's normals add up to may be nothing; then the last one stays.
#include "build/splat.glsl"

void main() {
    uint i = invocation();
    if (i >= node_count)
        return;
    uint node = node_first + i;
    if ((nodes[node * 2u] & GW_SPLAT_INNER) == 0u)
        return;
    uint child = nodes[node * 2u] & GW_SPLAT_INDEX;
    vec3 color = vec3(0.0);
    vec3 normal = vec3(0.0);
    vec3 last = vec3(0.0, 0.0, 1.0);
    float count = 0.0;
    for (uint k = 0u; k < 8u; ++k) {
        uint word = (child + k) * 4u;
        vec4 own = unpackUnorm4x8(voxels[word]);
        vec3 sum = uintBitsToFloat(uvec3(voxels[word + 1u], voxels[word + 2u], voxels[word + 3u]));
        float size = length(sum);
        if (own.a > 0.0) {
            color += own.rgb;
            count += 1.0;
            last = size > 0.0 ? sum / size : last;
            normal += size > 0.0 ? sum / size : vec3(0.0);
        }
    }
    float size = length(normal);
    normal = size > 0.0 ? normal / size : last;
    voxels[node * 4u] = packUnorm4x8(vec4(color / max(count, 1.0), 1.0));
    for (uint k = 0u; k < 3u; ++k)
        voxels[node * 4u + 1u + k] = floatBitsToUint(normal[k]);
}
