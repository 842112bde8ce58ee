// Rasterised voxeliser, stage 1: the triangles' vertices as they stand, in the root cube [-1,1]^3.
#include "build/voxelise.glsl"

layout(binding = 0) uniform samplerBuffer triangle_texels;

layout(location = 0) out vec3 at;

void main() {
    at = texelFetch(triangle_texels, int(triangle_first) * 3 + gl_VertexID).xyz;
}
