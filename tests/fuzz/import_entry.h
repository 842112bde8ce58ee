/* What the fuzzers and the unit tests do with hostile bytes of the import: the child's stream and the JSON
 * side of glTF. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_IMPORT_ENTRY_H
#define GW_TESTS_FUZZ_IMPORT_ENTRY_H

#include "build/animation.h"
#include "build/gltf.h"
#include "build/gltf_animation.h"
#include "build/gltf_data.h"
#include "build/import_stream.h"
#include "build/scene.h"

#include <math.h>
#include <stdlib.h>

static inline void import_require(int holds) {
    if (!holds)
        abort();
}

static inline void import_check_scene(const gw_scene *scene) {
    for (uint32_t i = 0; i < scene->vertex_count * 3; i++)
        import_require(scene->positions[i] >= -1.0f && scene->positions[i] <= 1.0f);
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        import_require(scene->material_of[i] < scene->material_count);
        for (int k = 0; k < 3; k++)
            import_require(scene->triangles[i][k] < scene->vertex_count);
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        import_require(scene->welded[v] < scene->welded_count);
}

/* Whatever a stream holds, it is refused with a sentence or becomes a scene that keeps its promises. */
static inline void fuzz_model_stream(const uint8_t *data, size_t size) {
    gw_error error = {0};
    gw_source_model *model = NULL;
    gw_code code = gw_model_stream_read(data, size, &model, &error);
    import_require((code == GW_OK) == (model != NULL));
    import_require(code == GW_OK || error.text[0] != '\0');
    if (model && gw_source_model_smooth_normals(model, 60.0, &error) == GW_OK &&
        gw_scene_finish(model->scene, model->world, &error) == GW_OK)
        import_check_scene(model->scene);
    gw_source_model_destroy(&model);
}

/* What an import child would tell: the first primitive of the first nodes that have a mesh. */
static inline void import_make_spans(const gw_gltf *gltf, gw_source_model *model) {
    enum { SPANS = 8, VERTICES = 4096 };
    const json_t *nodes = json_object_get(gltf->root, "nodes"),
                 *meshes = json_object_get(gltf->root, "meshes");
    model->spans = calloc(SPANS, sizeof *model->spans);
    model->world = calloc(SPANS * VERTICES, 3 * sizeof *model->world);
    import_require(model->spans && model->world);
    for (size_t i = 0; i < json_array_size(nodes) && model->span_count < SPANS; i++) {
        const json_t *mesh = json_object_get(json_array_get(nodes, i), "mesh");
        const json_t *primitive = json_array_get(
            json_object_get(json_array_get(meshes, (size_t)json_integer_value(mesh)), "primitives"), 0);
        const json_t *positions = json_object_get(json_object_get(primitive, "attributes"), "POSITION");
        const size_t count = gw_gltf_count(gltf, (size_t)json_integer_value(positions));
        if (!mesh || !positions || count > VERTICES)
            continue;
        model->spans[model->span_count++] = (gw_vertex_span){.node = (uint32_t)i,
                                                             .mesh = (uint32_t)json_integer_value(mesh),
                                                             .first = model->scene->vertex_count,
                                                             .count = (uint32_t)count};
        model->scene->vertex_count += (uint32_t)count;
    }
}

/* Whatever moves is refused with a sentence or has a pose at any time. */
static inline void fuzz_animation(const gw_gltf *gltf) {
    static const int64_t times[] = {0, 1, 1234567890, INT64_MAX, INT64_MIN};
    gw_error error = {0};
    gw_source_model *model = NULL;
    import_require(gw_source_model_create(&model, &error) == GW_OK);
    import_make_spans(gltf, model);
    const gw_code code = gw_gltf_animate(gltf, NULL, "all", model, &error);
    import_require(code == GW_OK || error.text[0] != '\0');
    const gw_animation *animation = model->scene->animation;
    if (animation) {
        gw_pose pose;
        double *positions = calloc(animation->vertex_count + 1, 3 * sizeof *positions);
        float *normals = calloc(animation->vertex_count + 1, 3 * sizeof *normals);
        import_require(positions && normals && gw_animation_check(animation, &error) == GW_OK);
        import_require(gw_pose_init(animation, &pose, &error) == GW_OK);
        for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
            gw_pose_at_time(animation, times[i], &pose);
            gw_pose_vertices(animation, &pose, positions, normals);
        }
        gw_pose_finish(&pose);
        free(positions);
        free(normals);
    }
    gw_source_model_destroy(&model);
}

/* Materials are taken over or refused with a sentence; what is taken over has no fault. */
static inline void fuzz_materials(const gw_gltf *gltf, gw_source_model *model) {
    enum { MATERIALS = 16 };
    gw_error error = {0};
    const size_t count = json_array_size(json_object_get(gltf->root, "materials"));
    gw_scene *scene = model->scene;
    scene->material_count = count < MATERIALS ? (uint32_t)count : MATERIALS;
    scene->materials = calloc(MATERIALS, sizeof *scene->materials);
    model->material_sources = calloc(MATERIALS, sizeof *model->material_sources);
    import_require(scene->materials && model->material_sources);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        model->material_sources[i] = gw_material_source_none();
        model->material_sources[i].file_index = (int32_t)i;
    }
    const gw_code code = gw_gltf_apply(gltf, NULL, model, &error);
    import_require(code == GW_OK || error.text[0] != '\0');
    for (uint32_t i = 0; code == GW_OK && i < scene->material_count; i++) {
        import_require(!scene->extensions || !gw_material_extension_fault(scene, i));
        for (int map = 0; map < GW_MAP_COUNT; map++)
            import_require(model->material_sources[i].maps[map] < (int64_t)model->source_count);
    }
}

static inline void fuzz_gltf(const uint8_t *data, size_t size) {
    gw_error error = {0};
    gw_gltf gltf;
    gw_code code = gw_gltf_open(data, size, NULL, &gltf, &error);
    import_require(code == GW_OK || error.text[0] != '\0');
    if (code != GW_OK)
        return;
    gw_bytes marked = {0};
    gw_source_model *model = NULL;
    import_require(gw_source_model_create(&model, &error) == GW_OK);
    gw_gltf_promised_triangles(&gltf);
    if (gw_gltf_check_extensions(&gltf, model, &error) == GW_OK)
        fuzz_materials(&gltf, model);
    if (gw_gltf_mark(&gltf, &marked, &error) == GW_OK) {
        gw_gltf again; /* what is handed to assimp must still be the same kind of file */
        import_require(gw_gltf_open(marked.data, marked.size, NULL, &again, &error) == GW_OK);
        import_require(again.binary == gltf.binary);
        gw_gltf_close(&again);
    }
    gw_bytes_finish(&marked);
    gw_source_model_destroy(&model);
    fuzz_animation(&gltf);
    gw_gltf_close(&gltf);
}

#endif
