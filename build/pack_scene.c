#include "build/pack_scene.h"

#include "base/memory.h"
#include "build/block.h"
#include "build/pack_animation.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Array sections of the block, in this order. */
typedef enum section {
    POSITIONS,
    NORMALS,
    TEXCOORDS,
    SECOND_TEXCOORDS,
    TANGENTS,
    COLORS,
    TRIANGLES,
    MATERIAL_OF,
    MATERIALS,
    EXTENSIONS,
    TEXTURES,
    PIXELS,
    LIGHTS,
    VIEWPOINTS,
    WELDED,
    ANIMATION, /* a block of its own; empty when nothing moves */
    PATH,
    ENVIRONMENT,
    SECTION_COUNT
} section;

typedef struct packed_texture {
    char name[256];
    uint32_t width, height;
    int32_t wrap_u, wrap_v, nearest, unused;
    uint64_t offset; /* into PIXELS */
} packed_texture;

typedef struct header {
    gw_block_head head;
    gw_hash hash;
    uint32_t vertex_count, triangle_count, material_count, texture_count, light_count, viewpoint_count;
    uint32_t welded_count, has_colors, has_second_texcoords, has_extensions, has_tangents;
    int32_t exponent;
    uint32_t environment_size[2], unused;
    float environment_scale, environment_rotation;
    float ambient[3], background[3];
    double centre[3], bounds[2][3];
    gw_placement placement;
    gw_block_span sections[SECTION_COUNT];
} header;

static const gw_block_head kind = {
    .magic = {'G', 'W', 'S', 'C', 'E', 'N', 'E', ' '}, .version = 9, .section_count = SECTION_COUNT};
static const char what[] = "the shared scene";

/* Sizes of all sections from the counts of a header; the reader compares with what the block claims. */
static void section_sizes(const header *head, uint64_t pixel_bytes, uint64_t animation_bytes,
                          uint64_t path_bytes, uint64_t sizes[SECTION_COUNT]) {
    const uint64_t vertices = head->vertex_count, triangles = head->triangle_count;
    sizes[POSITIONS] = vertices * 3 * sizeof(float);
    sizes[NORMALS] = vertices * 3 * sizeof(float);
    sizes[TEXCOORDS] = vertices * 2 * sizeof(float);
    sizes[SECOND_TEXCOORDS] = head->has_second_texcoords ? vertices * 2 * sizeof(float) : 0;
    sizes[TANGENTS] = head->has_tangents ? vertices * sizeof(uint32_t) : 0;
    sizes[COLORS] = head->has_colors ? vertices * 4 : 0;
    sizes[TRIANGLES] = triangles * 3 * sizeof(uint32_t);
    sizes[MATERIAL_OF] = triangles * sizeof(uint32_t);
    sizes[MATERIALS] = head->material_count * sizeof(gw_material);
    sizes[EXTENSIONS] = head->has_extensions ? head->material_count * sizeof(gw_material_extension) : 0;
    sizes[TEXTURES] = head->texture_count * sizeof(packed_texture);
    sizes[PIXELS] = pixel_bytes;
    sizes[LIGHTS] = head->light_count * sizeof(gw_light);
    sizes[VIEWPOINTS] = head->viewpoint_count * sizeof(gw_viewpoint);
    sizes[WELDED] = vertices * sizeof(uint32_t);
    sizes[ANIMATION] = animation_bytes;
    sizes[PATH] = path_bytes;
    sizes[ENVIRONMENT] = (uint64_t)head->environment_size[0] * head->environment_size[1] * 4;
}

static uint64_t texture_bytes(const gw_texture *texture) {
    return (uint64_t)texture->image.width * texture->image.height * 4;
}

static void make_header(const gw_scene *scene, header *head) {
    memset(head, 0, sizeof *head);
    head->head = kind;
    head->hash = scene->hash;
    head->vertex_count = scene->vertex_count;
    head->triangle_count = scene->triangle_count;
    head->material_count = scene->material_count;
    head->texture_count = scene->texture_count;
    head->light_count = scene->light_count;
    head->viewpoint_count = scene->viewpoint_count;
    head->has_colors = scene->colors != NULL;
    head->has_second_texcoords = scene->second_texcoords != NULL;
    head->has_tangents = scene->tangents != NULL;
    head->has_extensions = scene->extensions != NULL;
    head->welded_count = scene->welded_count;
    head->exponent = scene->exponent;
    head->environment_size[0] = scene->environment.rgbe.width;
    head->environment_size[1] = scene->environment.rgbe.height;
    head->environment_scale = scene->environment.scale;
    head->environment_rotation = scene->environment.rotation;
    memcpy(head->ambient, scene->ambient, sizeof head->ambient);
    memcpy(head->background, scene->background, sizeof head->background);
    memcpy(head->centre, scene->centre, sizeof head->centre);
    memcpy(head->bounds, scene->bounds, sizeof head->bounds);
    head->placement = scene->placement;

    uint64_t pixel_bytes = 0, sizes[SECTION_COUNT];
    for (uint32_t i = 0; i < scene->texture_count; i++)
        pixel_bytes += gw_block_align(texture_bytes(&scene->textures[i]));
    section_sizes(head, pixel_bytes, scene->animation ? gw_pack_animation_size(scene->animation) : 0,
                  scene->path ? strlen(scene->path) + 1 : 1, sizes);
    head->head.size = gw_block_place(sizeof *head, sizes, head->sections, SECTION_COUNT);
}

size_t gw_pack_scene_size(const gw_scene *scene) {
    header head;
    make_header(scene, &head);
    return (size_t)head.head.size;
}

static void put_textures(void *block_bytes, const header *head, const gw_scene *scene) {
    uint8_t *block = block_bytes;
    packed_texture *textures = (packed_texture *)(void *)(block + head->sections[TEXTURES].offset);
    uint8_t *pixels = block + head->sections[PIXELS].offset;
    uint64_t offset = 0;
    for (uint32_t i = 0; i < scene->texture_count; i++) {
        const gw_texture *from = &scene->textures[i];
        packed_texture *to = &textures[i];
        memcpy(to->name, from->name, sizeof to->name);
        to->width = from->image.width;
        to->height = from->image.height;
        to->wrap_u = (int32_t)from->wrap_u;
        to->wrap_v = (int32_t)from->wrap_v;
        to->nearest = from->nearest;
        to->offset = offset;
        memcpy(pixels + offset, from->image.rgba, texture_bytes(from));
        offset += gw_block_align(texture_bytes(from));
    }
}

void gw_pack_scene(const gw_scene *scene, void *block) {
    header head;
    make_header(scene, &head);
    const void *arrays[SECTION_COUNT] = {[POSITIONS] = scene->positions,
                                         [NORMALS] = scene->normals,
                                         [TEXCOORDS] = scene->texcoords,
                                         [COLORS] = scene->colors,
                                         [SECOND_TEXCOORDS] = scene->second_texcoords,
                                         [TANGENTS] = scene->tangents,
                                         [EXTENSIONS] = scene->extensions,
                                         [TRIANGLES] = scene->triangles,
                                         [MATERIAL_OF] = scene->material_of,
                                         [MATERIALS] = scene->materials,
                                         [LIGHTS] = scene->lights,
                                         [VIEWPOINTS] = scene->viewpoints,
                                         [WELDED] = scene->welded,
                                         [PATH] = scene->path ? scene->path : "",
                                         [ENVIRONMENT] = scene->environment.rgbe.rgba};
    memset(block, 0, (size_t)head.head.size);
    memcpy(block, &head, sizeof head);
    for (int i = 0; i < SECTION_COUNT; i++)
        if (arrays[i])
            gw_block_put(block, &head.sections[i], arrays[i]);
    put_textures(block, &head, scene);
    if (scene->animation)
        gw_pack_animation(scene->animation, (uint8_t *)block + head.sections[ANIMATION].offset);
}

/* --- reading back
 * ---------------------------------------------------------------------------------------------- */

static gw_code broken(gw_error *error, const char *why) {
    return gw_fail(error, GW_BAD_INPUT, "%s is damaged (%s); start again", what, why);
}

static gw_code check_sections(const uint8_t *block, size_t size, const header *head, gw_error *error) {
    uint64_t sizes[SECTION_COUNT];
    section_sizes(head, head->sections[PIXELS].size, head->sections[ANIMATION].size,
                  head->sections[PATH].size, sizes);
    gw_code code = gw_block_check_spans(head->sections, sizes, SECTION_COUNT, size, what, error);
    const uint32_t *environment = head->environment_size;
    if (!code && environment[0] != 2 * (uint64_t)environment[1])
        code = broken(error, "its environment is not twice as wide as high");
    const gw_block_span *path = &head->sections[PATH];
    if (!code && (path->size < 1 || block[path->offset + path->size - 1]))
        code = broken(error, "its name has no end");
    return code;
}

static gw_code check_indices(const gw_scene *scene, gw_error *error) {
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        const uint32_t *corners = scene->triangles[i];
        if (corners[0] >= scene->vertex_count || corners[1] >= scene->vertex_count ||
            corners[2] >= scene->vertex_count || scene->material_of[i] >= scene->material_count)
            return broken(error, "a triangle's index is out of range");
    }
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        if (scene->welded[i] >= scene->welded_count)
            return broken(error, "a welded vertex is out of range");
    for (uint32_t i = 0; i < scene->material_count; i++) {
        int32_t texture = scene->materials[i].base_color_texture;
        if (texture < -1 || texture >= (int64_t)scene->texture_count)
            return broken(error, "a material's texture is out of range");
        if (scene->extensions && gw_material_extension_fault(scene, i))
            return broken(error, gw_material_extension_fault(scene, i));
    }
    return GW_OK;
}

static gw_code view_textures(uint8_t *block, const header *head, gw_unpacked_scene *out, gw_error *error) {
    gw_code code = gw_allocate((void **)&out->textures, head->texture_count, sizeof *out->textures,
                               "texture table", error);
    if (code)
        return code;
    const packed_texture *from =
        (const packed_texture *)(const void *)(block + head->sections[TEXTURES].offset);
    uint64_t available = head->sections[PIXELS].size;
    for (uint32_t i = 0; i < head->texture_count; i++) {
        uint64_t size = (uint64_t)from[i].width * from[i].height * 4;
        if (from[i].width > GW_IMAGE_MAXIMUM_SIDE || from[i].height > GW_IMAGE_MAXIMUM_SIDE ||
            from[i].offset > available || size > available - from[i].offset)
            return broken(error, "a texture lies outside");
        gw_texture *to = &out->textures[i];
        memcpy(to->name, from[i].name, sizeof to->name);
        to->name[sizeof to->name - 1] = '\0';
        to->image = (gw_image){.width = from[i].width,
                               .height = from[i].height,
                               .rgba = block + head->sections[PIXELS].offset + from[i].offset};
        to->wrap_u = (gw_wrap)from[i].wrap_u;
        to->wrap_v = (gw_wrap)from[i].wrap_v;
        to->nearest = from[i].nearest;
    }
    out->scene.textures = out->textures;
    return GW_OK;
}

static gw_code view_animation(const uint8_t *block, const header *head, gw_scene *scene, gw_error *error) {
    const gw_block_span *span = &head->sections[ANIMATION];
    if (span->size == 0)
        return GW_OK;
    gw_code code = gw_unpack_animation(block + span->offset, span->size, &scene->animation, error);
    if (!code && scene->animation->vertex_count != scene->vertex_count)
        code = broken(error, "its animation is of other vertices");
    return code;
}

static void view_scene(uint8_t *block, const header *head, gw_scene *scene) {
#define AT(part) ((void *)(block + head->sections[part].offset))
    scene->path = AT(PATH);
    scene->hash = head->hash;
    scene->vertex_count = head->vertex_count;
    scene->positions = AT(POSITIONS);
    scene->welded = AT(WELDED);
    scene->welded_count = head->welded_count;
    scene->normals = AT(NORMALS);
    scene->texcoords = AT(TEXCOORDS);
    scene->second_texcoords = head->has_second_texcoords ? AT(SECOND_TEXCOORDS) : NULL;
    scene->tangents = head->has_tangents ? AT(TANGENTS) : NULL;
    scene->colors = head->has_colors ? AT(COLORS) : NULL;
    scene->triangle_count = head->triangle_count;
    scene->triangles = AT(TRIANGLES);
    scene->material_of = AT(MATERIAL_OF);
    scene->material_count = head->material_count;
    scene->materials = AT(MATERIALS);
    scene->extensions = head->has_extensions ? AT(EXTENSIONS) : NULL;
    scene->texture_count = head->texture_count;
    scene->light_count = head->light_count;
    scene->lights = AT(LIGHTS);
    scene->viewpoint_count = head->viewpoint_count;
    scene->viewpoints = AT(VIEWPOINTS);
    if (head->environment_size[0] > 0)
        scene->environment = (gw_environment){.rgbe = {.width = head->environment_size[0],
                                                       .height = head->environment_size[1],
                                                       .rgba = AT(ENVIRONMENT)},
                                              .scale = head->environment_scale,
                                              .rotation = head->environment_rotation};
    memcpy(scene->ambient, head->ambient, sizeof scene->ambient);
    memcpy(scene->background, head->background, sizeof scene->background);
    scene->placement = head->placement;
    memcpy(scene->centre, head->centre, sizeof scene->centre);
    scene->exponent = head->exponent;
    memcpy(scene->bounds, head->bounds, sizeof scene->bounds);
#undef AT
}

gw_code gw_unpack_scene(const void *block, size_t size, gw_unpacked_scene *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_code code = gw_block_check_head(block, size, &kind, what, error);
    if (code)
        return code;
    header head;
    if (size < sizeof head)
        return broken(error, "it is cut");
    memcpy(&head, block, sizeof head);
    code = check_sections(block, size, &head, error);
    if (code)
        return code;
    /* gw_scene has no const pointers because its makers fill it; nobody writes through these. */
    uint8_t *bytes = (uint8_t *)(uintptr_t)block;
    view_scene(bytes, &head, &out->scene);
    code = view_textures(bytes, &head, out, error);
    if (!code)
        code = view_animation(bytes, &head, &out->scene, error);
    if (!code)
        code = check_indices(&out->scene, error);
    if (code)
        gw_unpacked_scene_finish(out);
    return code;
}

void gw_unpacked_scene_finish(gw_unpacked_scene *unpacked) {
    free(unpacked->textures);
    gw_animation_destroy(&unpacked->scene.animation);
    memset(unpacked, 0, sizeof *unpacked);
}
