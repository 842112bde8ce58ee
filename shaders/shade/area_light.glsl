// Points of lights that have an extent. Each such light is several rows of the list, which share its light; a row stands for one of
// equal parts of its directions, its area or its power, at a place that differs from pixel to pixel by a fixed pattern on the wall, and
// from sample to sample of a still view. Needs trace/fetch.glsl, trace/pixel.glsl and shade/light_list.glsl before it.
#if defined(AREA_LIGHTS) || defined(EMISSIVE_LIGHTS)
#define WIDE_LIGHTS 1
#endif
#ifdef WIDE_LIGHTS
#include "common/surface_offset.glsl"
#endif

struct Light_point {
    vec3 towards;   // rebased, to the point; of a directional light unit length
    float distance; // rebased, by which its light falls
    vec3 share;     // of the row's light
    float angle;    // half as wide as what the point stands for looks from here, of emissive surfaces
};

#ifdef WIDE_LIGHTS
uvec2 light_seed;

// Multiples of the powers of the root of g^4 = g + 1, modulo 1 in 32 bits, fill the square evenly over rows and columns of pixels (Roberts,
// The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
void seed_lights(Pixel_square square, Pixel_ray ray) {
#ifdef REFLECTED
    uvec2 at = floatBitsToUint(ray.direction.xz) * 0x9e3779b1u;
#else
    uvec2 at = uvec2(square.first);
#endif
    light_seed = uvec2(at.x * 0xd1b54a32u + at.y * 0xabc98388u, at.x * 0x8cb92ba7u + at.y * 0xc13fa9a9u);
#if defined(SPARSE) && !defined(REFLECTED) && !defined(LIKE_THE_FIRST)
    light_seed += square.which * uvec2(0xc13fa9a9u, 0x91e10da5u); // rays of one square: the same in two dimensions
#endif
}

// How far the light's places are moved here, 0..1.
vec2 moved_places(uint light, float part) {
    uint number = light - uint(part);
    uvec2 turned = light_seed + number * uvec2(0x9e3779b9u, 0x7f4a7c15u);
    float drawn = floor(1.0 / frame.accumulation.z - 0.5); // number of the sample of a still view
    precise vec2 moved = vec2(turned >> 8) * (1.0 / 16777216.0) + drawn * vec2(0.6287067, 0.5385969);
#ifdef LIGHT_MIDDLES
    moved = vec2(0.5); // the naive variant, for the test that shows why
#endif
    return moved;
}

// 0..1 in both directions, within this row's part of the light.
vec2 place_in_light(uint light, float part, float parts) {
    float side = parts > 4.0 ? 4.0 : parts > 1.0 ? 2.0 : 1.0;
    float row = floor(part / side);
    precise vec2 place = (vec2(part - side * row, row) + fract(moved_places(light, part))) / side;
    return place;
}
#endif

#ifdef EMISSIVE_LIGHTS
bool is_emissive(uint light) {
    return light_row(light, 4).w == GW_LIGHT_EMISSIVE;
}

// A place of emissive triangles, by power. It lies as far off its triangle as a ray's origin, so that the triangle is not in the way. A
// part does not look larger than half of all directions. For what is not emissive anything is brought.
Light_point point_of_emissive(uint light, bool emissive, vec3 from, float part, float parts) {
    precise vec2 moved = moved_places(light, part) + vec2(0.0, 0.618034 * part);
    precise float along = (part + fract(moved.x)) / parts;
    uvec2 slots = emissive ? texelFetch(lights, int(light) * GW_LIGHT_ROWS + 4).xy : uvec2(0u, 1u);
    precise float at = along * float(slots.y);
    uint slot = min(uint(at), slots.y - 1u);
    int texel = int(slots.x + slot * uint(GW_EMISSIVE_ROWS));
    uvec4 words = texelFetch(lights, texel);
    vec4 light_here = uintBitsToFloat(texelFetch(lights, texel + 1));
    uint triangle = emissive ? words.x : 0u;
    vec3 a = uintBitsToFloat(TRIANGLE(triangle, 0).xyz);
    precise vec3 ab = uintBitsToFloat(TRIANGLE(triangle, 1).xyz) - a, ac = uintBitsToFloat(TRIANGLE(triangle, 2).xyz) - a;
    precise float covered = uintBitsToFloat(words.z) + (at - float(slot)) * uintBitsToFloat(words.w);
    precise float root = sqrt(clamp(covered, 0.0, 1.0));
    precise float side = root * fract(moved.y);
    precise vec3 place = a + ab * (root - side) + ac * side;
    precise vec3 normal = cross(ab, ac);
    float doubled_area = length_precise(normal);
    vec3 unit = doubled_area > 0.0 ? normal / doubled_area : vec3(0.0);
#ifdef EMISSIVE_MIDDLES
    place = light_row(light, 0).xyz; // the naive variant, for the test that shows why
#endif
    precise vec3 towards = place - from;
    float far = max(length_precise(towards), 1e-12);
    precise float facing = -dot(unit, towards) / far;
    bool shines = facing > 0.0 || (words.y & GW_EMITS_BOTH_WAYS) != 0u;
    precise float area = light_here.w / parts, squared = far * far;
    precise vec3 share = light_here.rgb * (shines ? abs(facing) * squared / max(squared, area * 0.1591549) : 0.0);
    precise vec3 met = offset_from_surface(place, facing < 0.0 ? -unit : unit) - from;
#ifdef ON_THE_EMITTER
    met = towards; // the naive variant, for the test that shows why
#endif
    return Light_point(met, far, share, 0.5 * sqrt(area * 0.3183099) / far);
}
#endif

#ifdef AREA_LIGHTS
// A direction of the cone about a unit one, evenly by solid angle; its cosine is 1 - depth.
vec3 within_cone(vec3 axis, float depth, float turn) {
    // Frisvad's basis as Duff et al. have it (Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017).
    float side = axis.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (side + axis.z), b = axis.x * axis.y * a;
    vec3 u = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x), v = vec3(b, side + axis.y * axis.y * a, -axis.y);
    float across = sqrt(max(depth * (2.0 - depth), 0.0)), angle = 6.28318530718 * turn;
    precise vec3 direction = axis * (1.0 - depth) + across * (cos(angle) * u + sin(angle) * v);
    return direction;
}

// A sphere: of its cap that is seen from here, which gives E = I / d^2 to a surface that faces it.
Light_point point_of_sphere(vec3 towards, float radius, vec2 place) {
    float far = max(length_precise(towards), 1e-12);
    float sine = min(radius / far, 1.0);
    precise float depth = sine * sine / (1.0 + sqrt(max(1.0 - sine * sine, 0.0))); // of the whole cap
    precise float here = depth * place.x;
    precise float cosine = 1.0 - here;
    precise float inside = radius * radius - far * far * here * (2.0 - here);
    precise float near = max(far * cosine - sqrt(max(inside, 0.0)), 1e-3 * far);
    return Light_point(within_cone(towards / far, here, place.y) * near, max(far, radius), vec3(1.0 / (1.0 - 0.5 * depth)), 0.0);
}

// Its points lie off its plane as those of emissive triangles: it may be a lamp's own, or a ceiling's.
Light_point point_of_rectangle(vec3 from, vec3 middle, vec3 u, vec3 v, vec2 place) {
    precise vec3 point = middle + (place.x - 0.5) * u + (place.y - 0.5) * v;
    precise vec3 to_point = point - from;
    vec3 unit = normalize(cross(u, v));
    float far = max(length_precise(to_point), 1e-12);
    precise vec3 met = offset_from_surface(point, unit) - from;
#ifdef ON_THE_EMITTER
    met = to_point; // the naive variant, for the test that shows why
#endif
    return Light_point(met, far, vec3(max(-dot(unit, to_point) / far, 0.0)), 0.0);
}
#endif

#ifndef WIDE_LIGHTS
void seed_lights(Pixel_square square, Pixel_ray ray) {
}
#endif

Light_point point_of_light(uint light, vec3 from) {
    bool placed = light >= frame.counts.y;
    vec3 vector = light_row(light, 0).xyz;
    vec3 towards = placed ? vector - from : vector;
    Light_point hard = Light_point(towards, placed ? length_precise(towards) : 1.0, vec3(1.0), 0.0);
#ifdef WIDE_LIGHTS
    vec4 shape = light_row(light, 3);
#endif
#ifdef AREA_LIGHTS
    vec4 u = light_row(light, 2), v = light_row(light, 4);
    vec2 place = place_in_light(light, shape.z, max(shape.w, 1.0));
    Light_point wide = point_of_sphere(towards, u.w, place);
    if (!placed)
        wide = Light_point(within_cone(vector, u.w * place.x, place.y), 1.0, vec3(1.0), 0.0);
    if (v.w > 0.0)
        wide = point_of_rectangle(from, vector, u.xyz, v.xyz, place);
    if (u.w > 0.0 || v.w > 0.0)
        hard = wide;
#endif
#ifdef EMISSIVE_LIGHTS
    bool emissive = is_emissive(light);
    Light_point shining = point_of_emissive(light, emissive, from, shape.z, max(shape.w, 1.0));
    if (emissive)
        hard = shining;
#endif
    return hard;
}
