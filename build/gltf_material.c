#include "build/gltf_material.h"

#include "base/portable_math.h"

#include <math.h>
#include <string.h>

static const double largest = 1e30;

/* --- maps --- */

#define SPECULAR_GLOSSINESS "KHR_materials_pbrSpecularGlossiness"

/* Where a map's textureInfo stands: in an object of the material or of its extensions, or in the material. */
static const struct {
    gw_map map;
    const char *extension, *object, *name;
} places[] = {
    {GW_MAP_BASE_COLOR, NULL, "pbrMetallicRoughness", "baseColorTexture"},
    {GW_MAP_METALLIC_ROUGHNESS, NULL, "pbrMetallicRoughness", "metallicRoughnessTexture"},
    {GW_MAP_EMISSIVE, NULL, NULL, "emissiveTexture"},
    {GW_MAP_NORMAL, NULL, NULL, "normalTexture"},
    {GW_MAP_OCCLUSION, NULL, NULL, "occlusionTexture"},
    {GW_MAP_TRANSMISSION, "KHR_materials_transmission", NULL, "transmissionTexture"},
    {GW_MAP_SPECULAR_GLOSSINESS, SPECULAR_GLOSSINESS, NULL, "specularGlossinessTexture"},
    {GW_MAP_CLEARCOAT, "KHR_materials_clearcoat", NULL, "clearcoatTexture"},
    {GW_MAP_CLEARCOAT_ROUGHNESS, "KHR_materials_clearcoat", NULL, "clearcoatRoughnessTexture"},
    {GW_MAP_CLEARCOAT_NORMAL, "KHR_materials_clearcoat", NULL, "clearcoatNormalTexture"},
    {GW_MAP_SHEEN_COLOR, "KHR_materials_sheen", NULL, "sheenColorTexture"},
    {GW_MAP_SHEEN_ROUGHNESS, "KHR_materials_sheen", NULL, "sheenRoughnessTexture"},
    {GW_MAP_SPECULAR, "KHR_materials_specular", NULL, "specularTexture"},
    {GW_MAP_SPECULAR_COLOR, "KHR_materials_specular", NULL, "specularColorTexture"},
    {GW_MAP_THICKNESS, "KHR_materials_volume", NULL, "thicknessTexture"},
};

static const json_t *extension_of(const json_t *object, const char *name) {
    return json_object_get(json_object_get(object, "extensions"), name);
}

const json_t *gw_gltf_map(const json_t *material, gw_map map) {
    const json_t *glossy = extension_of(material, SPECULAR_GLOSSINESS), *found = NULL;
    if (json_is_object(glossy) && map == GW_MAP_METALLIC_ROUGHNESS)
        return NULL;
    if (json_is_object(glossy) && map == GW_MAP_BASE_COLOR)
        found = json_object_get(glossy, "diffuseTexture");
    else
        for (size_t i = 0; i < sizeof places / sizeof *places; i++)
            if (places[i].map == map) {
                const json_t *holder =
                    places[i].extension ? extension_of(material, places[i].extension) : material;
                found = json_object_get(places[i].object ? json_object_get(holder, places[i].object) : holder,
                                        places[i].name);
            }
    return json_is_object(found) && json_is_integer(json_object_get(found, "index")) ? found : NULL;
}

int32_t gw_gltf_texcoord_set(const json_t *map) {
    const json_t *moved = json_object_get(extension_of(map, "KHR_texture_transform"), "texCoord");
    const json_t *set = json_is_integer(moved) ? moved : json_object_get(map, "texCoord");
    const json_int_t value = json_is_integer(set) ? json_integer_value(set) : 0;
    return value >= 0 && value < 8 ? (int32_t)value : 0;
}

void gw_gltf_texcoord_sets(const json_t *material, int32_t sets[2]) {
    sets[0] = sets[1] = -1;
    for (int map = 0; map <= GW_MAP_SPECULAR_GLOSSINESS; map++) {
        const json_t *info = gw_gltf_map(material, (gw_map)map);
        const int32_t set = info ? gw_gltf_texcoord_set(info) : -1;
        if (set >= 0 && sets[0] < 0)
            sets[0] = set;
        else if (set >= 0 && set != sets[0] && sets[1] < 0)
            sets[1] = set;
    }
}

static double number_or(const json_t *value, double missing) {
    const double number = json_is_number(value) ? json_number_value(value) : missing;
    return isfinite(number) && fabs(number) <= largest ? number : missing;
}

/* Scale, then rotate counter-clockwise (v points down), then shift: the extension's own order. */
void gw_gltf_texture_transform(const json_t *map, double to_uv[2][3]) {
    const json_t *transform = extension_of(map, "KHR_texture_transform");
    const json_t *offset = json_object_get(transform, "offset"), *scale = json_object_get(transform, "scale");
    const double rotation = number_or(json_object_get(transform, "rotation"), 0.0);
    const double cosine = rotation == 0.0 ? 1.0 : gw_cos(rotation),
                 sine = rotation == 0.0 ? 0.0 : gw_sin(rotation);
    const double x = number_or(json_array_get(scale, 0), 1.0), y = number_or(json_array_get(scale, 1), 1.0);
    const double rows[2][3] = {{cosine * x, sine * y, number_or(json_array_get(offset, 0), 0.0)},
                               {-sine * x, cosine * y, number_or(json_array_get(offset, 1), 0.0)}};
    memcpy(to_uv, rows, sizeof rows);
}

/* --- factors --- */

static float factor(const json_t *holder, const char *key, double missing, double least, double most) {
    return (float)fmin(fmax(number_or(json_object_get(holder, key), missing), least), most);
}

static void color(const json_t *holder, const char *key, float missing, double most, float out[3]) {
    const json_t *list = json_object_get(holder, key);
    for (size_t i = 0; i < 3; i++)
        out[i] = (float)fmin(fmax(number_or(json_array_get(list, i), (double)missing), 0.0), most);
}

static void read_surface(const json_t *material, gw_material_extension *out) {
    const json_t *ior = extension_of(material, "KHR_materials_ior");
    const json_t *specular = extension_of(material, "KHR_materials_specular");
    const json_t *coat = extension_of(material, "KHR_materials_clearcoat");
    const json_t *sheen = extension_of(material, "KHR_materials_sheen");
    const double index = number_or(json_object_get(ior, "ior"), 1.5);
    out->ior = index == 0.0 ? 1e6f : (float)fmin(fmax(index, 1.0), 1e6); /* 0: all is reflected */
    out->specular = factor(specular, "specularFactor", 1.0, 0.0, 1.0);
    color(specular, "specularColorFactor", 1.0f, largest, out->specular_color);
    out->clearcoat = factor(coat, "clearcoatFactor", 0.0, 0.0, 1.0);
    out->clearcoat_roughness = factor(coat, "clearcoatRoughnessFactor", 0.0, 0.0, 1.0);
    color(sheen, "sheenColorFactor", 0.0f, 1.0, out->sheen_color);
    out->sheen_roughness = factor(sheen, "sheenRoughnessFactor", 0.0, 0.0, 1.0);
    out->unlit = extension_of(material, "KHR_materials_unlit") != NULL;
}

static void read_volume(const json_t *material, gw_material_extension *out) {
    const json_t *transmission = extension_of(material, "KHR_materials_transmission");
    const json_t *volume = extension_of(material, "KHR_materials_volume");
    out->transmission = factor(transmission, "transmissionFactor", 0.0, 0.0, 1.0);
    out->thickness = factor(volume, "thicknessFactor", 0.0, 0.0, largest);
    color(volume, "attenuationColor", 1.0f, 1.0, out->attenuation_color);
    out->attenuation_distance = factor(volume, "attenuationDistance", 0.0, 0.0, largest);
}

static void read_maps(const json_t *material, const gw_material *core, gw_material_extension *out) {
    if (gw_gltf_map(material, GW_MAP_NORMAL))
        out->normal_scale = factor(gw_gltf_map(material, GW_MAP_NORMAL), "scale", 1.0, -largest, largest);
    if (gw_gltf_map(material, GW_MAP_CLEARCOAT_NORMAL))
        out->clearcoat_normal_scale =
            factor(gw_gltf_map(material, GW_MAP_CLEARCOAT_NORMAL), "scale", 1.0, -largest, largest);
    if (gw_gltf_map(material, GW_MAP_OCCLUSION))
        out->occlusion_strength = factor(gw_gltf_map(material, GW_MAP_OCCLUSION), "strength", 1.0, 0.0, 1.0);
    if (gw_gltf_map(material, GW_MAP_METALLIC_ROUGHNESS)) {
        out->metalness = core->metalness;
        out->roughness = core->roughness;
    }
    if (gw_gltf_map(material, GW_MAP_EMISSIVE))
        memcpy(out->emissive, core->emissive, sizeof out->emissive);
}

void gw_gltf_specular(const json_t *material, float specular[4]) {
    const json_t *glossy = extension_of(material, SPECULAR_GLOSSINESS);
    if (!json_is_object(glossy))
        return;
    color(glossy, "specularFactor", 1.0f, 1.0, specular);
    specular[3] = factor(glossy, "glossinessFactor", 1.0, 0.0, 1.0);
}

int gw_gltf_extension(const json_t *material, const gw_material *core, gw_material_extension *out) {
    const gw_material_extension none = gw_material_extension_none();
    *out = none;
    read_surface(material, out);
    read_volume(material, out);
    read_maps(material, core, out);
    for (int map = GW_MAP_NORMAL; map < GW_MAP_SHOWN_COUNT; map++)
        if (gw_gltf_map(material, (gw_map)map))
            return 1;
    if (gw_gltf_map(material, GW_MAP_SPECULAR_GLOSSINESS)) /* which makes a metallic-roughness map */
        return 1;
    return memcmp(&none, out, sizeof none) != 0;
}
