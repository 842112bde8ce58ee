/* What every drawing verb starts with: the GL device, the imported scene and its octree. The thread that
 * opened a model owns its device. */
#ifndef GW_WALL_MODEL_H
#define GW_WALL_MODEL_H

#include "base/gl.h"
#include "base/log.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "wall/options.h"

typedef struct gw_model {
    gw_gl *device;
    gw_scene *scene;
    gw_octree *octree;
    double import_ms, build_ms; /* wall clock */
    int from_cache;             /* the octree was read, not built */
    uint64_t build_peak;        /* most bytes of buffers on the GPU while it was built; 0 if it was not */
} gw_model;

/* Opens the device only. */
gw_code gw_model_open_device(gw_model *model, const gw_draw_options *options, const gw_log *log,
                             gw_error *error);
/* Keeps the binaries of what was compiled so far, where the device reads them in later runs; a folder that
 * cannot be written is a warning. Accepts NULL. */
void gw_model_keep_programs(gw_gl *device, const gw_log *log);
/* Imports the scene only: needs no device. */
gw_code gw_model_import(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error);
/* Reads the octree of the imported scene from the cache, if it is there; needs no device. A file that is
 * refused is a warning. Returns 1 when it was read. */
int gw_model_find(gw_model *model, const gw_draw_options *options, const gw_log *log);
/* Takes over an octree that was built since begin (gw_now_ns clock) and keeps it in the cache, if there is
 * one; a cache that cannot be written is a warning. */
void gw_model_keep(gw_model *model, const gw_draw_options *options, gw_octree *octree, int64_t begin,
                   const gw_log *log);
/* Finds the octree of the imported scene, or builds it on the open device and keeps it. */
gw_code gw_model_build(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error);
/* Import first, because a wrong path is the commonest mistake and should be told at once; then device and
 * octree. */
gw_code gw_model_open(gw_model *model, const gw_draw_options *options, const gw_log *log, gw_error *error);
/* Frees scene and octree, keeps the device. */
void gw_model_drop(gw_model *model);
void gw_model_close(gw_model *model);

#endif
