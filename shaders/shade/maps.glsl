// Pictures that materials read beside their base colour: where they lie, and what they say of a surface. Needs shade/texture.glsl
// and shade/material_extension.glsl before it.

// Linear data (normals, metalness, roughness, occlusion), as the classes of colours are.
#ifndef DATA_CLASSES
#define DATA_CLASSES 0
#endif
#if DATA_CLASSES > 2
#error "data classes: GW_MAXIMUM_DATA_CLASSES is 2"
#endif
#if DATA_CLASSES > 0
layout(binding = 22) uniform sampler2DArray data_class_0;
#endif
#if DATA_CLASSES > 1
layout(binding = 23) uniform sampler2DArray data_class_1;
#endif
#ifdef MAP_PLACEMENT
layout(binding = 18) uniform usamplerBuffer second_texcoords; // of vertices
#endif

// Texture coordinates at a hit, and how they change along two sides of its triangle.
struct Texcoords {
    vec2 at, to_b, to_c;
};

Texcoords texcoords_of(vec2 a, vec2 b, vec2 c, vec3 weights) {
    precise vec2 at = a * weights.x + b * weights.y + c * weights.z;
    return Texcoords(at, b - a, c - a);
}

// Texture areas per unit of surface.
float density_of(Texcoords coordinates, float doubled_area) {
    precise float area = abs(coordinates.to_b.x * coordinates.to_c.y - coordinates.to_b.y * coordinates.to_c.x);
    return doubled_area > 0.0 ? area / doubled_area : 0.0;
}

#ifdef MAP_PLACEMENT
Texcoords second_of(uvec4 face, vec3 weights) {
    return texcoords_of(uintBitsToFloat(texelFetch(second_texcoords, int(face.x)).xy),
                        uintBitsToFloat(texelFetch(second_texcoords, int(face.y)).xy),
                        uintBitsToFloat(texelFetch(second_texcoords, int(face.z)).xy), weights);
}

vec2 transformed(vec4 u_row, vec4 v_row, vec2 side) {
    precise vec2 result = vec2(u_row.x * side.x + u_row.y * side.y, v_row.x * side.x + v_row.y * side.y);
    return result;
}

// Of the map'th row pair of the material's to_uv.
Texcoords placed(uint material, int map, Texcoords first, Texcoords second) {
    vec4 u_row = extension_row(material, GW_EXTENSION_TO_UV + 2 * map);
    vec4 v_row = extension_row(material, GW_EXTENSION_TO_UV + 2 * map + 1);
    bool other = u_row.w > 0.5;
    Texcoords from = Texcoords(other ? second.at : first.at, other ? second.to_b : first.to_b, other ? second.to_c : first.to_c);
    precise vec2 at = transformed(u_row, v_row, from.at) + vec2(u_row.z, v_row.z);
    return Texcoords(at, transformed(u_row, v_row, from.to_b), transformed(u_row, v_row, from.to_c));
}
#define PLACED(map) placed(face.w, map, first, second)
#else
#define PLACED(map) first
#endif

vec4 sample_data(uint word, vec2 uv, float footprint, float density) {
    vec4 result = vec4(1.0);
#if DATA_CLASSES > 0
    float side = float(textureSize(data_class_0, 0).x);
#if DATA_CLASSES > 1
    side = GW_TEXTURE_CLASS(word) == 0u ? side : float(textureSize(data_class_1, 0).x);
#endif
    vec4 place = texel_place(word, uv, footprint, density, side);
    result = textureLod(data_class_0, place.xyz, place.w);
#if DATA_CLASSES > 1
    if (GW_TEXTURE_CLASS(word) == 1u)
        result = textureLod(data_class_1, place.xyz, place.w);
#endif
#endif
    return word == GW_NO_TEXTURE ? vec4(1.0) : result;
}

#if defined(NORMAL_MAPS) || defined(LAYER_MAPS)
#ifdef TANGENTS
layout(binding = 25) uniform usamplerBuffer tangents; // of vertices

vec3 vertex_tangent(uint word) {
    const uint mask = (1u << GW_TANGENT_BITS) - 1u;
    return octahedral_decode(vec2(word & mask, (word >> GW_TANGENT_BITS) & mask) * (1.0 / float(GW_TANGENT_LARGEST)) - 1.0);
}

// Between those of the corners, and in w its side; w is 0 where a corner has none, or they differ in it.
vec4 tangent_of(uvec4 face, vec3 weights) {
    uint a = texelFetch(tangents, int(face.x)).x, b = texelFetch(tangents, int(face.y)).x, c = texelFetch(tangents, int(face.z)).x;
    precise vec3 between = vertex_tangent(a) * weights.x + vertex_tangent(b) * weights.y + vertex_tangent(c) * weights.z;
    const uint flags = GW_TANGENT_GIVEN | GW_TANGENT_LEFT;
    bool given = (a & flags) == (b & flags) && (b & flags) == (c & flags) && (a & GW_TANGENT_GIVEN) != 0u;
    float side = (a & GW_TANGENT_LEFT) != 0u ? -1.0 : 1.0;
#ifdef ONE_SIDE
    side = 1.0; // the naive variant, for the test that shows why
#endif
    return vec4(between, given ? side : 0.0);
}
#else
vec4 tangent_of(uvec4 face, vec3 weights) {
    return vec4(0.0);
}
#endif

// The shading normal bent by a map. Tangent space: the tangent that the file gives, where it does (w: its side), else that of
// the triangle's own texture coordinates: u along the tangent, up in the picture (against v) along the other. w: how the footprint's normals
// spread, as widened_roughness() takes it. front: 1 or -1, of the side that
// is seen; normal is on that side.
vec4 mapped_normal(vec3 normal, float front, vec4 texel, float scale, Texcoords at, vec3 ab, vec3 ac, vec4 given) {
    precise float turn = at.to_b.x * at.to_c.y - at.to_b.y * at.to_c.x;
    precise vec3 along_u = ab * at.to_c.y - ac * at.to_b.y;
    along_u = turn < 0.0 ? -along_u : along_u;
#ifdef TANGENTS
    along_u = given.w != 0.0 ? given.xyz : along_u;
    turn = given.w != 0.0 ? -given.w : turn; // v points down in the picture
#endif
    precise vec3 tangent = along_u - normal * dot(along_u, normal);
    float size = length_precise(tangent);
    tangent = tangent / max(size, 1e-30);
    precise vec3 upward = cross(normal, tangent) * (turn < 0.0 ? front : -front);
    // On a back side the normal is turned round, tangents are not: what the map bends is turned as a whole.
    precise vec2 bend = (texel.xy * 2.0 - 1.0) * (scale * front);
#ifdef FLIPPED_GREEN
    bend.y = -bend.y; // the naive variant, for the test that shows why
#endif
    precise vec3 bent = tangent * bend.x + upward * bend.y + normal * max(texel.z * 2.0 - 1.0, 1e-3);
    float length_of = length_precise(bent);
    precise float lost = (1.0 - texel.w) * (1.0 - texel.w);
    precise float spread = spread_of(1.0 - lost) * (scale * scale);
    bool none = size <= 1e-30 || turn == 0.0;
    return none ? vec4(normal, 0.0) : vec4(bent / length_of, spread);
}
#endif
