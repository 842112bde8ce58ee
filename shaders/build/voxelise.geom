// Rasterised voxeliser, stage 2: turns the triangle towards its dominant axis and enlarges it so that every pixel it touches
// has its centre inside (Hasselgren, Akenine-Moeller, Ohlsson 2005, GPU Gems 2, chapter 42: each edge moves outwards by half a
// pixel's reach, the corners are where moved edges meet; the box round the triangle cuts what sticks out at sharp corners).
// variants: ENLARGE=1; ENLARGE=0
#include "build/voxelise.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) in vec3 at[];
layout(location = 0) noperspective out float depth; // along the dominant axis, in voxels
layout(location = 1) flat out vec4 box;             // in pixels: low, high
layout(location = 2) flat out vec2 reach;           // least and greatest depth of the triangle itself
layout(location = 3) flat out vec3 normal;          // unit
layout(location = 4) flat out int axis;
layout(location = 5) flat out uint triangle;

// Where the moved edges through (p, direction e) and (q, direction f) meet.
vec2 meeting(vec2 p, vec2 e, vec2 q, vec2 f) {
    vec2 outwards_e = vec2(e.y, -e.x);
    vec2 outwards_f = vec2(f.y, -f.x);
    float c = dot(outwards_e, p) + 0.5 * (abs(e.x) + abs(e.y));
    float d = dot(outwards_f, q) + 0.5 * (abs(f.x) + abs(f.y));
    float area = outwards_e.x * outwards_f.y - outwards_e.y * outwards_f.x;
    return vec2(c * outwards_f.y - d * outwards_e.y, outwards_e.x * d - outwards_f.x * c) / area;
}

void main() {
    vec3 across = cross(at[1] - at[0], at[2] - at[0]);
    vec3 size = abs(across);
    axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    normal = normalize(across);
    triangle = triangle_first + uint(gl_PrimitiveIDIn);
    float scale = 0.5 * float(resolution);
    vec3 p[3];
    for (int i = 0; i < 3; ++i)
        p[i] = turn(at[i] + 1.0, axis) * scale;
    vec3 facing = turn(across, axis);
    if (facing.z < 0.0) { // clockwise as drawn
        vec3 swapped = p[1];
        p[1] = p[2];
        p[2] = swapped;
    }
    box = vec4(min(min(p[0].xy, p[1].xy), p[2].xy) - 0.5, max(max(p[0].xy, p[1].xy), p[2].xy) + 0.5);
    reach = vec2(min(min(p[0].z, p[1].z), p[2].z), max(max(p[0].z, p[1].z), p[2].z));
    vec4 held_box = box;
    vec2 held_reach = reach;
    vec3 held_normal = normal;
    int held_axis = axis;
    uint held_triangle = triangle;
    for (int i = 0; i < 3; ++i) {
        vec2 corner = p[i].xy;
#if ENLARGE
        vec2 before = p[(i + 2) % 3].xy;
        vec2 after = p[(i + 1) % 3].xy;
        corner = meeting(before, p[i].xy - before, p[i].xy, after - p[i].xy);
#endif
        depth = p[0].z - (facing.x * (corner.x - p[0].x) + facing.y * (corner.y - p[0].y)) / facing.z;
        box = held_box; // outputs are undefined after EmitVertex
        reach = held_reach;
        normal = held_normal;
        axis = held_axis;
        triangle = held_triangle;
        gl_Position = vec4(corner / scale - 1.0, 0.0, 1.0);
        EmitVertex();
    }
    EndPrimitive();
}
