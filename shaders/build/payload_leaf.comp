// Sums of leaves: every triangle of the list adds the area of its part in the cell, its colour at the part's centroid
// through the mip level of the part's area, and its normal.
//
// The part is convex; its boundary is made of the triangle's edges inside the cell and, on each face, of the segment in which
// the face's plane cuts the triangle. Area and centroid are integrals along that boundary, so no polygon is ever stored
// (measured on llvmpipe against Sutherland-Hodgman clipping with arrays: docs/performance.md).
// A triangle in a cell's face belongs to the cell on the upper side only, so nothing counts twice.
// variants: GW_TEXTURES=1 GW_COLORS=1 GW_NORMALS=1 GW_EMISSION=1; GW_NORMALS=1; GW_SEED_RULE=1
#include "build/payload.glsl"
#include "common/fixed_math.glsl"

layout(location = 3) uniform uint level;
layout(location = 4) uniform uint list_first; // this dispatch takes list entries [list_first, list_first + list_limit)
layout(location = 5) uniform uint list_limit;

layout(binding = 0) uniform samplerBuffer triangle_texels;
layout(binding = 1) uniform usamplerBuffer reference_texels;
layout(binding = 2) uniform usamplerBuffer face_texels;    // vertices, material
layout(binding = 3) uniform usamplerBuffer vertex_texels;  // normal and colour; texture coordinates
layout(binding = 4) uniform samplerBuffer material_texels; // base colour; roughness, metalness, alpha mode, cut-off; emission, 1 if unlit
layout(binding = 5) uniform usamplerBuffer chain_texels;   // per material: offset; bits and wrap modes of both sides; 1 if textured
layout(binding = 6) uniform usamplerBuffer texture_texels; // linear RGBA, 16 bits each

// Node in level, cell xy, cell z (bit 31: one inline triangle), link.
layout(std430, binding = 1) readonly buffer Jobs { uvec4 jobs[]; };

// Alpha modes as material_texels has them (gw_alpha_mode).
#define GW_OPAQUE 0.0
#define GW_MASK 1.0

vec3 precise_cross(vec3 a, vec3 b) {
    precise vec3 c = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return c;
}

float precise_dot(vec3 a, vec3 b) {
    precise float d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
}

// The boundary integral: twice the area, and the sum of (p + q) weighted by it, about a point of the triangle's plane near
// the cell (about a far vertex of a large triangle the products would cancel).
vec3 pivot = vec3(0.0);
vec3 plane_normal = vec3(0.0); // unit
float double_area = 0.0;
vec3 moment = vec3(0.0);

// Cuts enter..leave of a segment from p along d to what lies in low..high of one axis.
void clip_axis(inout float enter, inout float leave, float p, float d, float low, float high) {
    precise float inverse = gw_reciprocal(abs(d));
    precise float to_low = (d < 0.0 ? p - low : low - p) * inverse;
    precise float to_high = (d < 0.0 ? p - high : high - p) * inverse;
    bool parallel = inverse == 0.0;
    bool inside = p >= low && p <= high;
    enter = max(enter, parallel ? 0.0 : min(to_low, to_high));
    leave = min(leave, parallel ? (inside ? 1.0 : -1.0) : max(to_low, to_high));
}

// Adds the part of segment p -> q that lies in the box low..high. A segment in the plane of a face lies within the box along
// that face's axis; -1: no such axis. (`face` is constant wherever this is called, so no branch is left.)
void add_segment(vec3 p, vec3 q, vec3 low, vec3 high, bool exists, int face) {
    precise vec3 d = q - p;
    float enter = 0.0;
    float leave = exists ? 1.0 : -1.0;
    if (face != 0)
        clip_axis(enter, leave, p.x, d.x, low.x, high.x);
    if (face != 1)
        clip_axis(enter, leave, p.y, d.y, low.y, high.y);
    if (face != 2)
        clip_axis(enter, leave, p.z, d.z, low.z, high.z);
    if (enter >= leave)
        return;
    precise vec3 from = p + d * enter - pivot;
    precise vec3 to = p + d * leave - pivot;
    precise float share = precise_dot(precise_cross(from, to), plane_normal);
    precise float area = double_area + share;
    precise vec3 weighted = moment + share * (from + to);
    double_area = area;
    moment = weighted;
}

// Where the edge p -> q meets the plane of a face.
vec3 face_crossing(vec3 p, vec3 q, int axis, float plane) {
    precise float before = abs(p[axis] - plane);
    precise float after = abs(q[axis] - plane);
    precise vec3 crossing = p + (q - p) * (before * gw_reciprocal(before + after));
    crossing[axis] = plane;
    return crossing;
}

// On one face, the boundary runs from where the triangle's outline leaves the half space to where it comes back.
// A triangle's plane that holds an edge of the cell cuts two faces in the same segment. Clipping by one face after the other
// would keep it once where both half spaces lie on one side of it, and twice, in opposite directions, where they do not.
// The same here, rounding or not: a face takes what lies within `slack` beyond the faces of other axes, but leaves as much
// out at those of lower axes on the same side - and not along an axis in which the triangle is flat, where all of it may lie
// in a face.
void add_face(vec3 a, vec3 b, vec3 c, int axis, bool upper, float slack, bvec3 flat_axes) {
    float facing = upper ? plane_normal[axis] : -plane_normal[axis];
    vec3 low = vec3(-slack);
    precise vec3 high = vec3(1.0 + slack);
    for (int other = 0; other < axis; ++other) {
        precise float same_side = facing * plane_normal[other];
        low[other] = same_side > 0.0 && !flat_axes[other] ? slack : low[other];
        high[other] = same_side < 0.0 && !flat_axes[other] ? 1.0 - slack : high[other];
    }
    float plane = upper ? 1.0 : 0.0;
    bool a_inside = upper ? a[axis] <= plane : a[axis] >= plane;
    bool b_inside = upper ? b[axis] <= plane : b[axis] >= plane;
    bool c_inside = upper ? c[axis] <= plane : c[axis] >= plane;
    bool cut = (a_inside || b_inside || c_inside) && !(a_inside && b_inside && c_inside);
    bool leaves_ab = a_inside && !b_inside;
    bool leaves_bc = b_inside && !c_inside;
    bool enters_ab = !a_inside && b_inside;
    bool enters_bc = !b_inside && c_inside;
    vec3 out_first = leaves_ab ? a : leaves_bc ? b : c;
    vec3 out_second = leaves_ab ? b : leaves_bc ? c : a;
    vec3 in_first = enters_ab ? a : enters_bc ? b : c;
    vec3 in_second = enters_ab ? b : enters_bc ? c : a;
    add_segment(face_crossing(out_first, out_second, axis, plane), face_crossing(in_first, in_second, axis, plane), low,
                high, cut, axis);
}

int wrapped(float coordinate, int size, uint mode) {
    precise float scaled = floor(coordinate * float(size));
    int texel = int(clamp(scaled, -1.0e9, 1.0e9));
    if (mode == 1u)
        return clamp(texel, 0, size - 1);
    if (mode == 2u) {
        int folded = texel & (2 * size - 1);
        return folded < size ? folded : 2 * size - 1 - folded;
    }
    return texel & (size - 1);
}

// Linear colour and alpha of a material's texture around uv, averaged over about `uv_area` (in uv units).
vec4 texture_mean(uvec4 chain, vec2 uv, float uv_area) {
    uint width_bits = chain.y & 0xffu;
    uint height_bits = (chain.y >> 8) & 0xffu;
    precise float texels = uv_area * float(1u << width_bits) * float(1u << height_bits);
    // Side of the averaged square as a power of two, rounded up: from the exponent of its area.
    int exponent = int(floatBitsToUint(max(texels, 1.0)) >> 23) - 127;
    uint mip = min(uint((exponent + 2) >> 1), max(width_bits, height_bits));
    mip = texels > 1.0 ? mip : 0u;
    uint offset = chain.x;
    for (uint i = 0u; i < mip; ++i)
        offset += (1u << (width_bits > i ? width_bits - i : 0u)) * (1u << (height_bits > i ? height_bits - i : 0u));
    int width = 1 << (width_bits > mip ? width_bits - mip : 0u);
    int height = 1 << (height_bits > mip ? height_bits - mip : 0u);
    int x = wrapped(uv.x, width, (chain.y >> 16) & 0xffu);
    int y = wrapped(uv.y, height, chain.y >> 24);
    uvec4 texel = texelFetch(texture_texels, int(offset) + y * width + x);
    precise vec4 mean = vec4(float(texel.x & 0xffffu), float(texel.x >> 16), float(texel.y & 0xffffu), float(texel.y >> 16)) *
                        (1.0 / 65535.0);
    return mean;
}

// unpackUnorm4x8 divides, and may round differently from driver to driver.
vec4 bytes_of(uint word) {
    return vec4(float(word & 0xffu), float((word >> 8) & 0xffu), float((word >> 16) & 0xffu), float(word >> 24));
}

vec3 unit_or_zero(vec3 v) {
    precise vec3 unit = v * gw_reciprocal(gw_square_root(precise_dot(v, v)));
    return unit;
}

// The part of one triangle in the cell at `low` with sides 1/scale.
surface_sum triangle_surface(uint triangle, vec3 low, float scale) {
    int texel = int(triangle) * 3;
    precise vec3 a = (texelFetch(triangle_texels, texel).xyz - low) * scale;
    precise vec3 b = (texelFetch(triangle_texels, texel + 1).xyz - low) * scale;
    precise vec3 c = (texelFetch(triangle_texels, texel + 2).xyz - low) * scale;
    vec3 whole = precise_cross(b - a, c - a);
    float whole_square = precise_dot(whole, whole);
    float whole_length = gw_square_root(whole_square);
    precise vec3 unit = whole * gw_reciprocal(whole_length);
    precise vec3 half_cell = vec3(0.5);
    precise vec3 foot = half_cell - unit * precise_dot(half_cell - a, unit);
    plane_normal = unit;
    pivot = foot;
    double_area = 0.0;
    moment = vec3(0.0);
    add_segment(a, b, vec3(0.0), vec3(1.0), true, -1);
    add_segment(b, c, vec3(0.0), vec3(1.0), true, -1);
    add_segment(c, a, vec3(0.0), vec3(1.0), true, -1);
    // Rounding of a crossing grows with the triangle's reach in cells.
    vec3 extreme = max(max(abs(a), abs(b)), abs(c));
    precise float slack = 3.814697265625e-06 * max(max(max(extreme.x, extreme.y), extreme.z), 4.0);
    precise vec3 extent = max(max(a, b), c) - min(min(a, b), c);
    bvec3 flat_axes = lessThanEqual(extent, vec3(2.0 * slack));
    // Not a loop: with the axis constant no component is picked at run time.
    add_face(a, b, c, 0, false, slack, flat_axes);
    add_face(a, b, c, 0, true, slack, flat_axes);
    add_face(a, b, c, 1, false, slack, flat_axes);
    add_face(a, b, c, 1, true, slack, flat_axes);
    add_face(a, b, c, 2, false, slack, flat_axes);
    add_face(a, b, c, 2, true, slack, flat_axes);
    // All of it on or beyond an upper face: it belongs to the neighbour.
    bool beyond = any(greaterThanEqual(min(min(a, b), c), vec3(1.0)));
    precise float area = beyond ? 0.0 : max(0.5 * double_area, 0.0);
    precise vec3 middle = pivot + moment * (gw_reciprocal(max(double_area, 0.0)) * (1.0 / 3.0));
    middle = clamp(middle, 0.0, 1.0);
    float inverse_square = gw_reciprocal(whole_square);
    precise float v = clamp(precise_dot(precise_cross(middle - a, c - a), whole) * inverse_square, 0.0, 1.0);
    precise float w = clamp(precise_dot(precise_cross(b - a, middle - a), whole) * inverse_square, 0.0, 1.0 - v);
    precise float u = 1.0 - v - w;

    uvec4 face = texelFetch(face_texels, int(triangle));
    vec4 base = texelFetch(material_texels, int(face.w) * 3);
    vec4 finish = texelFetch(material_texels, int(face.w) * 3 + 1);
    precise vec3 normal = unit;
    precise vec4 color = base;
#if defined(GW_NORMALS) || defined(GW_COLORS)
    uvec4 a_first = texelFetch(vertex_texels, int(face.x) * 2);
    uvec4 b_first = texelFetch(vertex_texels, int(face.y) * 2);
    uvec4 c_first = texelFetch(vertex_texels, int(face.z) * 2);
#endif
#ifdef GW_NORMALS
    precise vec3 shading = uintBitsToFloat(a_first.xyz) * u + uintBitsToFloat(b_first.xyz) * v + uintBitsToFloat(c_first.xyz) * w;
    shading = unit_or_zero(shading);
    normal = shading == vec3(0.0) ? unit : shading;
#endif
#ifdef GW_COLORS
    color = base * (bytes_of(a_first.w) * u + bytes_of(b_first.w) * v + bytes_of(c_first.w) * w) * (1.0 / 255.0);
#endif
    float mask = color.w >= finish.w ? 1.0 : 0.0;
#ifdef GW_TEXTURES
    uvec4 chain = texelFetch(chain_texels, int(face.w));
    vec2 a_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.x) * 2 + 1).xy);
    vec2 b_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.y) * 2 + 1).xy);
    vec2 c_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.z) * 2 + 1).xy);
    precise vec2 uv = a_uv * u + b_uv * v + c_uv * w;
    precise vec2 first = b_uv - a_uv;
    precise vec2 second = c_uv - a_uv;
    precise float uv_area = abs(first.x * second.y - first.y * second.x) * area * gw_reciprocal(whole_length);
    vec4 mean = texture_mean(chain, uv, uv_area);
    color = chain.z != 0u ? color * mean : color;
    mask = chain.z != 0u ? mean.w : mask; // the chain of a material with a cut-off holds the share of texels that pass it
#endif
    float opacity = finish.z == GW_OPAQUE ? 1.0 : finish.z == GW_MASK ? mask : color.w;
#ifdef GW_SEED_RULE
    area = 1.0;
#else
    area = area * opacity;
#endif
#ifdef GW_EMISSION
    // What is unlit sends its base colour and reflects nothing.
    vec4 sent = texelFetch(material_texels, int(face.w) * 3 + 2);
    bool unlit = sent.w > 0.5;
    vec3 emission = unlit ? color.xyz : sent.xyz;
    color = unlit ? vec4(0.0, 0.0, 0.0, color.w) : color;
    finish = unlit ? vec4(1.0, 0.0, finish.z, finish.w) : finish;
#endif
    precise vec3 area_color = color.xyz * area;
    precise vec3 area_normal = normal * area;
#ifdef GW_SEED_RULE
    float area_reflectance = area;
#else
    precise float metal = (color.x + color.y + color.z) * (1.0 / 3.0);
    precise float area_reflectance = max(0.04 + finish.y * (metal - 0.04), 0.001) * area;
#endif
    precise float area_roughness = finish.x * area_reflectance;
    precise float area_metalness = finish.y * area;
    surface_sum part = empty_sum();
    part.area = area;
    part.color = area_color;
    part.normal = area_normal;
    part.aligned = area_normal;
    part.roughness = area_roughness;
    part.metalness = area_metalness;
    part.reflectance = area_reflectance;
#ifdef GW_SEED_RULE
    part.moment = vec3(opacity, float(triangle) + 1.0, 0.0);
#else
    precise vec3 area_place = middle * area;
    precise vec3 area_squares = middle * area_place;
    precise vec3 area_products = middle.yzx * area_place.zxy;
    part.moment = area_place;
    part.squares = area_squares;
    part.products = area_products;
#endif
#ifdef GW_EMISSION
    precise vec3 area_emission = emission * area;
    part.emission = area_emission;
#endif
    return part;
}

void main() {
    uint index = job_index();
    if (index >= job_count)
        return;
    uvec4 job = jobs[index];
    bool single = (job.z >> 31) != 0u;
    float side = 2.0 / float(1u << level);
    precise vec3 low = vec3(float(job.y & 0xffffu), float(job.y >> 16), float(job.z & 0x7fffffffu)) * side - 1.0;
    float scale = 0.5 * float(1u << level);
    uint node = job.x - node_first;
    surface_sum sum = empty_sum();
    if (list_first > 0u)
        sum = load_sum(node);
    bool more = true;
    for (uint i = 0u; more && i < list_limit; ++i) {
        uint entry = single ? (job.w | GW_REFERENCE_LAST) : texelFetch(reference_texels, int(job.w + list_first + i)).x;
        more = (entry & GW_REFERENCE_LAST) == 0u;
        add_surface(sum, triangle_surface(entry & GW_REFERENCE_ID, low, scale));
    }
    store_sum(node, sum);
}
