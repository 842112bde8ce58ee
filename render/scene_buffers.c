/* See scene_buffers.h. */
#include "render/scene_buffers.h"

#include "base/memory.h"
#include "build/gpu_types.h"
#include "render/albedo_table.h"
#include "render/gloss.h"
#include "render/light_list.h"
#include "render/material_rows.h"
#include "render/root_grid.h"
#include "render/transmission.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ENVIRONMENT_UNIT = 20 }; /* and the next: shade/environment.glsl */

/* Octahedral unit normal in 2 x 16 bits, 0..65534 for -1..1 so that 0 is exact (common/octahedral.glsl
 * decodes). */
static uint32_t encode_normal(const float n[3]) {
    double size = fabs((double)n[0]) + fabs((double)n[1]) + fabs((double)n[2]);
    if (!(size > 0.0) || !isfinite(size))
        return UINT32_MAX;
    double x = (double)n[0] / size, y = (double)n[1] / size;
    if (n[2] < 0.0f) {
        double folded = (1.0 - fabs(y)) * (x >= 0.0 ? 1.0 : -1.0);
        y = (1.0 - fabs(x)) * (y >= 0.0 ? 1.0 : -1.0);
        x = folded;
    }
    uint32_t u = (uint32_t)lround((x + 1.0) * 32767.0), v = (uint32_t)lround((y + 1.0) * 32767.0);
    return u | (v << 16);
}

static int needs_alpha(const gw_material *material) {
    return material->alpha_mode != GW_ALPHA_OPAQUE;
}

static gw_code upload_triangles(gw_gl *device, const gw_scene *scene, gw_scene_buffers *out,
                                gw_error *error) {
    size_t count = scene->triangle_count;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, count, sizeof(gw_gpu_triangle), "triangles for the GPU", error);
    gw_gpu_triangle *triangles = memory;
    for (size_t i = 0; !code && i < count; ++i) {
        uint32_t flags = (needs_alpha(&scene->materials[scene->material_of[i]]) ? GW_TRIANGLE_ALPHA : 0) |
                         gw_transmission_flags(scene, scene->material_of[i]);
        for (int k = 0; k < 3; ++k)
            memcpy(triangles[i].vertex[k], scene->positions + (size_t)scene->triangles[i][k] * 3,
                   3 * sizeof(float));
        memcpy(&triangles[i].vertex[0][3], &flags, sizeof flags);
    }
    if (!code)
        code = gw_gl_buffer_create(device, "triangles", count * sizeof *triangles, triangles, GL_RGBA32UI,
                                   &out->triangles, error);
    free(memory);
    return code;
}

static gw_code upload_faces(gw_gl *device, const gw_scene *scene, gw_scene_buffers *out, gw_error *error) {
    size_t count = scene->triangle_count;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, count, sizeof(gw_gpu_face), "faces for the GPU", error);
    gw_gpu_face *faces = memory;
    for (size_t i = 0; !code && i < count; ++i) {
        memcpy(faces[i].vertex, scene->triangles[i], sizeof faces[i].vertex);
        faces[i].material = scene->material_of[i];
    }
    if (!code)
        code = gw_gl_buffer_create(device, "faces", count * sizeof *faces, faces, GL_RGBA32UI, &out->faces,
                                   error);
    free(memory);
    return code;
}

static gw_code upload_vertices(gw_gl *device, const gw_scene *scene, gw_scene_buffers *out, gw_error *error) {
    static const float none[3] = {0};
    void *memory = NULL;
    gw_code code =
        gw_allocate(&memory, scene->vertex_count, sizeof(gw_gpu_vertex), "vertices for the GPU", error);
    if (code)
        return code;
    gw_gpu_vertex *vertices = memory;
    for (size_t i = 0; i < scene->vertex_count; ++i) {
        vertices[i].normal = encode_normal(scene->normals ? scene->normals + i * 3 : none);
        vertices[i].u = scene->texcoords ? scene->texcoords[i * 2] : 0.0f;
        vertices[i].v = scene->texcoords ? scene->texcoords[i * 2 + 1] : 0.0f;
        vertices[i].color = UINT32_MAX;
        if (scene->colors) {
            const uint8_t *c = scene->colors + i * 4;
            vertices[i].color =
                (uint32_t)c[0] | (uint32_t)c[1] << 8 | (uint32_t)c[2] << 16 | (uint32_t)c[3] << 24;
        }
    }
    code = gw_gl_buffer_create(device, "vertices", scene->vertex_count * sizeof *vertices, vertices,
                               GL_RGBA32UI, &out->vertices, error);
    free(memory);
    return code;
}

static void fill_material(const gw_material *in, const gw_texture_set *textures, gw_gpu_material *out) {
    memcpy(out->base_color, in->base_color, sizeof out->base_color);
    memcpy(out->emissive, in->emissive, 3 * sizeof(float));
    out->emissive[3] = in->metalness;
    out->words[0] = gw_texture_word(textures, in->base_color_texture, GW_TEXTURE_COLOR);
    out->words[1] = in->alpha_mode == GW_ALPHA_MASK    ? GW_MATERIAL_MASK
                    : in->alpha_mode == GW_ALPHA_BLEND ? GW_MATERIAL_BLEND
                                                       : 0;
    memcpy(&out->words[2], &in->alpha_cutoff, sizeof(float));
    memcpy(&out->words[3], &in->roughness, sizeof(float));
}

static gw_code upload_materials(gw_gl *device, const gw_scene *scene, gw_scene_buffers *out,
                                gw_error *error) {
    void *memory = NULL;
    gw_code code =
        gw_allocate(&memory, scene->material_count, sizeof(gw_gpu_material), "materials for the GPU", error);
    if (code)
        return code;
    gw_gpu_material *materials = memory;
    for (uint32_t i = 0; i < scene->material_count; ++i)
        fill_material(&scene->materials[i], &out->textures, &materials[i]);
    code = gw_gl_buffer_create(device, "materials", scene->material_count * sizeof *materials, materials,
                               GL_RGBA32UI, &out->materials, error);
    free(memory);
    return code;
}

/* Zeros, which are none, where the scene has none. */
static gw_code upload_tangents(gw_gl *device, const gw_scene *scene, gw_scene_buffers *out, gw_error *error) {
    const size_t bytes = scene->vertex_count * sizeof *scene->tangents;
    void *none = NULL;
    gw_code code = scene->tangents ? GW_OK : gw_allocate(&none, bytes, 1, "tangents for the GPU", error);
    if (!code)
        code = gw_gl_buffer_create(device, "tangents", bytes, scene->tangents ? scene->tangents : none,
                                   GL_R32UI, &out->tangents, error);
    free(none);
    return code;
}

static int has_sheen(const gw_scene *scene) {
    for (uint32_t i = 0; scene->extensions && i < scene->material_count; ++i)
        for (int c = 0; c < 3; ++c)
            if (scene->extensions[i].sheen_color[c] > 0.0f)
                return 1;
    return 0;
}

static gw_code upload_tables(int sheen, gw_scene_buffers *out, gw_error *error) {
    float albedo[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE][2], of_sheen[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE];
    gw_albedo_table_fill(albedo);
    out->albedo_table = gw_albedo_table_texture(GL_RG32F, GL_RG, albedo);
    if (sheen) {
        gw_sheen_table_fill(of_sheen);
        out->sheen_table = gw_albedo_table_texture(GL_R32F, GL_RED, of_sheen);
    }
    return gw_gl_check("uploading tables of reflection", error);
}

/* With the root grid behind them, if the device's buffer textures hold both. */
static gw_code upload_nodes(gw_gl *device, const gw_octree *octree, gw_scene_buffers *out, gw_error *error) {
    uint32_t level = gw_root_grid_level(octree);
    size_t begin = gw_root_grid_begin(octree), size = gw_root_grid_size(level);
    if (begin + size > (size_t)gw_gl_limits_of(device)->texture_buffer_texels)
        level = 0;
    out->root_grid_level = level;
    if (level == 0)
        return gw_gl_buffer_create(device, "octree nodes", octree->node_count * sizeof(gw_node),
                                   octree->nodes, GL_RG32UI, &out->nodes, error);
    void *grid = NULL;
    gw_code code = gw_allocate(&grid, size, sizeof(gw_node), "the root grid", error);
    if (code)
        return code;
    gw_root_grid_fill(octree, level, grid);
    code = gw_gl_buffer_create(device, "octree nodes", (begin + size) * sizeof(gw_node), NULL, GL_RG32UI,
                               &out->nodes, error);
    if (!code)
        code = gw_gl_buffer_write(&out->nodes, 0, octree->node_count * sizeof(gw_node), octree->nodes, error);
    if (!code)
        code = gw_gl_buffer_write(&out->nodes, begin * sizeof(gw_node), size * sizeof(gw_node), grid, error);
    free(grid);
    return code;
}

static gw_code upload_octree(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                             gw_scene_buffers *out, gw_error *error) {
    gw_code code = upload_nodes(device, octree, out, error);
    if (!code)
        code = gw_transmission_mark_nodes(scene, octree, &out->nodes, error);
    if (!code)
        code = gw_gl_buffer_create(device, "octree references", octree->reference_count * sizeof(uint32_t),
                                   octree->references, GL_R32UI, &out->references, error);
    if (!code)
        code = gw_gl_buffer_create(device, "octree payload", octree->node_count * sizeof(gw_payload),
                                   octree->payloads, GL_RGB32UI, &out->payloads, error);
    if (!code && octree->emissions)
        code = gw_gl_buffer_create(device, "emissions of voxels", (size_t)gw_octree_emission_bytes(octree),
                                   octree->emissions, GL_R32UI, &out->emissions, error);
    if (!code && octree->boxes)
        code = gw_gl_buffer_create(device, "boxes of dense leaves", (size_t)gw_octree_box_bytes(octree),
                                   octree->boxes, GL_RGBA32UI, &out->boxes, error);
    return code;
}

static gw_code upload_lights(gw_gl *device, const gw_light_list *list, gw_scene_buffers *out,
                             gw_error *error) {
    const size_t bytes = gw_light_list_bytes(list);
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, bytes, 1, "lights for the GPU", error);
    if (!code) {
        gw_light_list_copy(list, memory);
        code = gw_gl_buffer_create(device, "lights", bytes, memory, GL_RGBA32UI, &out->lights, error);
    }
    free(memory);
    return code;
}

gw_code gw_scene_buffers_light(gw_gl *device, const gw_scene *scene, const gw_light_knobs *knobs,
                               gw_scene_buffers *buffers, gw_error *error) {
    gw_light from_environment[GW_MAXIMUM_ENVIRONMENT_LIGHTS];
    uint32_t count = 0;
    gw_gl_buffer_finish(&buffers->lights);
    gw_light_list_finish(&buffers->list);
    gw_environment_textures_finish(&buffers->environment);
    gw_code code = gw_environment_textures_init(scene, knobs->environment_lights, from_environment, &count,
                                                &buffers->environment, error);
    if (!code)
        code = gw_light_list_make(scene, from_environment, count, knobs, &buffers->list, error);
    buffers->environment_count = count;
    return code ? code : upload_lights(device, &buffers->list, buffers, error);
}

gw_code gw_scene_buffers_init(gw_gl *device, const gw_scene *scene, const gw_octree *octree, int extensions,
                              const gw_light_knobs *knobs, gw_scene_buffers *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_code code = upload_octree(device, scene, octree, out, error);
    if (!code)
        code = upload_triangles(device, scene, out, error);
    if (!code)
        code = upload_faces(device, scene, out, error);
    if (!code)
        code = upload_vertices(device, scene, out, error);
    if (!code)
        code = gw_texture_set_init(device, scene, GW_TEXTURE_COLOR, &out->textures, error);
    if (!code)
        code = gw_texture_set_init(device, scene, GW_TEXTURE_DATA, &out->data, error);
    if (!code)
        code = upload_materials(device, scene, out, error);
    if (!code && (scene->extensions || extensions))
        code = gw_material_rows_upload(device, scene, &out->textures, &out->data, &out->extensions, error);
    if (!code && (scene->second_texcoords || extensions))
        code = gw_gl_buffer_create(device, "second coordinates", scene->vertex_count * 2 * sizeof(float),
                                   scene->second_texcoords, GL_RG32UI, &out->second_texcoords, error);
    if (!code && (scene->tangents || extensions))
        code = upload_tangents(device, scene, out, error);
    if (!code)
        code = gw_scene_buffers_light(device, scene, knobs, out, error);
    if (!code)
        code = upload_tables(extensions || has_sheen(scene), out, error);
    if (!code)
        code = gw_smoothest_texels(scene, &out->smoothest, error);
    if (code)
        gw_scene_buffers_finish(out);
    return code;
}

gw_code gw_scene_buffers_move(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                              gw_scene_buffers *buffers, gw_error *error) {
    gw_gl_buffer *all[] = {&buffers->nodes, &buffers->references, &buffers->payloads, &buffers->emissions,
                           &buffers->boxes, &buffers->triangles,  &buffers->vertices};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    gw_code code = upload_octree(device, scene, octree, buffers, error);
    if (!code)
        code = upload_triangles(device, scene, buffers, error);
    if (!code)
        code = upload_vertices(device, scene, buffers, error);
    return code;
}

void gw_scene_buffers_finish(gw_scene_buffers *buffers) {
    gw_light_list_finish(&buffers->list);
    gw_texture_set_finish(&buffers->textures);
    gw_environment_textures_finish(&buffers->environment);
    gw_texture_set_finish(&buffers->data);
    free(buffers->smoothest);
    const GLuint tables[2] = {buffers->albedo_table, buffers->sheen_table};
    glDeleteTextures(2, tables);
    gw_gl_buffer *all[] = {&buffers->nodes,     &buffers->references, &buffers->triangles,
                           &buffers->payloads,  &buffers->faces,      &buffers->vertices,
                           &buffers->materials, &buffers->lights,     &buffers->emissions,
                           &buffers->boxes,     &buffers->extensions, &buffers->second_texcoords,
                           &buffers->tangents};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    memset(buffers, 0, sizeof *buffers);
}

void gw_scene_buffers_bind(const gw_scene_buffers *buffers, uint32_t texture_filter) {
    gw_gl_texture_bind(&buffers->nodes, 0);
    gw_gl_texture_bind(&buffers->references, 1);
    gw_gl_texture_bind(&buffers->triangles, 2);
    gw_gl_texture_bind(&buffers->payloads, 3);
    gw_gl_texture_bind(&buffers->faces, 4);
    gw_gl_texture_bind(&buffers->vertices, 5);
    gw_gl_texture_bind(&buffers->materials, 6);
    gw_gl_texture_bind(&buffers->lights, 7);
    gw_environment_textures_bind(&buffers->environment, ENVIRONMENT_UNIT);
    gw_texture_set_bind(&buffers->textures, texture_filter, 8);
    if (buffers->emissions.texture)
        gw_gl_texture_bind(&buffers->emissions, 8 + GW_MAXIMUM_TEXTURE_CLASSES);
    if (buffers->boxes.texture)
        gw_gl_texture_bind(&buffers->boxes, 9 + GW_MAXIMUM_TEXTURE_CLASSES);
    if (buffers->extensions.texture)
        gw_gl_texture_bind(&buffers->extensions, GW_UNIT_EXTENSIONS);
    if (buffers->second_texcoords.texture)
        gw_gl_texture_bind(&buffers->second_texcoords, GW_UNIT_SECOND_TEXCOORDS);
    if (buffers->tangents.texture)
        gw_gl_texture_bind(&buffers->tangents, GW_UNIT_TANGENTS);
    gw_texture_set_bind(&buffers->data, texture_filter, GW_UNIT_DATA);
    glBindTextureUnit(GW_UNIT_ALBEDO, buffers->albedo_table);
    if (buffers->sheen_table)
        glBindTextureUnit(GW_UNIT_SHEEN, buffers->sheen_table);
}
