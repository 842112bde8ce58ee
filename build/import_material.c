/* Materials as assimp 5.2.5 gives them, put into our terms. Runs in the import child. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "build/model_path.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

float gw_linear_from_srgb(float value) {
    return (float)gw_srgb_to_linear((double)value);
}

float gw_import_share(double value) {
    return value > 0.0 ? (float)fmin(value, 1.0) : 0.0f; /* also for values that are not numbers */
}

/* Embedded textures are called "*3"; NULL for all others. */
static const struct aiTexture *embedded_texture(const struct aiScene *read, const char *path) {
    if (path[0] != '*')
        return NULL;
    const unsigned long index = strtoul(path + 1, NULL, 10);
    return index < read->mNumTextures ? read->mTextures[index] : NULL;
}

static gw_code embed(const struct aiTexture *texture, gw_texture_source *source, gw_error *error) {
    const uint64_t pixels = (uint64_t)texture->mWidth * texture->mHeight;
    source->size = texture->mHeight ? (size_t)pixels * 4 : texture->mWidth;
    gw_code code = gw_allocate((void **)&source->bytes, source->size, 1, "embedded texture", error);
    if (code != GW_OK || source->size == 0)
        return code;
    if (texture->mHeight == 0) {
        memcpy(source->bytes, texture->pcData, source->size);
        return GW_OK;
    }
    source->raw_width = texture->mWidth;
    source->raw_height = texture->mHeight;
    for (uint64_t i = 0; i < pixels; i++) {
        const struct aiTexel *texel = &texture->pcData[i];
        const uint8_t rgba[4] = {texel->r, texel->g, texel->b, texel->a};
        memcpy(source->bytes + i * 4, rgba, 4);
    }
    return GW_OK;
}

static gw_wrap wrap_of(enum aiTextureMapMode mode) {
    return mode == aiTextureMapMode_Mirror ? GW_WRAP_MIRROR
           : mode == aiTextureMapMode_Wrap ? GW_WRAP_REPEAT
                                           : GW_WRAP_CLAMP;
}

static int same_source(const gw_texture_source *a, const gw_texture_source *b) {
    return strcmp(a->path, b->path) == 0 && strcmp(a->alpha_path, b->alpha_path) == 0 &&
           a->wrap_u == b->wrap_u && a->wrap_v == b->wrap_v;
}

/* Finds the source among the model's, or adds it; *index is its place. Takes what `wanted` owns. */
static gw_code add_source(const struct aiScene *read, gw_texture_source *wanted, gw_source_model *model,
                          int32_t *index, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < model->source_count; i++)
        if (same_source(&model->sources[i], wanted)) {
            *index = (int32_t)i;
            goto cleanup;
        }
    gw_texture_source *grown = realloc(model->sources, (model->source_count + 1) * sizeof *grown);
    if (!grown) {
        code = gw_fail(error, GW_MACHINE, "out of memory for textures");
        goto cleanup;
    }
    model->sources = grown;
    const struct aiTexture *embedded = embedded_texture(read, wanted->path);
    if (embedded)
        code = embed(embedded, wanted, error);
    if (code != GW_OK)
        goto cleanup;
    *index = (int32_t)model->source_count;
    grown[model->source_count++] = *wanted;
    return GW_OK;
cleanup:
    free(wanted->path);
    free(wanted->alpha_path);
    free(wanted->bytes);
    return code;
}

gw_code gw_import_texture(const struct aiScene *read, const struct aiMaterial *from, int type, int alpha,
                          gw_source_model *model, int32_t *index, gw_error *error) {
    struct aiString path = {0}, alpha_path = {0};
    enum aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    *index = -1;
    if (aiGetMaterialTexture(from, (enum aiTextureType)type, 0, &path, NULL, NULL, NULL, NULL, modes, NULL) !=
            aiReturn_SUCCESS ||
        path.length == 0)
        return GW_OK;
    if (alpha != aiTextureType_NONE)
        aiGetMaterialTexture(from, (enum aiTextureType)alpha, 0, &alpha_path, NULL, NULL, NULL, NULL, NULL,
                             NULL);
    if (strcmp(alpha_path.data, path.data) == 0)
        alpha_path.data[0] = '\0'; /* the picture's own alpha channel is meant */
    gw_texture_source source = {.path = gw_copy_text(path.data),
                                .alpha_path = gw_copy_text(alpha_path.data),
                                .wrap_u = wrap_of(modes[0]),
                                .wrap_v = wrap_of(modes[1]),
                                .image = -1};
    if (!source.path || !source.alpha_path) {
        free(source.path);
        free(source.alpha_path);
        return gw_fail(error, GW_MACHINE, "out of memory for a texture's name");
    }
    return add_source(read, &source, model, index, error);
}

float gw_import_float(const struct aiMaterial *from, const char *key, float missing) {
    ai_real value = missing;
    if (aiGetMaterialFloatArray(from, key, 0, 0, &value, NULL) != aiReturn_SUCCESS || !isfinite(value))
        return missing;
    return (float)value;
}

int gw_import_color(const struct aiMaterial *from, const char *key, struct aiColor4D *color) {
    return aiGetMaterialColor(from, key, 0, 0, color) == aiReturn_SUCCESS;
}

void gw_import_set_color(float *out, const struct aiColor4D *color, int srgb, float maximum) {
    const float channels[3] = {(float)color->r, (float)color->g, (float)color->b};
    for (int i = 0; i < 3; i++) {
        float value = isfinite(channels[i]) ? fminf(fmaxf(channels[i], 0.0f), maximum) : 0.0f;
        out[i] = srgb ? gw_linear_from_srgb(fminf(value, 1.0f)) : value;
    }
}

static gw_alpha_mode alpha_mode_of(const struct aiMaterial *from) {
    struct aiString mode = {0};
    if (aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) != aiReturn_SUCCESS)
        return GW_ALPHA_OPAQUE;
    return strcmp(mode.data, "MASK") == 0    ? GW_ALPHA_MASK
           : strcmp(mode.data, "BLEND") == 0 ? GW_ALPHA_BLEND
                                             : GW_ALPHA_OPAQUE;
}

int32_t gw_import_material_index(const struct aiMaterial *from) {
    struct aiString name = {0};
    if (aiGetMaterialString(from, AI_MATKEY_NAME, &name) != aiReturn_SUCCESS || name.data[0] != '#')
        return -1;
    return (int32_t)strtol(name.data + 1, NULL, 10);
}

/* The factors that assimp carries; pictures and extensions come from the JSON (gw_gltf_apply()). */
static void gltf_material(const struct aiMaterial *from, gw_material *to, gw_material_source *source) {
    struct aiColor4D color = {1, 1, 1, 1};
    int two_sided = 0;
    const float glossiness = gw_import_float(from, "$mat.glossinessFactor", -1.0f);
    source->file_index = gw_import_material_index(from);
    if (source->file_index < 0) {
        snprintf(to->name, sizeof to->name, "default"); /* assimp's own, for primitives that name none */
        return;
    }
    if (glossiness >= 0.0f || !gw_import_color(from, "$clr.base", &color))
        gw_import_color(from, "$clr.diffuse", &color);
    gw_import_set_color(to->base_color, &color, 0, 1.0f);
    to->base_color[3] = gw_import_share((double)color.a);
    to->metalness = glossiness >= 0.0f
                        ? 0.0f
                        : gw_import_share((double)gw_import_float(from, "$mat.metallicFactor", 1.0f));
    to->roughness =
        gw_import_share(glossiness >= 0.0f ? 1.0 - (double)glossiness
                                           : (double)gw_import_float(from, "$mat.roughnessFactor", 1.0f));
    color = (struct aiColor4D){0, 0, 0, 1};
    gw_import_color(from, "$clr.emissive", &color);
    gw_import_set_color(to->emissive, &color, 0, 1e6f);
    to->alpha_mode = alpha_mode_of(from);
    to->alpha_cutoff = fmaxf(0.0f, gw_import_float(from, "$mat.gltf.alphaCutoff", 0.5f));
    aiGetMaterialIntegerArray(from, AI_MATKEY_TWOSIDED, &two_sided, NULL);
    to->two_sided = two_sided != 0;
}

gw_code gw_import_material(const struct aiScene *read, const struct aiMaterial *from, gw_model_format format,
                           const gw_import_files *files, gw_source_model *model, uint32_t index,
                           gw_error *error) {
    gw_material *to = &model->scene->materials[index];
    gw_material_source *source = &model->material_sources[index];
    *to = (gw_material){.base_color = {0.7f, 0.7f, 0.7f, 1.0f},
                        .roughness = 0.6f,
                        .alpha_cutoff = 0.5f,
                        .two_sided = 1,
                        .base_color_texture = -1};
    *source = gw_material_source_none();
    if (format == GW_FORMAT_GLTF)
        gltf_material(from, to, source);
    if (format == GW_FORMAT_GLTF)
        return GW_OK;
    if (format == GW_FORMAT_OBJ)
        return gw_import_mtl_material(read, from, files, model, index, error);
    snprintf(to->name, sizeof to->name,
             "default"); /* PLY, STL and OFF have no materials; a colour comes by vertex */
    return GW_OK;
}
