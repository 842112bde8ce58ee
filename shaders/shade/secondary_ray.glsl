// What secondary rays are made of: what a ray has met, and how its footprint goes on. Needs trace/pixel.glsl and
// shade/surface.glsl before it.
#include "shade/secondary_start.glsl"

struct Met {
    uint id;
    bool voxel;
    Pixel_ray ray;  // that met it
    vec3 direction; // unit, of that ray
    float width;    // of its footprint where it met this
    float growth;   // of its footprint per unit of length
    Secondary_start start;
    vec3 normal; // shading normal, unit, on the ray's side
    vec3 color;  // base colour, as far as the kernel reads it
    float metalness, passing;
};

struct Secondary_ray {
    vec3 origin, direction; // unit
    float width, growth;    // of its footprint, at the origin and per unit of length
    float tau;
    float clear; // length up to which only triangles count
    float part;  // of the fragment's light that it brings, at most
#ifdef TRANSMISSION
    uvec2 media;  // that it starts in
    uint skipped; // triangle that it comes through, or GW_NO_TRIANGLE
#endif
};

Met met_by(Pixel_ray ray, uint id, float t) {
    Met met;
    float size = length_precise(ray.direction);
    met.id = id;
    met.ray = ray;
    met.width = footprint_at(ray, t);
    met.start = secondary_start(id, t, ray.origin, ray.direction);
    met.direction = ray.direction / size;
    met.growth = ray.width / size;
#ifdef LOD
    met.voxel = met.start.own_side > 0.0;
#else
    met.voxel = false;
#endif
    Surface surface = surface_of_triangle(met.voxel ? 0u : id, t, ray.origin, ray.direction, met.width);
    met.normal = met.voxel ? met.start.normal : surface.normal;
    met.color = met.voxel ? vec3(1.0) : surface.base_color;
    met.metalness = surface.metalness;
    met.passing = passing_of(surface);
    return met;
}

// How far the normals turn over a unit of the triangle: x at most, y on the mean along its sides, positive where it bulges towards
// its front.
vec2 curvature_of(uint triangle) {
    vec2 curvature = vec2(0.0);
#ifdef SMOOTH_NORMALS
    uvec4 face = texelFetch(faces, int(triangle));
    uvec3 words = uvec3(texelFetch(vertices, int(face.x)).x, texelFetch(vertices, int(face.y)).x,
                        texelFetch(vertices, int(face.z)).x);
    for (int i = 0; i < 3; ++i) {
        int next = i == 2 ? 0 : i + 1;
        vec3 side = uintBitsToFloat(TRIANGLE(triangle, next).xyz) - uintBitsToFloat(TRIANGLE(triangle, i).xyz);
        precise vec3 turn = vertex_normal(words[next]) - vertex_normal(words[i]);
        curvature.x = max(curvature.x, length_precise(turn) / max(length_precise(side), 1e-12));
        curvature.y += dot(turn, side) / max(dot(side, side), 1e-24) * (1.0 / 3.0);
    }
    curvature = any(equal(words, uvec3(NO_NORMAL))) ? vec2(0.0) : curvature;
#ifdef FLAT_MIRRORS
    curvature.x = 0.0; // the naive variant, for the test that shows why
#endif
#endif
    return curvature;
}

// How far the normals turn over the footprint. Normals of a voxel that agree by a turn at angles of about sqrt(2 (1 - a)) from
// their mean.
float turn_over(Met met) {
    precise float turn = met.voxel ? sqrt(2.0 * (1.0 - met.start.agreement)) : curvature_of(met.id).x * met.width;
    return turn;
}
