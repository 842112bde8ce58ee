/* See texture_set.h. */
#include "render/texture_set.h"

#include "base/memory.h"
#include "render/mip_chain.h"

#include <stdlib.h>
#include <string.h>

enum { SIDE_BITS = 16 }; /* classes before merging: sides 2^0 .. 2^15 */

/* Which texture is used, and how many of each power-of-two size there are. */
typedef struct texture_plan {
    uint8_t *class_bits;          /* [2 texture_count] log2 of the side, 0xff: not used */
    uint32_t count_of[SIDE_BITS]; /* textures of that size */
    uint32_t class_of[SIDE_BITS]; /* class that takes that size */
} texture_plan;

static uint32_t bits_for(uint32_t side, uint32_t limit) {
    uint32_t bits = 0;
    while ((1u << bits) < side && (2u << bits) <= limit && bits + 1 < SIDE_BITS)
        ++bits;
    return bits;
}

/* Textures of the scene as they are used: [0, count) colours or data, [count, 2 count) normals. */
static void want(texture_plan *plan, const gw_scene *scene, int32_t texture, int as_normal,
                 uint32_t side_limit) {
    const size_t entry = (size_t)texture + (as_normal ? scene->texture_count : 0);
    if (texture < 0 || plan->class_bits[entry] != 0xff)
        return;
    const gw_image *image = &scene->textures[texture].image;
    uint32_t side = image->width > image->height ? image->width : image->height;
    uint32_t bits = bits_for(side, side_limit);
    plan->class_bits[entry] = (uint8_t)bits;
    ++plan->count_of[bits];
}

static void want_of_material(texture_plan *plan, const gw_scene *scene, uint32_t material,
                             gw_texture_kind kind, uint32_t limit) {
    gw_material_extension *extension = scene->extensions ? &scene->extensions[material] : NULL;
    if (kind == GW_TEXTURE_COLOR)
        want(plan, scene, scene->materials[material].base_color_texture, 0, limit);
    for (int map = GW_MAP_NORMAL; extension && map < GW_MAP_SHOWN_COUNT; ++map) {
        const gw_texture_kind of_map = gw_texture_kind_of((gw_map)map);
        if ((of_map == GW_TEXTURE_COLOR) == (kind == GW_TEXTURE_COLOR))
            want(plan, scene, gw_texture_use_of(extension, (gw_map)map)->texture, of_map == GW_TEXTURE_NORMAL,
                 limit);
    }
}

static gw_code plan_init(texture_plan *plan, const gw_scene *scene, gw_texture_kind kind, uint32_t side_limit,
                         gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, scene->texture_count, 2, "texture classes", error);
    if (code)
        return code;
    plan->class_bits = memory;
    if (scene->texture_count > 0) /* memset takes no NULL, not even for no bytes */
        memset(plan->class_bits, 0xff, 2 * (size_t)scene->texture_count);
    uint32_t last = UINT32_MAX;
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        if (scene->material_of[i] != last)
            want_of_material(plan, scene, scene->material_of[i], kind, side_limit);
        last = scene->material_of[i];
    }
    return GW_OK;
}

/* What merging may cost, in texels of level 0: every class is one more sample that each lookup pays for on
 * devices that do not skip branches (60 ms of 650 for a megapixel on llvmpipe), so small ones are joined
 * while that is cheap. */
static const uint64_t merge_allowance = 24u << 20;

/* The largest size has an array of its own; a smaller one joins the array above while the allowance lasts or
 * when there is no array left, by growing to that size. */
static void plan_classes(texture_plan *plan, uint32_t most, gw_texture_set *set) {
    uint64_t allowance = merge_allowance;
    for (uint32_t bits = SIDE_BITS; bits-- > 0;) {
        if (plan->count_of[bits] == 0)
            continue;
        int first = set->class_count == 0;
        uint64_t above =
            first ? 0 : (uint64_t)set->side[set->class_count - 1] * set->side[set->class_count - 1];
        uint64_t growth = first ? 0 : (above - (1ull << (2 * bits))) * plan->count_of[bits];
        if (first || (growth > allowance && set->class_count < most))
            set->side[set->class_count++] = 1u << bits;
        else
            allowance -= growth < allowance ? growth : allowance;
        plan->class_of[bits] = set->class_count - 1;
        set->layers[set->class_count - 1] += plan->count_of[bits];
    }
}

static uint32_t level_count(uint32_t side) {
    uint32_t levels = 1;
    while (side >> levels)
        ++levels;
    return levels;
}

static gw_code create_arrays(gw_gl *device, GLenum format, gw_texture_set *set, gw_error *error) {
    const gw_gl_limits *limits = gw_gl_limits_of(device);
    for (uint32_t i = 0; i < set->class_count; ++i) {
        if (set->layers[i] > (uint32_t)limits->texture_layers || set->layers[i] > 0xffffu)
            return gw_fail(
                error, GW_MACHINE,
                "%u textures of %u x %u texels are more than the %d layers that the driver allows; "
                "merge some of them",
                set->layers[i], set->side[i], set->side[i], limits->texture_layers);
        uint64_t bytes = (uint64_t)set->side[i] * set->side[i] * 4 * set->layers[i] / 3 * 4;
        glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &set->arrays[i]);
        glTextureStorage3D(set->arrays[i], (GLsizei)level_count(set->side[i]), format, (GLsizei)set->side[i],
                           (GLsizei)set->side[i], (GLsizei)set->layers[i]);
        if (gw_gl_check("allocating texture arrays", error))
            return gw_context(error, "%u textures of %u x %u texels need %.0f MiB", set->layers[i],
                              set->side[i], set->side[i], (double)bytes / 1048576.0);
        set->bytes += bytes;
    }
    return GW_OK;
}

/* A picture of data as the chain takes it: opaque, so that no texel weighs more than another; normals of
 * length 1. */
static gw_code prepare_data(const gw_texture *from, gw_texture_kind kind, gw_texture *out, gw_error *error) {
    *out = *from;
    gw_code code = gw_image_create(from->image.width, from->image.height, &out->image, error);
    const size_t count = code ? 0 : (size_t)from->image.width * from->image.height;
    for (size_t i = 0; i < count; ++i) {
        uint8_t *texel = out->image.rgba + i * 4;
        memcpy(texel, from->image.rgba + i * 4, 3);
        texel[3] = 255;
        if (kind == GW_TEXTURE_NORMAL)
            gw_unit_texel(texel);
    }
    return code;
}

typedef struct layer_place {
    uint32_t size_class, layer;
    gw_texture_kind kind;
} layer_place;

static gw_code upload(const gw_texture_set *set, const gw_texel_curve *curve, const gw_texture *texture,
                      layer_place place, gw_error *error) {
    gw_linear_image image = {0};
    void *rgba = NULL;
    uint32_t side = set->side[place.size_class];
    const int as_it_is = texture->image.width == side && texture->image.height == side;
    gw_code code = gw_allocate(&rgba, (size_t)side * side, 4, "texture bytes", error);
    if (!code)
        code = gw_linear_image_init(curve, texture, side, &image, error);
    for (uint32_t level = 0; !code; ++level) {
        const void *bytes = level == 0 && as_it_is ? texture->image.rgba : rgba;
        if (bytes == rgba && place.kind == GW_TEXTURE_NORMAL)
            gw_linear_image_encode_normals(&image, rgba);
        else if (bytes == rgba)
            gw_linear_image_encode(curve, &image, rgba);
        glTextureSubImage3D(set->arrays[place.size_class], (GLint)level, 0, 0, (GLint)place.layer,
                            (GLsizei)image.side, (GLsizei)image.side, 1, GL_RGBA, GL_UNSIGNED_BYTE, bytes);
        if (image.side == 1)
            break;
        gw_linear_image_halve(&image);
    }
    if (!code)
        code = gw_gl_check("uploading a texture", error);
    gw_linear_image_finish(&image);
    free(rgba);
    return code ? gw_context(error, "texture %s", texture->name) : GW_OK;
}

static gw_code upload_as(const gw_texture_set *set, const gw_texel_curve *curve, const gw_texture *texture,
                         layer_place place, gw_error *error) {
    if (place.kind == GW_TEXTURE_COLOR)
        return upload(set, curve, texture, place, error);
    gw_texture prepared;
    gw_code code = prepare_data(texture, place.kind, &prepared, error);
    if (!code)
        code = upload(set, curve, &prepared, place, error);
    gw_image_finish(&prepared.image);
    return code;
}

static uint32_t word_of(const gw_texture *texture, uint32_t size_class, uint32_t layer) {
    return size_class | (layer << 4) | ((uint32_t)texture->wrap_u << 20) | ((uint32_t)texture->wrap_v << 22) |
           (texture->nearest ? 1u << 24 : 0);
}

static void create_samplers(gw_texture_set *set) {
    static const GLint minify[3] = {GL_NEAREST_MIPMAP_NEAREST, GL_LINEAR_MIPMAP_NEAREST,
                                    GL_LINEAR_MIPMAP_LINEAR};
    glCreateSamplers(3, set->samplers);
    for (int i = 0; i < 3; ++i) {
        glSamplerParameteri(set->samplers[i], GL_TEXTURE_MIN_FILTER, minify[i]);
        glSamplerParameteri(set->samplers[i], GL_TEXTURE_MAG_FILTER,
                            i == GW_FILTER_NEAREST ? GL_NEAREST : GL_LINEAR);
        glSamplerParameteri(set->samplers[i], GL_TEXTURE_WRAP_S, GL_REPEAT);
        glSamplerParameteri(set->samplers[i], GL_TEXTURE_WRAP_T, GL_REPEAT);
    }
}

/* Gives each entry its layer and uploads it. */
static gw_code fill_arrays(gw_texture_set *set, const texture_plan *plan, const gw_scene *scene,
                           gw_texture_kind kind, gw_error *error) {
    gw_texel_curve *curve = NULL;
    gw_code code =
        set->class_count > 0 ? gw_allocate((void **)&curve, 1, sizeof *curve, "texel curve", error) : GW_OK;
    if (curve && kind == GW_TEXTURE_COLOR)
        gw_texel_curve_init(curve);
    else if (curve)
        gw_texel_curve_init_linear(curve);
    uint32_t next_layer[GW_MAXIMUM_TEXTURE_CLASSES] = {0};
    for (uint32_t i = 0; !code && i < 2 * scene->texture_count; ++i) {
        const gw_texture *texture = &scene->textures[i % scene->texture_count];
        set->words[i] = GW_NO_TEXTURE;
        if (plan->class_bits[i] == 0xff)
            continue;
        uint32_t size_class = plan->class_of[plan->class_bits[i]];
        const layer_place place = {size_class, next_layer[size_class]++,
                                   i < scene->texture_count ? kind : GW_TEXTURE_NORMAL};
        set->words[i] = word_of(texture, size_class, place.layer);
        code = upload_as(set, curve, texture, place, error);
    }
    free(curve);
    return code;
}

gw_code gw_texture_set_init(gw_gl *device, const gw_scene *scene, gw_texture_kind kind, gw_texture_set *out,
                            gw_error *error) {
    memset(out, 0, sizeof *out);
    texture_plan plan = {0};
    void *memory = NULL;
    const int colors = kind == GW_TEXTURE_COLOR;
    gw_code code = gw_allocate(&memory, scene->texture_count, 2 * sizeof *out->words, "texture words", error);
    out->words = memory;
    out->texture_count = scene->texture_count;
    if (!code)
        code = plan_init(&plan, scene, kind, (uint32_t)gw_gl_limits_of(device)->texture_side, error);
    if (!code) {
        plan_classes(&plan, colors ? GW_MAXIMUM_TEXTURE_CLASSES : GW_MAXIMUM_DATA_CLASSES, out);
        code = create_arrays(device, colors ? GL_SRGB8_ALPHA8 : GL_RGBA8, out, error);
    }
    if (!code)
        code = fill_arrays(out, &plan, scene, kind, error);
    free(plan.class_bits);
    if (!code) {
        create_samplers(out);
        code = gw_gl_check("making samplers", error);
    }
    if (code)
        gw_texture_set_finish(out);
    return code;
}

gw_texture_kind gw_texture_kind_of(gw_map map) {
    if (map == GW_MAP_NORMAL || map == GW_MAP_CLEARCOAT_NORMAL)
        return GW_TEXTURE_NORMAL;
    const int color = map == GW_MAP_BASE_COLOR || map == GW_MAP_EMISSIVE || map == GW_MAP_SHEEN_COLOR ||
                      map == GW_MAP_SPECULAR_COLOR;
    return color ? GW_TEXTURE_COLOR : GW_TEXTURE_DATA;
}

uint32_t gw_texture_word(const gw_texture_set *set, int32_t texture, gw_texture_kind kind) {
    if (texture < 0)
        return GW_NO_TEXTURE;
    return set->words[(size_t)texture + (kind == GW_TEXTURE_NORMAL ? set->texture_count : 0)];
}

void gw_texture_set_finish(gw_texture_set *set) {
    glDeleteTextures((GLsizei)set->class_count, set->arrays);
    glDeleteSamplers(3, set->samplers);
    free(set->words);
    memset(set, 0, sizeof *set);
}

void gw_texture_set_bind(const gw_texture_set *set, uint32_t filter, GLuint first_unit) {
    for (uint32_t i = 0; i < set->class_count; ++i) {
        glBindTextureUnit(first_unit + i, set->arrays[i]);
        glBindSampler(first_unit + i, set->samplers[filter < 3 ? filter : GW_FILTER_TRILINEAR]);
    }
}
