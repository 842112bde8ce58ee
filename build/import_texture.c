/* Textures of a model: found, decoded, combined, and averaged where only a mean is carried. Parent side. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "build/model_path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t maximum_pixels = (uint64_t)1 << 28; /* of one picture: 1 GiB as RGBA */
static const size_t maximum_file = (size_t)1 << 30;
enum { LARGE_SIDE = 4096 };

static gw_code decode_file(const char *folder, const char *name, gw_image *out, gw_error *error) {
    char *path = NULL;
    gw_bytes bytes = {0};
    gw_code code = gw_model_path(folder, name, &path, error);
    if (code == GW_OK)
        code = gw_file_read(path, maximum_file, &bytes, error);
    if (code == GW_OK)
        code = gw_image_decode(bytes.data, bytes.size, path, maximum_pixels, out, error);
    gw_bytes_finish(&bytes);
    free(path);
    return code;
}

static gw_code decode_embedded(const gw_texture_source *source, uint32_t index, gw_image *out,
                               gw_error *error) {
    char name[64];
    snprintf(name, sizeof name, "embedded texture %u", index);
    if (source->raw_width == 0)
        return gw_image_decode(source->bytes, source->size, name, maximum_pixels, out, error);
    gw_code code = gw_image_create(source->raw_width, source->raw_height, out, error);
    if (code == GW_OK)
        memcpy(out->rgba, source->bytes, source->size);
    return code;
}

/* The opacity of another picture (its brightness), nearest pixel where sizes differ. */
static gw_code take_alpha(gw_image *image, const char *folder, const char *name, gw_error *error) {
    gw_image mask = {0};
    gw_code code = decode_file(folder, name, &mask, error);
    for (uint32_t y = 0; code == GW_OK && y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            const uint64_t from_x = (uint64_t)x * mask.width / image->width;
            const uint64_t from_y = (uint64_t)y * mask.height / image->height;
            const uint8_t *pixel = mask.rgba + (from_y * mask.width + from_x) * 4;
            image->rgba[((uint64_t)y * image->width + x) * 4 + 3] =
                (uint8_t)((2126u * pixel[0] + 7152u * pixel[1] + 722u * pixel[2] + 5000u) / 10000u);
        }
    gw_image_finish(&mask);
    return code;
}

/* 1 for every material that some triangle uses: files often name pictures that nothing shows, and lack them.
 */
static gw_code mark_used_materials(const gw_scene *scene, uint8_t **out, gw_error *error) {
    gw_code code = gw_allocate((void **)out, (size_t)scene->material_count + 1, 1, "materials in use", error);
    for (uint32_t i = 0; code == GW_OK && i < scene->triangle_count; i++)
        if (scene->material_of[i] < scene->material_count)
            (*out)[scene->material_of[i]] = 1;
    return code;
}

static int image_has_alpha(const gw_image *image) {
    const uint64_t pixels = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < pixels; i++)
        if (image->rgba[i * 4 + 3] < 255)
            return 1;
    return 0;
}

/* Mean of each channel, 0..1, as stored or as linear light. */
static void image_mean(const gw_image *image, int linear, double mean[3]) {
    const uint64_t pixels = (uint64_t)image->width * image->height;
    uint64_t histogram[3][256] = {{0}};
    for (uint64_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++)
            histogram[c][image->rgba[i * 4 + (uint64_t)c]]++;
    for (int c = 0; c < 3; c++) {
        mean[c] = 0.0;
        for (int v = 0; v < 256; v++) {
            const float value = (float)v / 255.0f;
            mean[c] += (double)(linear ? gw_linear_from_srgb(value) : value) * (double)histogram[c][v];
        }
        mean[c] /= (double)pixels;
    }
}

/* Takes the texture off materials that nothing uses, so that it is not looked for. */
static gw_code forget_unused(gw_source_model *model, gw_error *error) {
    uint8_t *used = NULL;
    gw_code code = mark_used_materials(model->scene, &used, error);
    for (uint32_t i = 0; code == GW_OK && i < model->scene->material_count; i++)
        if (!used[i]) {
            gw_material_source *source = &model->material_sources[i];
            source->base_color = source->metallic_roughness = source->emissive = -1;
        }
    free(used);
    return code;
}

/* The first material that uses the source, or NULL. */
static const char *user_of(const gw_source_model *model, uint32_t source) {
    for (uint32_t i = 0; i < model->scene->material_count; i++) {
        const gw_material_source *material = &model->material_sources[i];
        if (material->base_color == (int32_t)source || material->metallic_roughness == (int32_t)source ||
            material->emissive == (int32_t)source)
            return model->scene->materials[i].name;
    }
    return NULL;
}

static gw_code load_source(const gw_source_model *model, uint32_t index, const char *folder, gw_image *out,
                           gw_error *error) {
    const gw_texture_source *source = &model->sources[index];
    gw_code code = source->bytes ? decode_embedded(source, index, out, error)
                                 : decode_file(folder, source->path, out, error);
    if (code == GW_OK && source->alpha_path[0])
        code = take_alpha(out, folder, source->alpha_path, error);
    if (code != GW_OK)
        gw_context(error, "material '%s'", user_of(model, index));
    return code;
}

/* Multiplies the factors of every material that uses the picture only by its mean. */
static void apply_means(gw_source_model *model, uint32_t index, const gw_image *image) {
    for (uint32_t i = 0; i < model->scene->material_count; i++) {
        const gw_material_source *source = &model->material_sources[i];
        gw_material *material = &model->scene->materials[i];
        double mean[3];
        if (source->metallic_roughness == (int32_t)index) {
            image_mean(image, 0, mean);
            material->roughness = (float)(material->roughness * mean[1]);
            material->metalness = (float)(material->metalness * mean[2]);
        }
        if (source->emissive == (int32_t)index) {
            image_mean(image, 1, mean);
            for (int c = 0; c < 3; c++)
                material->emissive[c] = (float)(material->emissive[c] * mean[c]);
        }
    }
}

static int is_base_color(const gw_source_model *model, uint32_t index) {
    for (uint32_t i = 0; i < model->scene->material_count; i++)
        if (model->material_sources[i].base_color == (int32_t)index)
            return 1;
    return 0;
}

/* MTL names no alpha mode: a picture with transparent pixels cuts out (leaves, fences). */
static gw_code set_alpha_modes(gw_source_model *model, uint32_t index, const gw_image *image,
                               gw_error *error) {
    const int alpha = image_has_alpha(image);
    for (uint32_t i = 0; i < model->scene->material_count; i++) {
        const gw_material_source *source = &model->material_sources[i];
        if (!alpha || source->base_color != (int32_t)index || !source->alpha_from_texture)
            continue;
        model->scene->materials[i].alpha_mode = GW_ALPHA_MASK;
        gw_code code = gw_scene_note(model->scene, error,
                                     "material '%s': its texture has transparent pixels, they are cut out",
                                     model->scene->materials[i].name);
        if (code != GW_OK)
            return code;
    }
    return GW_OK;
}

/* Moves the picture to the scene's textures and points the materials there. */
static gw_code keep_texture(gw_source_model *model, uint32_t index, gw_image *image, gw_error *error) {
    gw_scene *scene = model->scene;
    const gw_texture_source *source = &model->sources[index];
    gw_code code = set_alpha_modes(model, index, image, error);
    if (code == GW_OK && (image->width > LARGE_SIDE || image->height > LARGE_SIDE))
        code = gw_scene_note(scene, error, "texture '%.100s' is large: %u x %u pixels", source->path,
                             image->width, image->height);
    if (code != GW_OK)
        return code;
    gw_texture *texture = &scene->textures[scene->texture_count];
    if (source->bytes)
        snprintf(texture->name, sizeof texture->name, "embedded %u", index);
    else
        snprintf(texture->name, sizeof texture->name, "%s", source->path);
    texture->image = *image;
    texture->wrap_u = source->wrap_u;
    texture->wrap_v = source->wrap_v;
    *image = (gw_image){0};
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (model->material_sources[i].base_color == (int32_t)index)
            scene->materials[i].base_color_texture = (int32_t)scene->texture_count;
    scene->texture_count++;
    return GW_OK;
}

gw_code gw_import_textures(gw_source_model *model, const char *path, const gw_log *log, gw_error *error) {
    char *folder = gw_path_folder(path);
    if (!folder)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_code code = gw_allocate((void **)&model->scene->textures, model->source_count,
                               sizeof *model->scene->textures, "textures", error);
    if (code == GW_OK)
        code = forget_unused(model, error);
    for (uint32_t i = 0; code == GW_OK && i < model->source_count; i++) {
        gw_image image = {0};
        if (!user_of(model, i))
            continue;
        gw_log_progress(log, "reading textures", (double)i / model->source_count);
        code = load_source(model, i, folder, &image, error);
        if (code == GW_OK) {
            apply_means(model, i, &image);
            if (is_base_color(model, i))
                code = keep_texture(model, i, &image, error);
        }
        gw_image_finish(&image);
    }
    free(folder);
    return code;
}
