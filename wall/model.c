#include "wall/model.h"

#include "base/clock.h"
#include "base/file.h"
#include "build/import.h"
#include "build/octree_cache.h"
#include "wall/interrupt.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>

gw_code gw_model_open_device(gw_model *model, const gw_draw_options *options, const gw_log *log,
                             gw_error *error) {
    char *cache = gw_cache_folder(options);
    const gw_gl_options device = {.shader_folder = options->shaders,
                                  .log = log,
                                  .binaries = cache,
                                  .choose_gpu = options->choose_gpu,
                                  .gpu = options->gpu};
    gw_code code = gw_gl_create(&device, &model->device, error);
    free(cache);
    return code;
}

void gw_model_keep_programs(gw_gl *device, const gw_log *log) {
    gw_error unwritten = {0};
    if (!device)
        return;
    gw_interrupt_hold();
    if (gw_gl_keep_programs(device, &unwritten))
        gw_log_write(log, GW_LOG_WARNING, "compiled programs are not kept: %s", unwritten.text);
    gw_interrupt_release();
}

gw_code gw_model_import(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error) {
    int64_t begin = gw_now_ns();
    gw_import_options import = {
        .outlier_extents = options->settings.outlier_extents, .animation = options->animation, .log = log};
    gw_code code = gw_import(options->scene, &import, &model->scene, error);
    model->import_ms = (double)(gw_now_ns() - begin) * 1e-6;
    if (!code)
        gw_log_write(log, GW_LOG_INFO,
                     "scene %s: %" PRIu32 " triangles, %" PRIu32 " textures, read in %.1f s",
                     model->scene->path, model->scene->triangle_count, model->scene->texture_count,
                     model->import_ms * 1e-3);
    return code;
}

/* Where the model's octree is kept, and under which key; free() it. NULL when nothing is kept. */
static char *cache_path(const gw_model *model, const gw_draw_options *options, gw_hash *key) {
    char *folder = gw_cache_folder(options);
    if (!folder)
        return NULL;
    *key = gw_octree_cache_key(model->scene, &options->settings);
    char *path = gw_octree_cache_path(folder, *key);
    free(folder);
    return path;
}

int gw_model_find(gw_model *model, const gw_draw_options *options, const gw_log *log) {
    gw_hash key;
    gw_error refused = {0};
    char *path = cache_path(model, options, &key);
    int64_t begin = gw_now_ns();
    model->from_cache = 0;
    if (path && gw_file_exists(path)) {
        if (gw_octree_cache_load(path, key, model->scene, &model->octree, &refused))
            gw_log_write(log, GW_LOG_WARNING, "%s; the octree is built again", refused.text);
        else
            model->from_cache = 1;
    }
    if (model->from_cache) {
        model->build_ms = (double)(gw_now_ns() - begin) * 1e-6;
        gw_log_write(log, GW_LOG_INFO, "octree: depth %" PRIu32 ", %" PRIu32 " nodes, read from %s in %.1f s",
                     model->octree->depth, model->octree->node_count, path, model->build_ms * 1e-3);
    }
    free(path);
    return model->from_cache;
}

void gw_model_keep(gw_model *model, const gw_draw_options *options, gw_octree *octree, int64_t begin,
                   const gw_log *log) {
    gw_hash key;
    gw_error unwritten = {0};
    model->octree = octree;
    model->build_ms = (double)(gw_now_ns() - begin) * 1e-6;
    gw_log_write(log, GW_LOG_INFO, "octree: depth %" PRIu32 ", %" PRIu32 " nodes, built in %.1f s",
                 octree->depth, octree->node_count, model->build_ms * 1e-3);
    char *path = cache_path(model, options, &key);
    if (!path)
        return;
    gw_interrupt_hold();
    if (gw_octree_cache_store(path, key, octree, options->cache_limit, &unwritten))
        gw_log_write(log, GW_LOG_WARNING, "the octree is not kept: %s", unwritten.text);
    gw_interrupt_release();
    free(path);
}

gw_code gw_model_build(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error) {
    if (gw_model_find(model, options, log))
        return GW_OK;
    int64_t begin = gw_now_ns();
    gw_octree *octree = NULL;
    gw_octree_options how = {.settings = &options->settings, .log = log};
    gw_gl_reset_peak(model->device);
    gw_code code = gw_octree_build(model->device, model->scene, &how, &octree, error);
    model->build_peak = gw_gl_usage_of(model->device).peak;
    if (!code)
        gw_model_keep(model, options, octree, begin, log);
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
