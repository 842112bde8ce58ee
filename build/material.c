/* What materials have beyond gw_material: scene.h. */
#include "build/scene.h"

#include "base/memory.h"

#include <math.h>

static const float largest = 1e30f;

gw_material_extension gw_material_extension_none(void) {
    const gw_texture_use none = {.texture = -1, .to_uv = {{1, 0, 0}, {0, 1, 0}}};
    return (gw_material_extension){.normal = none,
                                   .normal_scale = 1,
                                   .metallic_roughness = none,
                                   .occlusion = none,
                                   .occlusion_strength = 1,
                                   .emissive_map = none,
                                   .ior = 1.5f,
                                   .specular = 1,
                                   .specular_color = {1, 1, 1},
                                   .transmission_map = none,
                                   .attenuation_color = {1, 1, 1},
                                   .clearcoat_map = none,
                                   .clearcoat_roughness_map = none,
                                   .clearcoat_normal = none,
                                   .clearcoat_normal_scale = 1,
                                   .sheen_color_map = none,
                                   .sheen_roughness_map = none,
                                   .specular_map = none,
                                   .specular_color_map = none};
}

gw_texture_use *gw_texture_use_of(gw_material_extension *extension, gw_map map) {
    gw_texture_use *const uses[GW_MAP_COUNT] = {
        [GW_MAP_NORMAL] = &extension->normal,
        [GW_MAP_METALLIC_ROUGHNESS] = &extension->metallic_roughness,
        [GW_MAP_OCCLUSION] = &extension->occlusion,
        [GW_MAP_EMISSIVE] = &extension->emissive_map,
        [GW_MAP_TRANSMISSION] = &extension->transmission_map,
        [GW_MAP_CLEARCOAT] = &extension->clearcoat_map,
        [GW_MAP_CLEARCOAT_ROUGHNESS] = &extension->clearcoat_roughness_map,
        [GW_MAP_CLEARCOAT_NORMAL] = &extension->clearcoat_normal,
        [GW_MAP_SHEEN_COLOR] = &extension->sheen_color_map,
        [GW_MAP_SHEEN_ROUGHNESS] = &extension->sheen_roughness_map,
        [GW_MAP_SPECULAR] = &extension->specular_map,
        [GW_MAP_SPECULAR_COLOR] = &extension->specular_color_map,
    };
    return map < GW_MAP_COUNT ? uses[map] : NULL;
}

static int use_is_wrong(const gw_scene *scene, const gw_texture_use *use) {
    int wrong = use->texture < -1 || use->texture >= (int64_t)scene->texture_count || use->coordinate < 0 ||
                use->coordinate > (scene->second_texcoords ? 1 : 0);
    for (int i = 0; i < 6; i++)
        wrong = wrong || !(fabsf(use->to_uv[i / 3][i % 3]) <= largest);
    return wrong;
}

static int all_within(const float *values, size_t count, float least, float most) {
    for (size_t i = 0; i < count; i++)
        if (!(values[i] >= least && values[i] <= most))
            return 0;
    return 1;
}

const char *gw_material_extension_fault(const gw_scene *scene, uint32_t i) {
    const gw_material_extension *e = &scene->extensions[i];
    for (int map = GW_MAP_NORMAL; map < GW_MAP_SHOWN_COUNT; map++)
        if (use_is_wrong(scene, gw_texture_use_of(&scene->extensions[i], (gw_map)map)))
            return "a map whose picture or texture coordinates are not there";
    const struct {
        const float *values;
        size_t count;
        float least, most;
        const char *fault;
    } ranges[] = {
        {&e->normal_scale, 1, -largest, largest, "a scale of its normal map that is no number"},
        {&e->clearcoat_normal_scale, 1, -largest, largest,
         "a scale of its clearcoat's normal map that is no number"},
        {&e->metalness, 1, 0, 1, "a metalness outside 0..1"},
        {&e->roughness, 1, 0, 1, "a roughness outside 0..1"},
        {&e->occlusion_strength, 1, 0, 1, "a strength of its occlusion map outside 0..1"},
        {e->emissive, 3, 0, largest, "an emission below 0 or no number"},
        {&e->ior, 1, 1, largest, "an index of refraction below 1"},
        {&e->specular, 1, 0, 1, "a specular factor outside 0..1"},
        {e->specular_color, 3, 0, largest, "a specular colour below 0 or no number"},
        {&e->transmission, 1, 0, 1, "a transmission outside 0..1"},
        {&e->thickness, 1, 0, largest, "a thickness below 0 or no number"},
        {e->attenuation_color, 3, 0, 1, "an attenuation colour outside 0..1"},
        {&e->attenuation_distance, 1, 0, largest, "an attenuation distance below 0 or no number"},
        {&e->clearcoat, 1, 0, 1, "a clearcoat outside 0..1"},
        {&e->clearcoat_roughness, 1, 0, 1, "a roughness of its clearcoat outside 0..1"},
        {e->sheen_color, 3, 0, 1, "a sheen colour outside 0..1"},
        {&e->sheen_roughness, 1, 0, 1, "a roughness of its sheen outside 0..1"},
    };
    for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
        if (!all_within(ranges[k].values, ranges[k].count, ranges[k].least, ranges[k].most))
            return ranges[k].fault;
    return e->unlit == 0 || e->unlit == 1 ? NULL : "an unlit flag that is neither 0 nor 1";
}

gw_code gw_scene_extend_materials(gw_scene *scene, gw_error *error) {
    if (scene->extensions || scene->material_count == 0)
        return GW_OK;
    gw_code code = gw_allocate((void **)&scene->extensions, scene->material_count, sizeof *scene->extensions,
                               "material extensions", error);
    for (uint32_t i = 0; code == GW_OK && i < scene->material_count; i++)
        scene->extensions[i] = gw_material_extension_none();
    return code;
}
