// Base-colour textures: arrays by size class, square sides of powers of two, sRGB-encoded, with own mip chains. The level
// of detail is explicit, from the ray's footprint. Each class is one sampler, chosen by constant-index branches, since
// GL 4.5 wants sampler indices that are uniform over a draw.
#ifndef TEXTURE_CLASSES
#define TEXTURE_CLASSES 0
#endif
#if TEXTURE_CLASSES > 4
#error "texture classes: GW_MAXIMUM_TEXTURE_CLASSES is 4"
#endif
#if TEXTURE_CLASSES > 0
layout(binding = 8) uniform sampler2DArray texture_class_0;
#endif
#if TEXTURE_CLASSES > 1
layout(binding = 9) uniform sampler2DArray texture_class_1;
#endif
#if TEXTURE_CLASSES > 2
layout(binding = 10) uniform sampler2DArray texture_class_2;
#endif
#if TEXTURE_CLASSES > 3
layout(binding = 11) uniform sampler2DArray texture_class_3;
#endif
// Sides of the classes in texels.
layout(location = 1) uniform vec4 texture_sides;

// The samplers repeat; the other modes fold the coordinate and keep half a texel of the level away from the far edge.
float wrap_coordinate(float u, uint mode, float half_texel) {
    precise float repeated = u - floor(u);
    precise float mirrored = 2.0 * abs(0.5 * u - floor(0.5 * u + 0.5));
    float inside = mode == 2u ? mirrored : u;
    float clamped = clamp(inside, min(half_texel, 0.5), max(1.0 - half_texel, 0.5));
    return mode == 0u ? repeated : clamped;
}

// Where a lookup goes in its array, and the level of detail. density: texture areas (0..1 squared) per unit of surface; footprint:
// width on the surface; side: of the array, texels.
vec4 texel_place(uint word, vec2 uv, float footprint, float density, float side) {
    precise float texels = footprint * sqrt(density) * side;
    float lod = log2(max(texels, 1.0));
    float half_texel = 0.5 * exp2(ceil(lod)) / side;
    vec2 at = vec2(wrap_coordinate(uv.x, GW_TEXTURE_WRAP_U(word), half_texel),
                   wrap_coordinate(uv.y, GW_TEXTURE_WRAP_V(word), half_texel));
#ifdef SQUARE_TEXELS
    at = GW_TEXTURE_SQUARES(word) && texels <= 1.0 ? (floor(at * side) + 0.5) / side : at;
#endif
    return vec4(at, float(GW_TEXTURE_LAYER(word)), lod);
}

vec4 sample_texture(uint word, vec2 uv, float footprint, float density) {
    vec4 result = vec4(1.0);
#if TEXTURE_CLASSES > 0
    uint size_class = GW_TEXTURE_CLASS(word);
    float side = size_class == 0u ? texture_sides.x : size_class == 1u ? texture_sides.y
                                  : size_class == 2u ? texture_sides.z : texture_sides.w;
    vec4 place = texel_place(word, uv, footprint, density, side);
    vec3 at = place.xyz;
    float lod = place.w;
    result = textureLod(texture_class_0, at, lod);
#if TEXTURE_CLASSES > 1
    if (size_class == 1u)
        result = textureLod(texture_class_1, at, lod);
#endif
#if TEXTURE_CLASSES > 2
    if (size_class == 2u)
        result = textureLod(texture_class_2, at, lod);
#endif
#if TEXTURE_CLASSES > 3
    if (size_class == 3u)
        result = textureLod(texture_class_3, at, lod);
#endif
#endif
    return word == GW_NO_TEXTURE ? vec4(1.0) : result;
}
