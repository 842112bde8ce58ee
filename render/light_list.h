/* The lights of a frame as kernels read them: directional ones first, then those that have a place. Plain
 * values; any thread. */
#ifndef GW_RENDER_LIGHT_LIST_H
#define GW_RENDER_LIGHT_LIST_H

#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"
#include "render/frame_state.h"
#include "shaders/common/frame.h"

/* What a frame's state says of lights; the rest is the scene's. */
typedef struct gw_light_knobs {
    uint8_t environment_lights; /* at most, 0 to GW_MAXIMUM_ENVIRONMENT_LIGHTS */
    uint8_t shadow_samples;     /* of a light with an extent: 1, 4 or 16; 0: as if it had none */
} gw_light_knobs;

gw_light_knobs gw_light_knobs_of(const gw_frame_state *state);

typedef struct gw_light_list {
    uint32_t directional, placed; /* rows of each */
    int wide;                     /* some row is of a light with an extent */
    gw_gpu_light *rows;           /* owned */
} gw_light_list;

/* environment: of gw_environment_cut(), `count` of them. */
gw_code gw_light_list_make(const gw_scene *scene, const gw_light *environment, uint32_t count,
                           const gw_light_knobs *knobs, gw_light_list *out, gw_error *error);
void gw_light_list_finish(gw_light_list *list);

#endif
