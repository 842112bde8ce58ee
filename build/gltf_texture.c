/* From a glTF material's maps to pictures: sources of the model, and what their texture coordinates are. */
#include "build/gltf_material.h"

#include "base/memory.h"
#include "build/model_path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gw_wrap wrap_of(const json_t *sampler, const char *key) {
    enum { CLAMP = 33071, MIRROR = 33648 };
    const json_int_t mode = json_integer_value(json_object_get(sampler, key));
    return mode == CLAMP ? GW_WRAP_CLAMP : mode == MIRROR ? GW_WRAP_MIRROR : GW_WRAP_REPEAT;
}

static gw_code fill_source(gw_gltf_data *data, size_t image, gw_texture_source *out, gw_error *error) {
    const char *uri = gw_gltf_image_file(data->gltf, image);
    char name[32];
    snprintf(name, sizeof name, "image %zu", image);
    out->path = gw_copy_text(uri ? uri : name);
    out->alpha_path = gw_copy_text("");
    if (!out->path || !out->alpha_path)
        return gw_fail(error, GW_MACHINE, "out of memory for a texture's name");
    if (uri) {
        gw_uri_decode(out->path);
        return GW_OK;
    }
    gw_bytes bytes = {0};
    gw_code code = gw_gltf_image_bytes(data, image, &bytes, error);
    out->bytes = bytes.data;
    out->size = bytes.size;
    return code;
}

static int same_source(const gw_texture_source *a, const gw_texture_source *b) {
    return a->image == b->image && a->wrap_u == b->wrap_u && a->wrap_v == b->wrap_v &&
           a->nearest == b->nearest;
}

/* Finds the texture's source among the model's, or adds it; -1 when it names no picture. */
static gw_code find_source(gw_gltf_data *data, size_t texture_index, gw_source_model *model, int32_t *index,
                           gw_error *error) {
    enum { NEAREST = 9728 };
    const json_t *texture = json_array_get(json_object_get(data->gltf->root, "textures"), texture_index);
    const json_t *image = json_object_get(texture, "source");
    const json_t *sampler = json_array_get(json_object_get(data->gltf->root, "samplers"),
                                           (size_t)json_integer_value(json_object_get(texture, "sampler")));
    if (!json_object_get(texture, "sampler"))
        sampler = NULL;
    gw_texture_source wanted = {.image = json_is_integer(image) ? (int32_t)json_integer_value(image) : -1,
                                .wrap_u = wrap_of(sampler, "wrapS"),
                                .wrap_v = wrap_of(sampler, "wrapT"),
                                .nearest =
                                    json_integer_value(json_object_get(sampler, "magFilter")) == NEAREST};
    *index = -1;
    if (wanted.image < 0)
        return gw_scene_note(model->scene, error, "glTF texture %zu names no picture that can be read",
                             texture_index);
    for (uint32_t i = 0; i < model->source_count; i++)
        if (same_source(&model->sources[i], &wanted))
            *index = (int32_t)i;
    if (*index >= 0)
        return GW_OK;
    gw_texture_source *grown = realloc(model->sources, (model->source_count + 1) * sizeof *grown);
    if (!grown)
        return gw_fail(error, GW_MACHINE, "out of memory for textures");
    model->sources = grown;
    gw_code code = fill_source(data, (size_t)wanted.image, &wanted, error);
    *index = (int32_t)model->source_count;
    model->sources[model->source_count++] = wanted; /* also after a failure: the model owns what it holds */
    return code;
}

/* --- texture coordinates --- */

/* from -> to of two transforms; equal ones give exactly no transform, and a flat one that of `to`. */
static void change_transform(const double from[2][3], const double to[2][3], float out[2][3]) {
    const double determinant = from[0][0] * from[1][1] - from[0][1] * from[1][0];
    const int same = memcmp(from, to, 6 * sizeof(double)) == 0;
    const double inverse[2][2] = {{from[1][1] / determinant, -from[0][1] / determinant},
                                  {-from[1][0] / determinant, from[0][0] / determinant}};
    for (int i = 0; i < 2; i++) {
        double row[3] = {to[i][0] * inverse[0][0] + to[i][1] * inverse[1][0],
                         to[i][0] * inverse[0][1] + to[i][1] * inverse[1][1], 0};
        row[2] = to[i][2] - row[0] * from[0][2] - row[1] * from[1][2];
        for (int k = 0; k < 3; k++)
            out[i][k] = same                   ? (k == i ? 1.0f : 0.0f)
                        : fabs(row[k]) <= 1e30 ? (float)row[k]
                                               : (float)to[i][k];
    }
}

/* The texture coordinates of the base colour have its transform in them already. */
static int place_use(const json_t *material, const json_t *map, int has_second, gw_texture_use *use) {
    static const double nothing[2][3] = {{1, 0, 0}, {0, 1, 0}};
    const json_t *base = gw_gltf_map(material, GW_MAP_BASE_COLOR);
    double base_transform[2][3], transform[2][3];
    int32_t sets[2];
    gw_gltf_texcoord_sets(material, sets);
    const int32_t set = gw_gltf_texcoord_set(map);
    gw_gltf_texture_transform(map, transform);
    gw_gltf_texture_transform(base, base_transform);
    use->coordinate = set == sets[0] || !has_second ? 0 : 1; /* no mesh that shows the material has more */
    change_transform(base && use->coordinate == 0 ? (const double(*)[3])base_transform : nothing,
                     (const double(*)[3])transform, use->to_uv);
    return set == sets[0] || set == sets[1];
}

/* Both pictures are converted texel by texel. */
static int glossiness_lies_elsewhere(const json_t *material) {
    const json_t *specular = gw_gltf_map(material, GW_MAP_SPECULAR_GLOSSINESS);
    const json_t *diffuse = gw_gltf_map(material, GW_MAP_BASE_COLOR);
    double transforms[2][2][3];
    gw_gltf_texture_transform(diffuse, transforms[0]);
    gw_gltf_texture_transform(specular, transforms[1]);
    return specular && (memcmp(transforms[0], transforms[1], sizeof transforms[0]) != 0 ||
                        (diffuse && gw_gltf_texcoord_set(diffuse) != gw_gltf_texcoord_set(specular)));
}

gw_code gw_gltf_map_sources(gw_gltf_data *data, const json_t *material, uint32_t index,
                            gw_source_model *model, gw_error *error) {
    gw_material_source *source = &model->material_sources[index];
    gw_code code = GW_OK;
    if (glossiness_lies_elsewhere(material))
        code = gw_scene_note(
            model->scene, error,
            "glTF material '%s': texture coordinates of its specular-glossiness map alone are not "
            "followed",
            model->scene->materials[index].name);
    for (int map = 0; code == GW_OK && map < GW_MAP_COUNT; map++) {
        const json_t *info = gw_gltf_map(material, (gw_map)map);
        const json_int_t texture = json_integer_value(json_object_get(info, "index"));
        const size_t count = json_array_size(json_object_get(data->gltf->root, "textures"));
        gw_texture_use *use = info && model->scene->extensions
                                  ? gw_texture_use_of(&model->scene->extensions[index], (gw_map)map)
                                  : NULL;
        source->maps[map] = -1;
        if (!info)
            continue;
        if (texture < 0 || (size_t)texture >= count)
            return gw_fail(error, GW_BAD_INPUT, "glTF material '%s' names texture %lld of %zu",
                           model->scene->materials[index].name, (long long)texture, count);
        if (use && !place_use(material, info, model->scene->second_texcoords != NULL, use))
            code =
                gw_scene_note(model->scene, error,
                              "glTF material '%s': maps read more than two sets of texture coordinates; what "
                              "reads a third is left out",
                              model->scene->materials[index].name);
        else
            code = find_source(data, (size_t)texture, model, &source->maps[map], error);
    }
    return code;
}
