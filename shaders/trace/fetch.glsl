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
#define NODE(index) texelFetch(nodes, int(index)).xy
#define NODES_END uint(textureSize(nodes))
#define REFERENCE(index) texelFetch(references, int(index)).x
// k-th vertex of a triangle; w of vertex 0 holds flags.
#define TRIANGLE(id, k) texelFetch(triangles, int(id) * 3 + (k))
#define PAYLOAD(index) texelFetch(payloads, int(index)).xyz
#ifdef DENSE_LEAVES
layout(binding = 13) uniform usamplerBuffer boxes;
#define BOX(index, k) texelFetch(boxes, int(index) * 2 + (k))
#endif
#endif
