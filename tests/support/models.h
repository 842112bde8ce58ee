/* A model for tests of the import: everything that a stream can carry, made by hand. Header only. */
#ifndef GW_TESTS_SUPPORT_MODELS_H
#define GW_TESTS_SUPPORT_MODELS_H

#include "build/import_stream.h"
#include "build/source_model.h"
#include "tests/support/check.h"

static inline void *test_copy(const void *from, size_t size) {
    void *copy = malloc(size);
    assert_non_null(copy);
    memcpy(copy, from, size);
    return copy;
}

/* Two triangles with every attribute, two materials, a file texture and an embedded one, a light, a
 * viewpoint, a note. */
static inline gw_source_model *test_model(void) {
    static const double world[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}};
    static const float normals[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    static const float texcoords[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    static const uint8_t colors[4][4] = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {9, 9, 9, 9}};
    static const uint32_t tangents[4] = {0x80000001u, 0, 7, 0xffffffffu};
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {1, 3, 2}};
    static const uint32_t material_of[2] = {0, 1};
    static const gw_material materials[2] = {{.name = "first",
                                              .base_color = {0.1f, 0.2f, 0.3f, 1},
                                              .roughness = 0.5f,
                                              .alpha_cutoff = 0.5f,
                                              .base_color_texture = -1},
                                             {.name = "second",
                                              .base_color = {1, 1, 1, 0.5f},
                                              .metalness = 1,
                                              .emissive = {0, 2, 0},
                                              .alpha_mode = GW_ALPHA_BLEND,
                                              .two_sided = 1,
                                              .base_color_texture = -1}};
    gw_material_source material_sources[2] = {gw_material_source_none(), gw_material_source_none()};
    material_sources[0].file_index = 3;
    material_sources[0].maps[GW_MAP_BASE_COLOR] = 0;
    material_sources[0].alpha_from_texture = 1;
    material_sources[1].maps[GW_MAP_BASE_COLOR] = 1;
    material_sources[1].maps[GW_MAP_NORMAL] = 0;
    material_sources[1].normal_may_be_height = 1;
    gw_material_extension extensions[2] = {gw_material_extension_none(), gw_material_extension_none()};
    extensions[1].ior = 1.25f;
    static const gw_light light = {.kind = GW_LIGHT_POINT, .vector = {1, 2, 3}, .color = {4, 5, 6}};
    static const gw_viewpoint view = {"door", {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
    static const uint8_t pixels[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    gw_source_model *model = NULL;
    check_ok(gw_source_model_create(&model, &error));
    gw_scene *scene = model->scene;
    scene->vertex_count = 4;
    scene->triangle_count = scene->material_count = 2;
    scene->light_count = scene->viewpoint_count = 1;
    scene->dropped.not_triangle = 5;
    model->world = test_copy(world, sizeof world);
    scene->normals = test_copy(normals, sizeof normals);
    scene->texcoords = test_copy(texcoords, sizeof texcoords);
    scene->second_texcoords = test_copy(texcoords, sizeof texcoords);
    scene->tangents = test_copy(tangents, sizeof tangents);
    scene->extensions = test_copy(extensions, sizeof extensions);
    scene->colors = test_copy(colors, sizeof colors);
    scene->triangles = test_copy(triangles, sizeof triangles);
    scene->material_of = test_copy(material_of, sizeof material_of);
    scene->materials = test_copy(materials, sizeof materials);
    scene->lights = test_copy(&light, sizeof light);
    scene->viewpoints = test_copy(&view, sizeof view);
    model->material_sources = test_copy(material_sources, sizeof material_sources);
    model->sources = calloc(2, sizeof *model->sources);
    assert_non_null(model->sources);
    model->source_count = 2;
    model->sources[0] = (gw_texture_source){.path = test_copy("wood.png", 9), .alpha_path = test_copy("", 1)};
    model->sources[1] = (gw_texture_source){.path = test_copy("*0", 3),
                                            .alpha_path = test_copy("mask.png", 9),
                                            .bytes = test_copy(pixels, sizeof pixels),
                                            .size = sizeof pixels,
                                            .raw_width = 2,
                                            .raw_height = 1,
                                            .wrap_u = GW_WRAP_CLAMP,
                                            .wrap_v = GW_WRAP_MIRROR};
    check_ok(gw_scene_note(scene, &error, "a note"));
    return model;
}

/* The stream of a model; free() it. */
static inline uint8_t *test_stream(const gw_source_model *model, size_t *size) {
    char *bytes = NULL;
    FILE *file = open_memstream(&bytes, size);
    assert_non_null(file);
    check_ok(gw_model_stream_write(file, model, &error));
    fclose(file);
    return (uint8_t *)bytes;
}

#endif
