// Sums of leaves: every triangle of the list is clipped to the cell (Sutherland and Hodgman 1974) and adds its area, its
// colour at the clip's centroid through the mip level of the clip's area, and its normal. A triangle in a cell's face
// belongs to the cell on the upper side only, so nothing counts twice.
#include "build/payload.glsl"
#include "common/fixed_math.glsl"

layout(location = 3) uniform uint level;
layout(location = 4) uniform uint list_first; // this dispatch takes list entries [list_first, list_first + list_limit)
layout(location = 5) uniform uint list_limit;

layout(binding = 0) uniform samplerBuffer triangle_texels;
layout(binding = 1) uniform usamplerBuffer reference_texels;
layout(binding = 2) uniform usamplerBuffer face_texels;    // vertices, material
layout(binding = 3) uniform usamplerBuffer vertex_texels;  // normal and colour; texture coordinates
layout(binding = 4) uniform samplerBuffer material_texels; // base colour; roughness, metalness, alpha mode, cut-off
layout(binding = 5) uniform usamplerBuffer chain_texels;   // per material: offset; bits and wrap modes of both sides; 1 if textured
layout(binding = 6) uniform usamplerBuffer texture_texels; // linear RGBA, 16 bits each

// Node in level, cell xy, cell z (bit 31: one inline triangle), link.
layout(std430, binding = 1) readonly buffer Jobs { uvec4 jobs[]; };

// Alpha modes as material_texels has them (gw_alpha_mode).
#define GW_OPAQUE 0.0
#define GW_MASK 1.0

#define MOST_CORNERS 9
vec3 polygon[MOST_CORNERS + 1];
vec3 clipped[MOST_CORNERS + 1];

// Distance to a face of the unit cell, positive inside.
float face_distance(vec3 p, int axis, bool upper) {
    precise float d = upper ? 1.0 - p[axis] : p[axis];
    return d;
}

int clip_to_face(int corners, int axis, bool upper) {
    int kept = 0;
    for (int i = 0; i < corners; ++i) {
        vec3 here = polygon[i];
        vec3 next = polygon[i + 1 < corners ? i + 1 : 0];
        float here_distance = face_distance(here, axis, upper);
        float next_distance = face_distance(next, axis, upper);
        bool here_inside = upper ? here_distance > 0.0 : here_distance >= 0.0;
        bool next_inside = upper ? next_distance > 0.0 : next_distance >= 0.0;
        if (here_inside && kept < MOST_CORNERS) {
            clipped[kept] = here;
            kept++;
        }
        if (here_inside != next_inside && kept < MOST_CORNERS) {
            precise float span = abs(here_distance) + abs(next_distance);
            precise float fraction = abs(here_distance) * gw_reciprocal(span);
            precise vec3 crossing = here + (next - here) * fraction;
            crossing[axis] = upper ? 1.0 : 0.0;
            clipped[kept] = crossing;
            kept++;
        }
    }
    for (int i = 0; i < kept; ++i)
        polygon[i] = clipped[i];
    return kept;
}

vec3 precise_cross(vec3 a, vec3 b) {
    precise vec3 c = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return c;
}

float precise_dot(vec3 a, vec3 b) {
    precise float d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
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
    surface_sum sum = empty_sum();
    int texel = int(triangle) * 3;
    precise vec3 a = (texelFetch(triangle_texels, texel).xyz - low) * scale;
    precise vec3 b = (texelFetch(triangle_texels, texel + 1).xyz - low) * scale;
    precise vec3 c = (texelFetch(triangle_texels, texel + 2).xyz - low) * scale;
    polygon[0] = a;
    polygon[1] = b;
    polygon[2] = c;
    int corners = 3;
    for (int axis = 0; axis < 3; ++axis) {
        corners = clip_to_face(corners, axis, false);
        corners = clip_to_face(corners, axis, true);
    }
    vec3 whole = precise_cross(b - a, c - a);
    float whole_square = precise_dot(whole, whole);
    float inverse_square = gw_reciprocal(whole_square);
    precise float ratio = 0.0;           // of the clip's area to the triangle's
    precise vec3 weighted = vec3(0.0);   // centroid times ratio
    for (int i = 1; i + 1 < corners; ++i) {
        vec3 part = precise_cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        precise float share = max(precise_dot(part, whole) * inverse_square, 0.0);
        ratio += share;
        weighted += share * (polygon[0] + polygon[i] + polygon[i + 1]) * (1.0 / 3.0);
    }
    if (ratio <= 0.0)
        return sum;
    precise vec3 middle = weighted * gw_reciprocal(ratio);
    precise float v = clamp(precise_dot(precise_cross(middle - a, c - a), whole) * inverse_square, 0.0, 1.0);
    precise float w = clamp(precise_dot(precise_cross(b - a, middle - a), whole) * inverse_square, 0.0, 1.0);
    precise float u = max(1.0 - v - w, 0.0);

    uvec4 face = texelFetch(face_texels, int(triangle));
    uvec4 a_first = texelFetch(vertex_texels, int(face.x) * 2);
    uvec4 b_first = texelFetch(vertex_texels, int(face.y) * 2);
    uvec4 c_first = texelFetch(vertex_texels, int(face.z) * 2);
    precise vec3 normal = uintBitsToFloat(a_first.xyz) * u + uintBitsToFloat(b_first.xyz) * v + uintBitsToFloat(c_first.xyz) * w;
    precise vec4 tint = (bytes_of(a_first.w) * u + bytes_of(b_first.w) * v + bytes_of(c_first.w) * w) * (1.0 / 255.0);
    normal = unit_or_zero(normal);
    if (normal == vec3(0.0))
        normal = unit_or_zero(whole);

    vec4 base = texelFetch(material_texels, int(face.w) * 2);
    vec4 finish = texelFetch(material_texels, int(face.w) * 2 + 1);
    uvec4 chain = texelFetch(chain_texels, int(face.w));
    precise vec4 color = base * tint;
    float mask = color.w >= finish.w ? 1.0 : 0.0;
    if (chain.z != 0u) {
        vec2 a_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.x) * 2 + 1).xy);
        vec2 b_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.y) * 2 + 1).xy);
        vec2 c_uv = uintBitsToFloat(texelFetch(vertex_texels, int(face.z) * 2 + 1).xy);
        precise vec2 uv = a_uv * u + b_uv * v + c_uv * w;
        precise vec2 first = b_uv - a_uv;
        precise vec2 second = c_uv - a_uv;
        precise float uv_area = 0.5 * abs(first.x * second.y - first.y * second.x) * ratio;
        vec4 mean = texture_mean(chain, uv, uv_area);
        color = color * mean;
        mask = mean.w; // the chain of a material with a cut-off holds the share of texels that pass it
    }
    precise float alpha = finish.z == GW_OPAQUE ? 1.0 : finish.z == GW_MASK ? mask : color.w;
    precise float area = 0.5 * gw_square_root(whole_square) * ratio * alpha;
    precise vec3 area_color = color.xyz * area;
    precise vec3 area_normal = normal * area;
    precise float area_roughness = finish.x * area;
    precise float area_metalness = finish.y * area;
    return surface_sum(area, area_color, area_normal, area_normal, area_roughness, area_metalness);
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
