#include "wall/model.h"

#include "base/clock.h"
#include "build/import.h"

#include <inttypes.h>
#include <stddef.h>

gw_code gw_model_open_device(gw_model *model, const gw_draw_options *options, const gw_log *log,
                             gw_error *error) {
    gw_gl_options device = {.shader_folder = options->shaders, .log = log};
    return gw_gl_create(&device, &model->device, error);
}

gw_code gw_model_import(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error) {
    int64_t begin = gw_now_ns();
    gw_import_options import = {.log = log};
    gw_code code = gw_import(options->scene, &import, &model->scene, error);
    model->import_ms = (double)(gw_now_ns() - begin) * 1e-6;
    if (!code)
        gw_log_write(log, GW_LOG_INFO,
                     "scene %s: %" PRIu32 " triangles, %" PRIu32 " textures, read in %.1f s",
                     model->scene->path, model->scene->triangle_count, model->scene->texture_count,
                     model->import_ms * 1e-3);
    return code;
}

gw_code gw_model_build(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error) {
    int64_t begin = gw_now_ns();
    gw_octree_options build = {.settings = &options->settings, .log = log};
    gw_code code = gw_octree_build(model->device, model->scene, &build, &model->octree, error);
    model->build_ms = (double)(gw_now_ns() - begin) * 1e-6;
    if (!code)
        gw_log_write(log, GW_LOG_INFO, "octree: depth %" PRIu32 ", %" PRIu32 " nodes, built in %.1f s",
                     model->octree->depth, model->octree->node_count, model->build_ms * 1e-3);
    return code;
}

gw_code gw_model_open(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error) {
    gw_code code = gw_model_import(model, options, log, error);
    if (!code)
        code = gw_model_open_device(model, options, log, error);
    if (!code)
        code = gw_model_build(model, options, log, error);
    return code;
}

void gw_model_drop(gw_model *model) {
    gw_octree_destroy(&model->octree);
    gw_scene_destroy(&model->scene);
}

void gw_model_close(gw_model *model) {
    gw_model_drop(model);
    gw_gl_destroy(&model->device);
}
