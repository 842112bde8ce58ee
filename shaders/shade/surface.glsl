// From a fragment to the surface that is lit: a triangle at its hit, or a voxel.
#include "common/color.glsl"
#include "common/payload.glsl"
#include "shade/brdf.glsl"
#if defined(NORMAL_MAPS) || defined(MATERIAL_MAPS) || defined(EMISSIVE_MAPS) || defined(LAYER_MAPS) || defined(SPECULAR_MAPS) || \
    defined(TRANSMISSION_MAPS)
#define MAPS 1
#endif
#if defined(TEXTURES) || defined(MAPS)
#include "shade/texture.glsl"
#endif
#if defined(MAPS) || defined(SPECULAR) || defined(CLEARCOAT) || defined(SHEEN) || defined(UNLIT)
#include "shade/material_extension.glsl"
#endif
#ifdef MAPS
#include "shade/maps.glsl"
#endif

layout(binding = 4) uniform usamplerBuffer faces;     // three vertices, material
layout(binding = 5) uniform usamplerBuffer vertices;  // normal, u, v, color
layout(binding = 6) uniform usamplerBuffer materials; // gw_gpu_material

#define NO_NORMAL 0xffffffffu

vec3 vertex_normal(uint word) {
    vec2 square = vec2(word & 0xffffu, word >> 16) * (2.0 / 65534.0) - 1.0;
    return octahedral_decode(square);
}

vec4 vertex_color(uint word) {
    return word == 0xffffffffu ? vec4(1.0) : unpackUnorm4x8(word);
}

// The geometric normal on the ray's side, and how much texture a unit of surface holds.
struct Corner_weights {
    vec3 weights; // of the triangle's vertices at the hit
    vec3 position; // the hit, in the triangle's plane to within rounding of its corners
    vec3 normal;
    float doubled_area;
};

Corner_weights weights_at(uint triangle, float t, vec3 origin, vec3 direction) {
    vec3 a = uintBitsToFloat(TRIANGLE(triangle, 0).xyz);
    vec3 b = uintBitsToFloat(TRIANGLE(triangle, 1).xyz);
    vec3 c = uintBitsToFloat(TRIANGLE(triangle, 2).xyz);
    precise vec3 ab = b - a, ac = c - a;
    precise vec3 hit = (origin - a) + direction * t;
    precise vec3 normal = cross(ab, ac);
    float area = length_precise(normal);
    vec3 unit = area > 0.0 ? normal / area : -normalize(direction);
    precise float of_b = area > 0.0 ? dot(cross(hit, ac), unit) / area : 0.0;
    precise float of_c = area > 0.0 ? dot(cross(ab, hit), unit) / area : 0.0;
    of_b = clamp(of_b, 0.0, 1.0);
    of_c = clamp(of_c, 0.0, 1.0 - of_b);
    Corner_weights result;
    result.weights = vec3(1.0 - of_b - of_c, of_b, of_c);
    precise vec3 position = a + ab * of_b + ac * of_c;
    result.position = position;
    result.normal = dot(unit, direction) > 0.0 ? -unit : unit;
    result.doubled_area = area;
    return result;
}

#ifdef MAPS
vec4 data_map(uint word, Texcoords at, float width, float doubled_area) {
    return sample_data(word, at.at, width, density_of(at, doubled_area));
}

vec4 color_map(uint word, Texcoords at, float width, float doubled_area) {
    return sample_texture(word, at.at, width, density_of(at, doubled_area));
}

// Changes what the material's maps say. Materials without a map keep their bits.
void apply_maps(inout Surface surface, uint triangle, uvec4 face, Corner_weights corner, vec3 direction, float footprint,
                uvec4 va, uvec4 vb, uvec4 vc) {
    Texcoords first = texcoords_of(uintBitsToFloat(va.yz), uintBitsToFloat(vb.yz), uintBitsToFloat(vc.yz), corner.weights);
#ifdef MAP_PLACEMENT
    Texcoords second = second_of(face, corner.weights);
#endif
    uvec4 words = floatBitsToUint(extension_row(face.w, GW_EXTENSION_MAPS));
#if defined(LAYER_MAPS) || defined(TRANSMISSION_MAPS)
    uvec4 more = floatBitsToUint(extension_row(face.w, GW_EXTENSION_MAPS + 1));
#endif
#if defined(LAYER_MAPS) || defined(SPECULAR_MAPS)
    uvec4 last = floatBitsToUint(extension_row(face.w, GW_EXTENSION_MAPS + 2));
#endif
    float area = corner.doubled_area;
    float facing = max(abs(dot(corner.normal, normalize(direction))), 1.0 / 16.0);
    float width = footprint * inversesqrt(facing);
#if defined(NORMAL_MAPS) || defined(MATERIAL_MAPS)
    vec4 factors = extension_row(face.w, GW_EXTENSION_FACTORS);
#endif
#if defined(NORMAL_MAPS) || defined(LAYER_MAPS)
    vec3 a = uintBitsToFloat(TRIANGLE(triangle, 0).xyz);
    precise vec3 ab = uintBitsToFloat(TRIANGLE(triangle, 1).xyz) - a, ac = uintBitsToFloat(TRIANGLE(triangle, 2).xyz) - a;
    float front = dot(cross(ab, ac), corner.normal) < 0.0 ? -1.0 : 1.0;
    vec4 tangent = tangent_of(face, corner.weights);
#endif
#ifdef MATERIAL_MAPS
    vec4 finish = data_map(words.y, PLACED(1), width, area);
    surface.metalness = words.y == GW_NO_TEXTURE ? surface.metalness : factors.w * finish.z;
    surface.roughness = words.y == GW_NO_TEXTURE ? surface.roughness : factors.z * finish.y;
    float seen = data_map(words.z, PLACED(2), width, area).x;
    precise float open = 1.0 + factors.y * (seen - 1.0);
    surface.occlusion = words.z == GW_NO_TEXTURE ? 1.0 : open;
#endif
#ifdef NORMAL_MAPS
    Texcoords normal_at = PLACED(0);
    vec4 texel = data_map(words.x, normal_at, width, area);
    vec4 bent = mapped_normal(surface.normal, front, texel, factors.x, normal_at, ab, ac, tangent);
    surface.normal = words.x == GW_NO_TEXTURE ? surface.normal : bent.xyz;
    surface.roughness = words.x == GW_NO_TEXTURE ? surface.roughness : widened_roughness(surface.roughness, bent.w);
#endif
#ifdef EMISSIVE_MAPS
    vec4 glow = color_map(words.w, PLACED(3), width, area);
    surface.emissive = words.w == GW_NO_TEXTURE ? surface.emissive : extension_row(face.w, GW_EXTENSION_EMISSIVE).rgb * glow.rgb;
#endif
#ifdef TRANSMISSION_MAPS
    surface.passing = data_map(more.x, PLACED(4), width, area).x;
#endif
#if defined(LAYER_MAPS) && defined(CLEARCOAT)
    surface.coat *= data_map(more.y, PLACED(5), width, area).x;
    surface.coat_roughness *= data_map(more.z, PLACED(6), width, area).y;
    Texcoords coat_at = PLACED(7);
    float coat_scale = extension_row(face.w, GW_EXTENSION_COAT).z;
    vec4 coat = mapped_normal(surface.coat_normal, front, data_map(more.w, coat_at, width, area), coat_scale, coat_at, ab, ac, tangent);
    surface.coat_normal = more.w == GW_NO_TEXTURE ? surface.coat_normal : coat.xyz;
    surface.coat_roughness = more.w == GW_NO_TEXTURE ? surface.coat_roughness : widened_roughness(surface.coat_roughness, coat.w);
#endif
#if defined(LAYER_MAPS) && defined(SHEEN)
    surface.sheen *= color_map(last.x, PLACED(8), width, area).rgb;
    surface.sheen_roughness *= data_map(last.y, PLACED(9), width, area).x;
#endif
#if defined(SPECULAR_MAPS) && defined(SPECULAR)
    surface.dielectric.a *= data_map(last.z, PLACED(10), width, area).x;
    surface.dielectric.rgb *= color_map(last.w, PLACED(11), width, area).rgb;
#endif
}
#endif

Surface surface_of_triangle(uint triangle, float t, vec3 origin, vec3 direction, float footprint) {
    Corner_weights corner = weights_at(triangle, t, origin, direction);
    uvec4 face = texelFetch(faces, int(triangle));
    uvec4 va = texelFetch(vertices, int(face.x)), vb = texelFetch(vertices, int(face.y)), vc = texelFetch(vertices, int(face.z));
    int material = int(face.w) * 3;
    vec4 base = uintBitsToFloat(texelFetch(materials, material));
    vec4 emissive = uintBitsToFloat(texelFetch(materials, material + 1));
    uvec4 words = texelFetch(materials, material + 2);

    Surface surface;
    surface.position = origin + direction * t;
    surface.normal = corner.normal;
#ifdef SMOOTH_NORMALS
    precise vec3 smooth_normal = vertex_normal(va.x) * corner.weights.x + vertex_normal(vb.x) * corner.weights.y +
                                 vertex_normal(vc.x) * corner.weights.z;
    float size = length_precise(smooth_normal);
    bool has = va.x != NO_NORMAL && vb.x != NO_NORMAL && vc.x != NO_NORMAL && size > 1e-4;
    vec3 shading = has ? smooth_normal / max(size, 1e-4) : corner.normal;
    surface.normal = dot(shading, corner.normal) < 0.0 ? -shading : shading;
#endif
#ifdef VERTEX_COLORS
    base *= vertex_color(va.w) * corner.weights.x + vertex_color(vb.w) * corner.weights.y +
            vertex_color(vc.w) * corner.weights.z;
#endif
#ifdef TEXTURES
    vec2 uva = uintBitsToFloat(va.yz), uvb = uintBitsToFloat(vb.yz), uvc = uintBitsToFloat(vc.yz);
    precise vec2 uv = uva * corner.weights.x + uvb * corner.weights.y + uvc * corner.weights.z;
    vec2 u_side = uvb - uva, v_side = uvc - uva;
    precise float texture_area = abs(u_side.x * v_side.y - u_side.y * v_side.x);
    float density = corner.doubled_area > 0.0 ? texture_area / corner.doubled_area : 0.0;
    // Tilted away from the ray, a surface meets a footprint that is longer by 1 / |n.d|; the mean of both axes is used.
    float facing = max(abs(dot(corner.normal, normalize(direction))), 1.0 / 16.0);
    base *= sample_texture(words.x, uv, footprint * inversesqrt(facing), density);
#endif
    surface.base_color = base.rgb;
    surface.metalness = emissive.w;
    surface.roughness = uintBitsToFloat(words.w);
    surface.agreement = 1.0;
    surface.emissive = vec3(0.0);
#ifdef EMISSIVE
    surface.emissive = emissive.rgb;
#endif
    surface.albedo = vec2(1.0, 0.0);
#ifdef MATERIAL_MAPS
    surface.occlusion = 1.0;
#endif
#ifdef TRANSMISSION_MAPS
    surface.passing = 1.0;
#endif
#ifdef SPECULAR
    surface.dielectric = extension_row(face.w, GW_EXTENSION_SPECULAR); // whole below, after its maps
#endif
#ifdef CLEARCOAT
    vec4 coat = extension_row(face.w, GW_EXTENSION_COAT);
    surface.coat = coat.x;
    surface.coat_roughness = coat.y;
    surface.coat_normal = surface.normal; // the map below does not bend it
    surface.coat_albedo = 0.0;
#endif
#ifdef SHEEN
    vec4 sheen = extension_row(face.w, GW_EXTENSION_SHEEN);
    surface.sheen = sheen.rgb;
    surface.sheen_roughness = sheen.a;
    surface.sheen_albedo = 0.0;
#endif
#ifdef MAPS
    apply_maps(surface, triangle, face, corner, direction, footprint, va, vb, vc);
#endif
#ifdef SPECULAR
    precise vec3 dielectric = min(surface.dielectric.rgb, vec3(1.0)) * surface.dielectric.a;
    surface.dielectric.rgb = dielectric;
#endif
#ifdef UNLIT
    bool unlit = extension_row(face.w, GW_EXTENSION_EMISSIVE).w > 0.5;
    surface.lit = unlit ? 0.0 : 1.0;
    surface.emissive = unlit ? base.rgb : surface.emissive;
#endif
    surface.alpha = 1.0;
#ifdef ALPHA
    float cutoff = uintBitsToFloat(words.z);
    surface.alpha = (words.y & GW_MATERIAL_BLEND) != 0u ? base.a
                    : (words.y & GW_MATERIAL_MASK) != 0u ? (base.a >= cutoff ? 1.0 : 0.0) : 1.0;
#endif
    return surface;
}

#ifdef LOD
#ifdef VOXEL_EMISSION
layout(binding = 12) uniform usamplerBuffer emissions; // of voxels, shared exponent

vec3 emission_of_voxel(uint node) {
    uint word = texelFetch(emissions, int(node)).x;
    float scale = uintBitsToFloat((127u - 24u + (word >> 27)) << 23);
    return vec3(word & 0x1ffu, (word >> 9) & 0x1ffu, (word >> 18) & 0x1ffu) * scale;
}
#endif

Surface surface_of_voxel(uint node, float t, vec3 origin, vec3 direction) {
    uvec3 payload = PAYLOAD(node);
    Surface surface;
    surface.position = origin + direction * t;
    vec3 towards = -normalize(direction);
    vec3 normal = payload_normal(payload);
    normal = dot(normal, towards) < 0.0 ? -normal : normal;
    surface.normal = GW_PAYLOAD_HAS_NORMAL(payload.y) ? normal : towards;
    surface.base_color = srgb_decode(vec3(payload.x & 0x3ffu, (payload.x >> 10) & 0x3ffu, (payload.x >> 20) & 0x3ffu) *
                                     (1.0 / 1023.0));
    surface.agreement = payload_agreement(payload);
    surface.metalness = float(GW_PAYLOAD_METALNESS_CODE(payload.z)) * (1.0 / 63.0);
    float roughness = float(GW_PAYLOAD_ROUGHNESS_CODE(payload.z)) * (1.0 / 63.0);
    surface.roughness = widened_roughness(roughness, spread_of(surface.agreement));
    surface.emissive = vec3(0.0);
#ifdef VOXEL_EMISSION
    surface.emissive = emission_of_voxel(node);
#endif
    surface.alpha = 1.0;
    surface.albedo = vec2(1.0, 0.0);
#ifdef MATERIAL_MAPS
    surface.occlusion = 1.0;
#endif
#ifdef TRANSMISSION_MAPS
    surface.passing = 1.0;
#endif
#ifdef SPECULAR
    surface.dielectric = vec4(0.04, 0.04, 0.04, 1.0);
#endif
#ifdef CLEARCOAT
    surface.coat = surface.coat_roughness = surface.coat_albedo = 0.0;
    surface.coat_normal = surface.normal;
#endif
#ifdef SHEEN
    surface.sheen = vec3(0.0);
    surface.sheen_roughness = surface.sheen_albedo = 0.0;
#endif
#ifdef UNLIT
    surface.lit = 1.0;
#endif
    return surface;
}
#endif

// Of a fragment: the triangle's, or the voxel's.
Surface surface_of_fragment(uint id, float t, Pixel_ray ray) {
#ifdef LOD
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    Surface surface = surface_of_triangle(voxel ? 0u : id, t, ray.origin, ray.direction, footprint_at(ray, t));
    Surface other = surface_of_voxel(voxel ? id & ~GW_FRAGMENT_VOXEL : 0u, t, ray.origin, ray.direction);
    if (voxel)
        surface = other;
    return surface;
#else
    return surface_of_triangle(id, t, ray.origin, ray.direction, footprint_at(ray, t));
#endif
}
