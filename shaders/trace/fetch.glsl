// How kernels read the octree and the triangles. Buffer textures win on llvmpipe (a storage load is a loop over lanes
// there), STORAGE_FETCH reads storage blocks instead; other definitions of the same names come in by defining
// GW_FETCH_DEFINED.
#if defined(STORAGE_FETCH)
layout(std430, binding = 11) readonly buffer Nodes { uvec2 nodes[]; };
layout(std430, binding = 12) readonly buffer References { uint references[]; };
layout(std430, binding = 13) readonly buffer Triangles { uvec4 triangles[]; };
#define NODE(index) nodes[index]
#define NODES_END uint(nodes.length())
#define REFERENCE(index) references[index]
#define TRIANGLE(id, k) triangles[(id) * 3u + uint(k)]
#elif !defined(GW_FETCH_DEFINED)
layout(binding = 0) uniform usamplerBuffer nodes;
layout(binding = 1) uniform usamplerBuffer references;
layout(binding = 2) uniform usamplerBuffer triangles;
layout(binding = 3) uniform usamplerBuffer payloads;
#define NODES_END uint(textureSize(nodes))
#ifdef CHECK_FETCHES
// Nothing is read beyond the end of a buffer, and what would have been is reported: how often, and the least index of each.
layout(std430, binding = 29) buffer Out_of_range { uint out_of_range[GW_RANGE_WORDS]; };
int in_range(uint index, int end, int which) {
    bool inside = index < uint(end);
    if (!inside) {
        atomicAdd(out_of_range[0], 1u);
        atomicMin(out_of_range[1 + which], index);
    }
    return inside ? int(index) : 0;
}
#else
#define in_range(index, end, which) int(index)
#endif
#define NODE(index) texelFetch(nodes, in_range(uint(index), textureSize(nodes), 0)).xy
#define REFERENCE(index) texelFetch(references, in_range(uint(index), textureSize(references), 1)).x
// k-th vertex of a triangle; w of vertex 0 holds flags.
#define TRIANGLE(id, k) texelFetch(triangles, in_range(uint(id), textureSize(triangles) / 3, 2) * 3 + (k))
#define PAYLOAD(index) texelFetch(payloads, in_range(uint(index), textureSize(payloads), 3)).xyz
#ifdef DENSE_LEAVES
layout(binding = 13) uniform usamplerBuffer boxes;
#define BOX(index, k) texelFetch(boxes, in_range(uint(index), textureSize(boxes) / 2, 4) * 2 + (k))
#endif
#endif
