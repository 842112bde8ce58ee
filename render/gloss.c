/* See gloss.h. */
#include "render/gloss.h"

#include "base/memory.h"
#include "render/transmission.h"

static void mark(uint8_t *used, const gw_texture_use *use) {
    if (use->texture >= 0)
        used[use->texture] = 1;
}

static uint8_t least_green(const gw_image *image) {
    const uint64_t texels = (uint64_t)image->width * image->height;
    uint8_t least = 255;
    for (uint64_t i = 0; i < texels; ++i)
        least = image->rgba[4 * i + 1] < least ? image->rgba[4 * i + 1] : least;
    return least;
}

gw_code gw_smoothest_texels(const gw_scene *scene, uint8_t **out, gw_error *error) {
    *out = NULL;
    if (scene->texture_count == 0 || !scene->extensions)
        return GW_OK;
    gw_code code = gw_allocate((void **)out, scene->texture_count, 1, "smoothest texels", error);
    if (code)
        return code;
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        mark(*out, &scene->extensions[i].metallic_roughness);
        mark(*out, &scene->extensions[i].clearcoat_roughness_map);
    }
    for (uint32_t i = 0; i < scene->texture_count; ++i)
        if ((*out)[i])
            (*out)[i] = least_green(&scene->textures[i].image);
    return GW_OK;
}

static float least_of(const gw_texture_use *use, const uint8_t *smoothest, float factor) {
    return smoothest ? factor * (float)smoothest[use->texture] * (1.0f / 255.0f) : 0.0f;
}

static int has_glossy_coat(const gw_material_extension *extension, const uint8_t *smoothest,
                           float glossy_roughness) {
    float roughness = extension->clearcoat_roughness;
    if (extension->clearcoat_roughness_map.texture >= 0)
        roughness = least_of(&extension->clearcoat_roughness_map, smoothest, roughness);
    return extension->clearcoat > 0.0f && roughness < glossy_roughness;
}

static int is_glossy(const gw_scene *scene, uint32_t number, const uint8_t *smoothest, float mirror_roughness,
                     float glossy_roughness) {
    const gw_material *material = &scene->materials[number];
    const gw_material_extension *extension = scene->extensions ? &scene->extensions[number] : NULL;
    float roughness = material->roughness;
    if (gw_lets_light_through(scene, number) || (extension && extension->unlit))
        return 0;
    if (extension && has_glossy_coat(extension, smoothest, glossy_roughness))
        return 1;
    if (material->metalness >= 1.0f && material->roughness <= mirror_roughness)
        return 0;
    if (extension && extension->metallic_roughness.texture >= 0)
        roughness = least_of(&extension->metallic_roughness, smoothest, extension->roughness);
    return roughness < glossy_roughness;
}

static int shines(const float color[3]) {
    return color[0] > 0.0f || color[1] > 0.0f || color[2] > 0.0f;
}

int gw_calls_for_gloss(const gw_scene *scene, const uint8_t *smoothest, float mirror_roughness,
                       float glossy_roughness) {
    int light = scene->light_count > 0 || scene->environment.rgbe.rgba || shines(scene->ambient) ||
                shines(scene->background);
    int glossy = 0;
    uint32_t last = UINT32_MAX;
    for (uint32_t i = 0; i < scene->triangle_count && !(light && glossy) && glossy_roughness > 0.0f; ++i) {
        const uint32_t material = scene->material_of[i];
        if (material == last)
            continue;
        light = light || shines(scene->materials[material].emissive);
        glossy = glossy || is_glossy(scene, material, smoothest, mirror_roughness, glossy_roughness);
        last = material;
    }
    return light && glossy;
}
