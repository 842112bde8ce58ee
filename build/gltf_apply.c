/* What assimp 5.2.5 drops of a glTF file, put back from its JSON; and the names of what is not carried. */
#include "build/gltf.h"

#include "base/memory.h"
#include "build/gltf_material.h"
#include "build/gltf_tangents.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* LOOKS: surfaces are drawn without it, which is said; STRUCTURE: without it there is no geometry or picture.
 */
typedef enum extension_kind { CARRIED, LOOKS, STRUCTURE } extension_kind;

static const struct {
    const char *name;
    extension_kind kind;
} extensions[] = {
    {"KHR_lights_punctual", CARRIED},
    {"KHR_materials_emissive_strength", CARRIED},
    {"KHR_materials_pbrSpecularGlossiness", CARRIED},
    {"KHR_texture_transform", CARRIED},
    {"KHR_materials_anisotropy", LOOKS},
    {"KHR_materials_clearcoat", CARRIED},
    {"KHR_materials_dispersion", LOOKS},
    {"KHR_materials_ior", CARRIED},
    {"KHR_materials_iridescence", LOOKS},
    {"KHR_materials_sheen", CARRIED},
    {"KHR_materials_specular", CARRIED},
    {"KHR_materials_transmission", CARRIED},
    {"KHR_materials_unlit", CARRIED},
    {"KHR_materials_variants", LOOKS},
    {"KHR_materials_volume", CARRIED},
    {"KHR_xmp", LOOKS},
    {"KHR_xmp_json_ld", LOOKS},
    {"EXT_mesh_gpu_instancing", STRUCTURE},
    {"EXT_meshopt_compression", STRUCTURE},
    {"EXT_texture_webp", STRUCTURE},
    {"KHR_draco_mesh_compression", STRUCTURE},
    {"KHR_mesh_quantization", STRUCTURE},
    {"KHR_texture_basisu", STRUCTURE},
};

static int names_contain(const json_t *names, const char *name) {
    for (size_t i = 0; i < json_array_size(names); i++) {
        const char *text = json_string_value(json_array_get(names, i));
        if (text && strcmp(text, name) == 0)
            return 1;
    }
    return 0;
}

static gw_code check_extension(const char *name, int required, gw_source_model *model, gw_error *error) {
    int known = 0;
    extension_kind kind = STRUCTURE;
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (strcmp(name, extensions[i].name) == 0) {
            known = 1;
            kind = extensions[i].kind;
        }
    if (known && kind == CARRIED)
        return GW_OK;
    if (required && kind == STRUCTURE)
        return gw_fail(error, GW_BAD_INPUT,
                       "the file requires the glTF extension '%.100s', which is %s: export it without", name,
                       known ? "not supported" : "unknown here");
    if (!model)
        return GW_OK;
    return gw_scene_note(model->scene, error, "glTF extension %.100s%s: %s", name,
                         required ? " (required)" : "",
                         known ? "not carried, drawn without it" : "unknown, ignored");
}

gw_code gw_gltf_check_extensions(const gw_gltf *gltf, gw_source_model *model, gw_error *error) {
    const json_t *used = json_object_get(gltf->root, "extensionsUsed");
    const json_t *required = json_object_get(gltf->root, "extensionsRequired");
    gw_code code = GW_OK;
    for (size_t i = 0; code == GW_OK && i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (name)
            code = check_extension(name, 1, model, error);
    }
    for (size_t i = 0; code == GW_OK && i < json_array_size(used); i++) {
        const char *name = json_string_value(json_array_get(used, i));
        if (name && !names_contain(required, name))
            code = check_extension(name, 0, model, error);
    }
    return code;
}

/* --- materials --- */

static double number_or(const json_t *value, double missing) {
    const double number = json_is_number(value) ? json_number_value(value) : missing;
    return isfinite(number) ? number : missing;
}

static void transform_texcoord(float texcoord[2], const double to_uv[2][3]) {
    const double u = texcoord[0], v = texcoord[1];
    for (int i = 0; i < 2; i++)
        texcoord[i] = (float)(to_uv[i][0] * u + to_uv[i][1] * v + to_uv[i][2]);
}

/* The import child makes every vertex belong to one material, so texture coordinates can be moved for good.
 */
static gw_code apply_transforms(const json_t *materials, gw_source_model *model, gw_error *error) {
    gw_scene *scene = model->scene;
    uint8_t *moved = NULL;
    if (!scene->texcoords || scene->vertex_count == 0)
        return GW_OK;
    gw_code code = gw_allocate((void **)&moved, scene->vertex_count, 1, "texture transforms", error);
    for (uint32_t i = 0; code == GW_OK && i < scene->triangle_count; i++) {
        double to_uv[2][3];
        const uint32_t material = scene->material_of[i];
        if (material >= scene->material_count || model->material_sources[material].file_index < 0)
            continue;
        const json_t *base =
            gw_gltf_map(json_array_get(materials, (size_t)model->material_sources[material].file_index),
                        GW_MAP_BASE_COLOR);
        if (!json_object_get(json_object_get(base, "extensions"), "KHR_texture_transform"))
            continue;
        gw_gltf_texture_transform(base, to_uv);
        for (int k = 0; k < 3; k++) {
            const uint32_t vertex = scene->triangles[i][k];
            if (vertex >= scene->vertex_count || moved[vertex])
                continue;
            moved[vertex] = 1;
            transform_texcoord(scene->texcoords + (size_t)vertex * 2, (const double(*)[3])to_uv);
        }
    }
    free(moved);
    return code;
}

static void apply_material(const json_t *source, gw_material *material, size_t index) {
    const char *name = json_string_value(json_object_get(source, "name"));
    if (name && *name)
        snprintf(material->name, sizeof material->name, "%s", name);
    else
        snprintf(material->name, sizeof material->name, "material %zu", index);
    const json_t *strength =
        json_object_get(json_object_get(source, "extensions"), "KHR_materials_emissive_strength");
    const double factor = number_or(json_object_get(strength, "emissiveStrength"), 1.0);
    for (int i = 0; i < 3 && factor >= 0.0; i++)
        material->emissive[i] = (float)fmin(material->emissive[i] * factor, 1e30);
}

/* --- notes on what is not carried --- */

static size_t count_maps(const json_t *materials, gw_map map) {
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(materials); i++)
        count += gw_gltf_map(json_array_get(materials, i), map) != NULL;
    return count;
}

static gw_code note_count(gw_source_model *model, size_t count, const char *what, gw_error *error) {
    return count ? gw_scene_note(model->scene, error, "glTF: %zu %s", count, what) : GW_OK;
}

static json_t *punctual(const json_t *object) {
    return json_object_get(json_object_get(object, "extensions"), "KHR_lights_punctual");
}

static gw_code note_losses(const gw_gltf *gltf, gw_source_model *model, gw_error *error) {
    const json_t *materials = json_object_get(gltf->root, "materials");
    gw_code code = note_count(model, count_maps(materials, GW_MAP_THICKNESS),
                              "materials with a thickness map: its mean is used, which only shadows ask for: "
                              "rays go through the volume itself",
                              error);
    return code == GW_OK ? gw_gltf_note_tangents(gltf, model->scene, error) : code;
}

/* The standard's default is a white mirror-like metal, which shows nothing; the import child took a rough
 * grey. */
static gw_code note_bare_triangles(gw_source_model *model, gw_error *error) {
    const gw_scene *scene = model->scene;
    size_t count = 0;
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        count += scene->material_of[i] < scene->material_count &&
                 model->material_sources[scene->material_of[i]].file_index < 0;
    return note_count(model, count, "triangles without a material: a rough light grey one is used", error);
}

/* In a file that moves, the import child saw "#index" for a camera's node. */
static void name_viewpoints(const gw_gltf *gltf, gw_scene *scene) {
    const json_t *nodes = json_object_get(gltf->root, "nodes");
    for (uint32_t i = 0; i < scene->viewpoint_count; i++) {
        gw_viewpoint *view = &scene->viewpoints[i];
        const size_t node = strtoul(view->name + (view->name[0] == '#'), NULL, 10);
        const char *name = json_string_value(json_object_get(json_array_get(nodes, node), "name"));
        if (name && *name)
            snprintf(view->name, sizeof view->name, "%s", name);
        else
            snprintf(view->name, sizeof view->name, "nodes_%zu", node);
    }
}

/* Names, factors and pictures of all materials. */
static gw_code apply_materials(const gw_gltf *gltf, const char *folder, gw_source_model *model,
                               gw_error *error) {
    const json_t *materials = json_object_get(gltf->root, "materials");
    gw_scene *scene = model->scene;
    gw_gltf_data data = {0};
    int extended = 0;
    gw_code code = gw_gltf_data_open(gltf, folder, &data, error);
    if (code == GW_OK)
        code = gw_scene_extend_materials(scene, error);
    for (uint32_t i = 0; code == GW_OK && i < scene->material_count; i++) {
        const int32_t index = model->material_sources[i].file_index;
        const json_t *source = index >= 0 ? json_array_get(materials, (size_t)index) : NULL;
        if (!source)
            continue;
        apply_material(source, &scene->materials[i], (size_t)index);
        extended |= gw_gltf_extension(source, &scene->materials[i], &scene->extensions[i]);
        gw_gltf_specular(source, model->material_sources[i].specular);
        code = gw_gltf_map_sources(&data, source, i, model, error);
    }
    if (!extended) {
        free(scene->extensions);
        scene->extensions = NULL;
    }
    gw_gltf_data_close(&data);
    return code;
}

gw_code gw_gltf_apply(const gw_gltf *gltf, const char *folder, gw_source_model *model, gw_error *error) {
    const json_t *materials = json_object_get(gltf->root, "materials");
    gw_code code = apply_transforms(materials, model, error);
    if (code == GW_OK)
        code = note_bare_triangles(model, error);
    if (code == GW_OK)
        code = apply_materials(gltf, folder, model, error);
    if (gw_gltf_moves(gltf))
        name_viewpoints(gltf, model->scene);
    if (code == GW_OK)
        code = note_losses(gltf, model, error);
    return code;
}

/* --- promised triangles --- */

uint64_t gw_gltf_promised_triangles(const gw_gltf *gltf) {
    enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };
    const json_t *meshes = json_object_get(gltf->root, "meshes");
    const json_t *accessors = json_object_get(gltf->root, "accessors");
    uint64_t sum = 0;
    for (size_t i = 0; i < json_array_size(meshes); i++) {
        const json_t *primitives = json_object_get(json_array_get(meshes, i), "primitives");
        for (size_t k = 0; k < json_array_size(primitives); k++) {
            const json_t *primitive = json_array_get(primitives, k);
            const json_t *mode = json_object_get(primitive, "mode");
            const json_t *indices = json_object_get(primitive, "indices");
            const json_t *positions = json_object_get(json_object_get(primitive, "attributes"), "POSITION");
            const size_t accessor = (size_t)json_integer_value(indices ? indices : positions);
            const json_int_t count =
                json_integer_value(json_object_get(json_array_get(accessors, accessor), "count"));
            const json_int_t kind = mode ? json_integer_value(mode) : TRIANGLES;
            if (kind == TRIANGLES)
                sum += (uint64_t)count / 3;
            else if ((kind == STRIP || kind == FAN) && count > 2)
                sum += (uint64_t)count - 2;
        }
    }
    return sum;
}

/* --- marking --- */

int gw_gltf_moves(const gw_gltf *gltf) {
    return json_array_size(json_object_get(gltf->root, "animations")) > 0 ||
           json_array_size(json_object_get(gltf->root, "skins")) > 0;
}

static void write_u32(uint8_t *data, uint32_t value) {
    for (int i = 0; i < 4; i++)
        data[i] = (uint8_t)(value >> (8 * i));
}

/* A .glb of the JSON text and the old BIN chunk. */
static gw_code pack_container(const gw_gltf *gltf, const char *text, size_t text_size, gw_bytes *out,
                              gw_error *error) {
    const size_t json_size = (text_size + 3) & ~(size_t)3, bin_size = (gltf->chunk_size + 3) & ~(size_t)3;
    const size_t total = 12 + 8 + json_size + (gltf->chunk ? 8 + bin_size : 0);
    if (total > UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT, "the .glb file is larger than 4 GiB");
    gw_code code = gw_allocate((void **)&out->data, total + 1, 1, "glTF file", error);
    if (code != GW_OK)
        return code;
    out->size = total;
    uint8_t *to = out->data;
    memcpy(to, "glTF", 4);
    write_u32(to + 4, 2);
    write_u32(to + 8, (uint32_t)total);
    write_u32(to + 12, (uint32_t)json_size);
    memcpy(to + 16, "JSON", 4);
    memset(to + 20, ' ', json_size);
    memcpy(to + 20, text, text_size);
    to += 20 + json_size;
    if (gltf->chunk) {
        write_u32(to, (uint32_t)bin_size);
        memcpy(to + 4, "BIN\0", 4);
        memcpy(to + 8, gltf->chunk, gltf->chunk_size);
    }
    return GW_OK;
}

static gw_code mark_list(gw_gltf *gltf, const char *list, gw_error *error) {
    json_t *objects = json_object_get(gltf->root, list);
    for (size_t i = 0; i < json_array_size(objects); i++)
        if (json_object_set_new(json_array_get(objects, i), "name", json_sprintf("#%zu", i)) != 0)
            return gw_fail(error, GW_MACHINE, "out of memory for names of %s", list);
    return GW_OK;
}

/* A light of the same kind and values at the end of the list; what says nothing about light stays behind. */
static int copy_light(json_t *lights, size_t index) {
    static const char *const rest[] = {"name", "extras", "extensions"};
    json_t *copy = json_copy(json_array_get(lights, index));
    for (size_t i = 0; i < sizeof rest / sizeof rest[0]; i++)
        json_object_del(copy, rest[i]);
    return json_array_append_new(lights, copy);
}

/* assimp keeps one place for each light, however many nodes carry it, and ties the two by the node's name: so
 * every node gets a light, and a name, of its own. */
static gw_code part_lights(gw_gltf *gltf, gw_error *error) {
    const json_t *nodes = json_object_get(gltf->root, "nodes");
    json_t *lights = json_object_get(punctual(gltf->root), "lights");
    const size_t count = json_array_size(lights);
    uint8_t *seen = NULL;
    gw_code code = gw_allocate((void **)&seen, count, 1, "lights", error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(nodes); i++) {
        json_t *node = json_array_get(nodes, i), *carried = punctual(node);
        const json_t *light = json_object_get(carried, "light");
        const json_int_t index = json_is_integer(light) ? json_integer_value(light) : -1;
        if (index < 0 || index >= (json_int_t)count || !json_is_object(json_array_get(lights, (size_t)index)))
            continue;
        int failed = 0;
        if (seen[index]) {
            failed = copy_light(lights, (size_t)index);
            failed |=
                json_object_set_new(carried, "light", json_integer((json_int_t)json_array_size(lights) - 1));
        }
        seen[index] = 1;
        if (!json_object_get(node, "camera"))
            failed |= json_object_set_new(node, "name", json_sprintf("#%zu", i));
        if (failed)
            code = gw_fail(error, GW_MACHINE, "out of memory for the glTF file's lights");
    }
    free(seen);
    return code;
}

gw_code gw_gltf_mark(gw_gltf *gltf, gw_bytes *out, gw_error *error) {
    *out = (gw_bytes){0};
    gw_code code = part_lights(gltf, error);
    gw_gltf_strip_tangents(gltf);
    if (code == GW_OK)
        code = mark_list(gltf, "materials", error);
    if (code == GW_OK && gw_gltf_moves(gltf))
        code = mark_list(gltf, "nodes", error);
    if (code == GW_OK && gw_gltf_moves(gltf))
        code = mark_list(gltf, "meshes", error);
    if (code != GW_OK)
        return code;
    char *text = json_dumps(gltf->root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!text)
        return gw_fail(error, GW_MACHINE, "out of memory for the glTF text");
    if (!gltf->binary) {
        out->data = (uint8_t *)text;
        out->size = strlen(text);
        return GW_OK;
    }
    code = pack_container(gltf, text, strlen(text), out, error);
    free(text);
    return code;
}
