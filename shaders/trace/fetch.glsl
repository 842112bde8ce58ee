// How kernels read the octree and the triangles. Buffer textures win on llvmpipe (a storage load is a loop over lanes
// there); another device may be given other definitions of the same names by defining GW_FETCH_DEFINED.
#ifndef GW_FETCH_DEFINED
layout(binding = 0) uniform usamplerBuffer nodes;
layout(binding = 1) uniform usamplerBuffer references;
layout(binding = 2) uniform usamplerBuffer triangles;
layout(binding = 3) uniform usamplerBuffer payloads;
#define NODE(index) texelFetch(nodes, int(index)).xy
#define REFERENCE(index) texelFetch(references, int(index)).x
// k-th vertex of a triangle; w of vertex 0 holds flags.
#define TRIANGLE(id, k) texelFetch(triangles, int(id) * 3 + (k))
#define PAYLOAD(index) texelFetch(payloads, int(index)).xyz
#endif
