/* The lights of a frame as kernels read them: directional ones first, then those that have a place, emissive
 * surfaces last. Plain values; any thread. */
#ifndef GW_RENDER_LIGHT_LIST_H
#define GW_RENDER_LIGHT_LIST_H

#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"
#include "render/emissive_lights.h"
#include "render/frame_state.h"
#include "shaders/common/frame.h"

enum { GW_LIGHTS_DIRECTIONAL = 1, GW_LIGHTS_POINT = 2, GW_LIGHTS_SPOT = 4 };

/* What a frame's state and forbidden effects say of lights; the rest is the scene's. Compared as bytes. */
typedef struct gw_light_knobs {
    uint8_t environment_lights; /* at most, 0 to GW_MAXIMUM_ENVIRONMENT_LIGHTS */
    uint8_t shadow_samples;     /* of a light with an extent: 1, 4 or 16; 0: as if it had none */
    uint8_t emissive_lights;    /* at most, 0 to GW_MAXIMUM_EMISSIVE_LIGHTS */
    uint8_t left_out;           /* GW_LIGHTS_: directional ones; points and rectangles; spots, and ranges */
    float light_least;          /* radiance below which the light of one with a place ends; 0: nowhere */
    float emissive_least;       /* the same of emissive surfaces */
    float emissive_faintest;    /* least radiance of a light's surface */
} gw_light_knobs;

gw_light_knobs gw_light_knobs_of(const gw_frame_state *state);

typedef enum gw_light_source {
    GW_LIGHT_OF_SCENE,
    GW_LIGHT_OF_ENVIRONMENT,
    GW_LIGHT_OF_SURFACES
} gw_light_source;

/* A light of the list, for reports. */
typedef struct gw_light_note {
    gw_light_source source;
    gw_light_kind kind; /* unless it is of surfaces */
    float color[3];     /* irradiance, as gw_light has it */
    double extent; /* directional: half-angle, rad; others: m; of a rectangle and of surfaces the root of the
                      area */
    double reach;  /* m at which it ends, 0: nowhere */
    uint32_t rows; /* points, each with a shadow ray */
    uint32_t triangles; /* of surfaces */
    double folded;      /* share of it that neighbours stand for */
} gw_light_note;

typedef struct gw_light_list {
    uint32_t directional, placed, emissive; /* rows of each; emissive: the last of those that are placed */
    int wide;                               /* some row is of a light with an extent */
    int ends;                               /* some row is of a light of the scene that ends somewhere */
    gw_gpu_light *rows;                     /* owned, as all below */
    gw_emissive_lights surfaces;
    gw_light_note *notes;
    uint32_t note_count;
    uint32_t left_out; /* lights for which GW_MOST_LIGHTS rows had no room; fewer points a light come first */
} gw_light_list;

/* environment: of gw_environment_cut(), `count` of them. */
gw_code gw_light_list_make(const gw_scene *scene, const gw_light *environment, uint32_t count,
                           const gw_light_knobs *knobs, gw_light_list *out, gw_error *error);
/* Rows and slots, as the buffer has them. */
size_t gw_light_list_bytes(const gw_light_list *list);
void gw_light_list_copy(const gw_light_list *list, void *to);
void gw_light_list_finish(gw_light_list *list);

#endif
