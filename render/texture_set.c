/* See texture_set.h. */
#include "render/texture_set.h"

#include "base/memory.h"
#include "render/mip_chain.h"

#include <stdlib.h>
#include <string.h>

enum { SIDE_BITS = 16 }; /* classes before merging: sides 2^0 .. 2^15 */

/* Which texture is used, and how many of each power-of-two size there are. */
typedef struct texture_plan {
    uint8_t *class_bits;          /* [texture_count] log2 of the side, 0xff: not used */
    uint32_t count_of[SIDE_BITS]; /* textures of that size */
    uint32_t class_of[SIDE_BITS]; /* class that takes that size */
} texture_plan;

static uint32_t bits_for(uint32_t side, uint32_t limit) {
    uint32_t bits = 0;
    while ((1u << bits) < side && (2u << bits) <= limit && bits + 1 < SIDE_BITS)
        ++bits;
    return bits;
}

static gw_code plan_init(texture_plan *plan, const gw_scene *scene, uint32_t side_limit, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, scene->texture_count, 1, "texture classes", error);
    if (code)
        return code;
    plan->class_bits = memory;
    if (scene->texture_count > 0) /* memset takes no NULL, not even for no bytes */
        memset(plan->class_bits, 0xff, scene->texture_count);
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        int32_t texture = scene->materials[scene->material_of[i]].base_color_texture;
        if (texture < 0 || plan->class_bits[texture] != 0xff)
            continue;
        const gw_image *image = &scene->textures[texture].image;
        uint32_t side = image->width > image->height ? image->width : image->height;
        uint32_t bits = bits_for(side, side_limit);
        plan->class_bits[texture] = (uint8_t)bits;
        ++plan->count_of[bits];
    }
    return GW_OK;
}

/* What merging may cost, in texels of level 0: every class is one more sample that each lookup pays for on
 * devices that do not skip branches (60 ms of 650 for a megapixel on llvmpipe), so small ones are joined
 * while that is cheap. */
static const uint64_t merge_allowance = 24u << 20;

/* The largest size has an array of its own; a smaller one joins the array above while the allowance lasts or
 * when there is no array left, by growing to that size. */
static void plan_classes(texture_plan *plan, gw_texture_set *set) {
    uint64_t allowance = merge_allowance;
    for (uint32_t bits = SIDE_BITS; bits-- > 0;) {
        if (plan->count_of[bits] == 0)
            continue;
        int first = set->class_count == 0;
        uint64_t above =
            first ? 0 : (uint64_t)set->side[set->class_count - 1] * set->side[set->class_count - 1];
        uint64_t growth = first ? 0 : (above - (1ull << (2 * bits))) * plan->count_of[bits];
        if (first || (growth > allowance && set->class_count < GW_MAXIMUM_TEXTURE_CLASSES))
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

static gw_code create_arrays(gw_gl *device, gw_texture_set *set, gw_error *error) {
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
        glTextureStorage3D(set->arrays[i], (GLsizei)level_count(set->side[i]), GL_SRGB8_ALPHA8,
                           (GLsizei)set->side[i], (GLsizei)set->side[i], (GLsizei)set->layers[i]);
        if (gw_gl_check("allocating texture arrays", error))
            return gw_context(error, "%u textures of %u x %u texels need %.0f MiB", set->layers[i],
                              set->side[i], set->side[i], (double)bytes / 1048576.0);
        set->bytes += bytes;
    }
    return GW_OK;
}

static gw_code upload(const gw_texture_set *set, const gw_texel_curve *curve, const gw_texture *texture,
                      uint32_t size_class, uint32_t layer, gw_error *error) {
    gw_linear_image image = {0};
    void *rgba = NULL;
    uint32_t side = set->side[size_class];
    const int as_it_is = texture->image.width == side && texture->image.height == side;
    gw_code code = gw_allocate(&rgba, (size_t)side * side, 4, "texture bytes", error);
    if (!code)
        code = gw_linear_image_init(curve, texture, side, &image, error);
    for (uint32_t level = 0; !code; ++level) {
        const void *bytes = level == 0 && as_it_is ? texture->image.rgba : rgba;
        if (bytes == rgba)
            gw_linear_image_encode(curve, &image, rgba);
        glTextureSubImage3D(set->arrays[size_class], (GLint)level, 0, 0, (GLint)layer, (GLsizei)image.side,
                            (GLsizei)image.side, 1, GL_RGBA, GL_UNSIGNED_BYTE, bytes);
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

static uint32_t word_of(const gw_texture *texture, uint32_t size_class, uint32_t layer) {
    return size_class | (layer << 4) | ((uint32_t)texture->wrap_u << 20) | ((uint32_t)texture->wrap_v << 22);
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

gw_code gw_texture_set_init(gw_gl *device, const gw_scene *scene, gw_texture_set *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    texture_plan plan = {0};
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, scene->texture_count, sizeof *out->words, "texture words", error);
    out->words = memory;
    if (!code)
        code = plan_init(&plan, scene, (uint32_t)gw_gl_limits_of(device)->texture_side, error);
    if (!code) {
        plan_classes(&plan, out);
        code = create_arrays(device, out, error);
    }
    gw_texel_curve *curve = NULL;
    if (!code && out->class_count > 0)
        code = gw_allocate((void **)&curve, 1, sizeof *curve, "texel curve", error);
    if (curve)
        gw_texel_curve_init(curve);
    uint32_t next_layer[GW_MAXIMUM_TEXTURE_CLASSES] = {0};
    for (uint32_t i = 0; !code && i < scene->texture_count; ++i) {
        out->words[i] = GW_NO_TEXTURE;
        if (plan.class_bits[i] == 0xff)
            continue;
        uint32_t size_class = plan.class_of[plan.class_bits[i]];
        uint32_t layer = next_layer[size_class]++;
        out->words[i] = word_of(&scene->textures[i], size_class, layer);
        code = upload(out, curve, &scene->textures[i], size_class, layer, error);
    }
    free(curve);
    free(plan.class_bits);
    if (!code) {
        create_samplers(out);
        code = gw_gl_check("making samplers", error);
    }
    if (code)
        gw_texture_set_finish(out);
    return code;
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
