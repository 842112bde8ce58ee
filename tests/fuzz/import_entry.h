/* What the fuzzers and the unit tests do with hostile bytes of the import: the child's stream and the JSON
 * side of glTF. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_IMPORT_ENTRY_H
#define GW_TESTS_FUZZ_IMPORT_ENTRY_H

#include "build/gltf.h"
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
        import_require(gw_gltf_apply(&gltf, model, &error) == GW_OK);
    if (gw_gltf_mark(&gltf, &marked, &error) == GW_OK) {
        gw_gltf again; /* what is handed to assimp must still be the same kind of file */
        import_require(gw_gltf_open(marked.data, marked.size, NULL, &again, &error) == GW_OK);
        import_require(again.binary == gltf.binary);
        gw_gltf_close(&again);
    }
    gw_bytes_finish(&marked);
    gw_source_model_destroy(&model);
    gw_gltf_close(&gltf);
}

#endif
