/* The lights of a frame as kernels read them: directional ones first, then those that have a place. Plain
 * values; any thread. */
#ifndef GW_RENDER_LIGHT_LIST_H
#define GW_RENDER_LIGHT_LIST_H

#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"
#include "shaders/common/frame.h"

typedef struct gw_light_list {
    uint32_t directional, placed; /* rows of each */
    gw_gpu_light *rows;           /* owned */
} gw_light_list;

gw_code gw_light_list_make(const gw_scene *scene, gw_light_list *out, gw_error *error);
void gw_light_list_finish(gw_light_list *list);

#endif
