/* Textures of a model: found, decoded, combined, and averaged where only a mean is carried. Parent side. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "build/model_path.h"
#include "build/specular_glossiness.h"

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

/* Mean of each channel, 0..1, as stored or as linear light (alpha always as stored). */
static void image_mean(const gw_image *image, int linear, double mean[4]) {
    const uint64_t pixels = (uint64_t)image->width * image->height;
    uint64_t histogram[4][256] = {{0}};
    for (uint64_t i = 0; i < pixels; i++)
        for (int c = 0; c < 4; c++)
            histogram[c][image->rgba[i * 4 + (uint64_t)c]]++;
    for (int c = 0; c < 4; c++) {
        mean[c] = 0.0;
        for (int v = 0; v < 256; v++) {
            const float value = (float)v / 255.0f;
            mean[c] +=
                (double)(linear && c < 3 ? gw_linear_from_srgb(value) : value) * (double)histogram[c][v];
        }
        mean[c] /= (double)pixels;
    }
}

/* Takes the textures off materials that nothing uses, so that they are not looked for. */
static gw_code forget_unused(gw_source_model *model, gw_error *error) {
    uint8_t *used = NULL;
    gw_code code = mark_used_materials(model->scene, &used, error);
    for (uint32_t i = 0; code == GW_OK && i < model->scene->material_count; i++)
        for (int map = 0; map < GW_MAP_COUNT && !used[i]; map++)
            model->material_sources[i].maps[map] = -1;
    free(used);
    return code;
}

/* The first material that uses the source, or NULL. */
static const char *user_of(const gw_source_model *model, uint32_t source) {
    for (uint32_t i = 0; i < model->scene->material_count; i++)
        for (int map = 0; map < GW_MAP_COUNT; map++)
            if (model->material_sources[i].maps[map] == (int32_t)source)
                return model->scene->materials[i].name;
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

static void multiply(float *values, size_t count, const double *by) {
    for (size_t i = 0; i < count; i++)
        values[i] = (float)((double)values[i] * by[i]);
}

/* Multiplies a material's factors by the mean of one of its maps. */
static void apply_mean(gw_map map, const double mean[4], const double linear[4], gw_material *material,
                       gw_material_extension *extension) {
    switch (map) {
    case GW_MAP_METALLIC_ROUGHNESS:
        multiply(&material->roughness, 1, &mean[1]);
        multiply(&material->metalness, 1, &mean[2]);
        break;
    case GW_MAP_EMISSIVE:
        multiply(material->emissive, 3, linear);
        break;
    case GW_MAP_THICKNESS:
        multiply(&extension->thickness, 1, &mean[1]);
        break;
    default: /* shown as they are, or converted */
        break;
    }
}

static void apply_means(gw_source_model *model, uint32_t index, const gw_image *image) {
    gw_scene *scene = model->scene;
    double mean[4], linear[4];
    image_mean(image, 0, mean);
    image_mean(image, 1, linear);
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (int map = 0; map < GW_MAP_COUNT; map++)
            if (model->material_sources[i].maps[map] == (int32_t)index)
                apply_mean((gw_map)map, mean, linear, &scene->materials[i],
                           scene->extensions ? &scene->extensions[i] : NULL);
}

static int is_shown(const gw_source_model *model, uint32_t index) {
    for (uint32_t i = 0; i < model->scene->material_count; i++)
        for (int map = 0; map < GW_MAP_SHOWN_COUNT; map++)
            if (model->material_sources[i].maps[map] == (int32_t)index)
                return 1;
    return 0;
}

/* MTL names no alpha mode: a picture with transparent pixels cuts out (leaves, fences). */
static gw_code set_alpha_modes(gw_source_model *model, uint32_t index, const gw_image *image,
                               gw_error *error) {
    const int alpha = image_has_alpha(image);
    for (uint32_t i = 0; i < model->scene->material_count; i++) {
        const gw_material_source *source = &model->material_sources[i];
        if (!alpha || source->maps[GW_MAP_BASE_COLOR] != (int32_t)index || !source->alpha_from_texture)
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

/* Adds the picture, which it takes, to the scene's textures; there is room for it. Returns its index. */
static int32_t add_texture(gw_scene *scene, const gw_texture_source *source, const char *name,
                           gw_image *image) {
    gw_texture *texture = &scene->textures[scene->texture_count];
    snprintf(texture->name, sizeof texture->name, "%s", name);
    texture->image = *image;
    texture->wrap_u = source->wrap_u;
    texture->wrap_v = source->wrap_v;
    texture->nearest = source->nearest;
    *image = (gw_image){0};
    return (int32_t)scene->texture_count++;
}

/* Of what a map says only some channels. */
typedef enum map_channels { AS_IT_IS, OPAQUE, ALPHA_AS_DATA, KINDS_OF_CHANNELS } map_channels;

static map_channels channels_of(gw_map map, const gw_image *image) {
    if (map == GW_MAP_SHEEN_ROUGHNESS || map == GW_MAP_SPECULAR)
        return ALPHA_AS_DATA;
    const int color = map == GW_MAP_SHEEN_COLOR || map == GW_MAP_SPECULAR_COLOR;
    return color && image_has_alpha(image) ? OPAQUE : AS_IT_IS; /* alpha would weigh the colours */
}

static gw_code copy_channels(const gw_image *from, map_channels channels, gw_image *out, gw_error *error) {
    const gw_code code = gw_image_create(from->width, from->height, out, error);
    const uint64_t pixels = code == GW_OK ? (uint64_t)from->width * from->height : 0;
    for (uint64_t i = 0; i < pixels; i++) {
        const uint8_t *in = from->rgba + i * 4;
        uint8_t *to = out->rgba + i * 4;
        for (int c = 0; c < 3; c++)
            to[c] = channels == ALPHA_AS_DATA ? in[3] : in[c];
        to[3] = 255;
    }
    return code;
}

/* Which texture a map of these channels shows; added when it is first asked for. `image` is taken, and then
 * stands in the scene's textures, when all of it is. */
static gw_code texture_for(gw_source_model *model, uint32_t index, map_channels channels, gw_image *image,
                           int32_t *texture, gw_error *error) {
    const gw_texture_source *source = &model->sources[index];
    gw_image part = {0};
    char name[64];
    if (*texture >= 0)
        return GW_OK;
    gw_code code = channels == AS_IT_IS ? GW_OK : copy_channels(image, channels, &part, error);
    if (code != GW_OK)
        return code;
    snprintf(name, sizeof name, "embedded %u", index);
    *texture = add_texture(model->scene, source, source->bytes ? name : source->path,
                           channels == AS_IT_IS ? image : &part);
    return GW_OK;
}

/* Points all materials that show the source in these channels at the texture that holds them. */
static gw_code point_maps(gw_source_model *model, uint32_t index,
                          const map_channels wanted[GW_MAP_SHOWN_COUNT], map_channels channels,
                          gw_image *image, gw_error *error) {
    gw_scene *scene = model->scene;
    gw_code code = GW_OK;
    int32_t texture = -1;
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (int map = 0; code == GW_OK && map < GW_MAP_SHOWN_COUNT; map++) {
            gw_texture_use *use =
                scene->extensions ? gw_texture_use_of(&scene->extensions[i], (gw_map)map) : NULL;
            if (model->material_sources[i].maps[map] != (int32_t)index || wanted[map] != channels)
                continue;
            code = texture_for(model, index, channels, image, &texture, error);
            if (code == GW_OK && map == GW_MAP_BASE_COLOR)
                scene->materials[i].base_color_texture = texture;
            else if (code == GW_OK && use)
                use->texture = texture;
        }
    return code;
}

/* Moves the picture to the scene's textures and points the materials there. */
static gw_code keep_texture(gw_source_model *model, uint32_t index, gw_image *image, gw_error *error) {
    gw_scene *scene = model->scene;
    const gw_texture_source *source = &model->sources[index];
    gw_code code = set_alpha_modes(model, index, image, error);
    if (code == GW_OK && (image->width > LARGE_SIDE || image->height > LARGE_SIDE))
        code = gw_scene_note(scene, error, "texture '%.100s' is large: %u x %u pixels", source->path,
                             image->width, image->height);
    map_channels wanted[GW_MAP_SHOWN_COUNT];
    for (int map = 0; map < GW_MAP_SHOWN_COUNT; map++)
        wanted[map] = channels_of((gw_map)map, image);
    for (int channels = KINDS_OF_CHANNELS; code == GW_OK && channels-- > AS_IT_IS;) /* the whole one last */
        code = point_maps(model, index, wanted, (map_channels)channels, image, error);
    return code;
}

/* A material of specular-glossiness becomes one of metallic-roughness; with maps, in pictures of its own. */
static gw_code convert_specular(gw_source_model *model, uint32_t m, const char *folder, gw_error *error) {
    gw_material *material = &model->scene->materials[m];
    gw_material_source *source = &model->material_sources[m];
    const int32_t diffuse = source->maps[GW_MAP_BASE_COLOR];
    const int32_t specular = source->maps[GW_MAP_SPECULAR_GLOSSINESS];
    gw_image images[4] = {{0}}; /* diffuse, specular, base colour, metallic-roughness */
    gw_code code = GW_OK;
    if (source->specular[3] < 0.0f)
        return GW_OK;
    if (diffuse < 0 && specular < 0) {
        const float color[3] = {material->base_color[0], material->base_color[1], material->base_color[2]};
        material->metalness = gw_specular_to_metal(color, source->specular, material->base_color);
        return GW_OK;
    }
    if (diffuse >= 0)
        code = load_source(model, (uint32_t)diffuse, folder, &images[0], error);
    if (code == GW_OK && specular >= 0)
        code = load_source(model, (uint32_t)specular, folder, &images[1], error);
    if (code == GW_OK)
        code = gw_specular_pictures(diffuse >= 0 ? &images[0] : NULL, material->base_color,
                                    specular >= 0 ? &images[1] : NULL, source->specular, &images[2],
                                    &images[3], error);
    if (code == GW_OK) {
        const gw_texture_source *from = &model->sources[diffuse >= 0 ? diffuse : specular];
        gw_material_extension *extension = &model->scene->extensions[m];
        double mean[4];
        image_mean(&images[3], 0, mean);
        material->roughness = (float)mean[1];
        material->metalness = (float)mean[2];
        extension->roughness = extension->metalness = 1.0f;
        for (int i = 0; i < 3; i++)
            material->base_color[i] = 1.0f;
        material->base_color_texture = add_texture(model->scene, from, "converted base colour", &images[2]);
        extension->metallic_roughness.texture =
            add_texture(model->scene, from, "converted metallic-roughness", &images[3]);
        source->maps[GW_MAP_BASE_COLOR] = source->maps[GW_MAP_SPECULAR_GLOSSINESS] = -1;
    }
    for (int i = 0; i < 4; i++)
        gw_image_finish(&images[i]);
    return code;
}

static double brightness(const uint8_t *pixel) {
    return (2126.0 * pixel[0] + 7152.0 * pixel[1] + 722.0 * pixel[2]) / 2550000.0;
}

/* The pixel of a picture that lies where (x, y) of one of that size lies. */
static const uint8_t *pixel_at(const gw_image *image, uint32_t x, uint32_t y, uint32_t width,
                               uint32_t height) {
    const uint64_t from_x = (uint64_t)x * image->width / width, from_y = (uint64_t)y * image->height / height;
    return image->rgba + (from_y * image->width + from_x) * 4;
}

/* roughness or metalness may have no pixels: then the material's factor stands. */
static void join_pixels(const gw_image *roughness, const gw_image *metalness, float exponent, gw_image *out) {
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++) {
            uint8_t *to = out->rgba + ((uint64_t)y * out->width + x) * 4;
            double rough = 1.0, metal = 1.0;
            if (roughness->rgba)
                rough = brightness(pixel_at(roughness, x, y, out->width, out->height));
            if (roughness->rgba && exponent > 0.0f)
                rough = (double)gw_roughness_of_exponent(rough * (double)exponent);
            if (metalness->rgba)
                metal = brightness(pixel_at(metalness, x, y, out->width, out->height));
            to[0] = to[3] = 255;
            to[1] = (uint8_t)lround(rough * 255.0);
            to[2] = (uint8_t)lround(metal * 255.0);
        }
}

/* MTL's maps of roughness (or of the exponent) and metalness become the one map that glTF has for both. */
static gw_code join_finish(gw_source_model *model, uint32_t m, const char *folder, gw_error *error) {
    gw_material *material = &model->scene->materials[m];
    gw_material_source *source = &model->material_sources[m];
    const int32_t alone[2] = {source->maps[GW_MAP_ROUGHNESS_ALONE], source->maps[GW_MAP_METALNESS_ALONE]};
    gw_image images[3] = {{0}}; /* roughness, metalness, both */
    gw_code code = GW_OK;
    if (alone[0] < 0 && alone[1] < 0)
        return GW_OK;
    for (int i = 0; code == GW_OK && i < 2; i++)
        if (alone[i] >= 0)
            code = load_source(model, (uint32_t)alone[i], folder, &images[i], error);
    const gw_image *larger = images[0].width >= images[1].width ? &images[0] : &images[1];
    if (code == GW_OK)
        code = gw_image_create(larger->width, larger->height, &images[2], error);
    if (code == GW_OK) {
        gw_material_extension *extension = &model->scene->extensions[m];
        double mean[4];
        join_pixels(&images[0], &images[1], source->exponent, &images[2]);
        image_mean(&images[2], 0, mean);
        extension->roughness = alone[0] >= 0 ? 1.0f : material->roughness;
        extension->metalness = alone[1] >= 0 ? 1.0f : material->metalness;
        material->roughness = (float)((double)extension->roughness * mean[1]);
        material->metalness = (float)((double)extension->metalness * mean[2]);
        extension->metallic_roughness.texture =
            add_texture(model->scene, &model->sources[alone[0] >= 0 ? alone[0] : alone[1]],
                        "joined metallic-roughness", &images[2]);
        source->maps[GW_MAP_ROUGHNESS_ALONE] = source->maps[GW_MAP_METALNESS_ALONE] = -1;
    }
    for (int i = 0; i < 3; i++)
        gw_image_finish(&images[i]);
    return code;
}

/* Room for every source, and for what is converted of each material. */
static gw_code make_room(gw_source_model *model, gw_error *error) {
    gw_scene *scene = model->scene;
    return gw_allocate((void **)&scene->textures,
                       KINDS_OF_CHANNELS * (size_t)model->source_count + 2 * (size_t)scene->material_count,
                       sizeof *scene->textures, "textures", error);
}

/* The extensions that hold what maps need: MTL names maps, and a conversion makes one. */
static gw_code extend_for_maps(gw_source_model *model, gw_error *error) {
    gw_scene *scene = model->scene;
    gw_code code = GW_OK;
    for (uint32_t i = 0; code == GW_OK && i < scene->material_count; i++) {
        const gw_material_source *source = &model->material_sources[i];
        int needed = source->specular[3] >= 0.0f && source->maps[GW_MAP_BASE_COLOR] >= 0;
        for (int map = GW_MAP_NORMAL; map < GW_MAP_COUNT; map++)
            needed = needed || source->maps[map] >= 0;
        if (needed)
            code = gw_scene_extend_materials(scene, error);
        if (code == GW_OK && source->maps[GW_MAP_EMISSIVE] >= 0)
            memcpy(scene->extensions[i].emissive, scene->materials[i].emissive,
                   sizeof scene->extensions[i].emissive);
    }
    return code;
}

/* Whether the pixels are normals of tangent space: blue, and straight up on average. */
static int shows_normals(const gw_image *image) {
    double mean[4];
    image_mean(image, 0, mean);
    return fabs(mean[0] - 0.5) < 0.1 && fabs(mean[1] - 0.5) < 0.1 && mean[2] > 0.7;
}

/* MTL's bump: drawn if it is a normal map; one of heights, or one that is not there, is named. */
static gw_code settle_bump(gw_source_model *model, uint32_t m, const char *folder, gw_error *error) {
    gw_material_source *source = &model->material_sources[m];
    const int32_t index = source->maps[GW_MAP_NORMAL];
    gw_image image = {0};
    gw_error why = {0};
    if (!source->normal_may_be_height || index < 0)
        return GW_OK;
    const gw_code code = load_source(model, (uint32_t)index, folder, &image, &why);
    const int normals = code == GW_OK && shows_normals(&image);
    gw_image_finish(&image);
    if (normals)
        return GW_OK;
    source->maps[GW_MAP_NORMAL] = -1;
    return code == GW_OK ? gw_scene_note(model->scene, error,
                                         "material '%s': its bump map holds heights and is not carried",
                                         model->scene->materials[m].name)
                         : gw_scene_note(model->scene, error, "its bump map is left out: %s", why.text);
}

gw_code gw_import_textures(gw_source_model *model, const char *path, const gw_log *log, gw_error *error) {
    char *folder = gw_path_folder(path);
    if (!folder)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_code code = make_room(model, error);
    if (code == GW_OK)
        code = forget_unused(model, error);
    for (uint32_t i = 0; code == GW_OK && i < model->scene->material_count; i++)
        code = settle_bump(model, i, folder, error);
    if (code == GW_OK)
        code = extend_for_maps(model, error);
    for (uint32_t i = 0; code == GW_OK && i < model->scene->material_count; i++)
        code = convert_specular(model, i, folder, error);
    for (uint32_t i = 0; code == GW_OK && i < model->scene->material_count; i++)
        code = join_finish(model, i, folder, error);
    for (uint32_t i = 0; code == GW_OK && i < model->source_count; i++) {
        gw_image image = {0};
        if (!user_of(model, i))
            continue;
        gw_log_progress(log, "reading textures", (double)i / model->source_count);
        code = load_source(model, i, folder, &image, error);
        if (code == GW_OK) {
            apply_means(model, i, &image);
            if (is_shown(model, i))
                code = keep_texture(model, i, &image, error);
        }
        gw_image_finish(&image);
    }
    free(folder);
    return code;
}
