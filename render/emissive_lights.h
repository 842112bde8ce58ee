/* What shines of its own as lights: the triangles that emit light, gathered into a few clusters, each a light
 * with the shape of its triangles. Host only, the same bits on every machine; any thread.
 *
 * A cluster's triangles share its slots by power (luminance times area), in their order in the scene, which
 * is along a curve that fills space: an even number from 0 to 1 picks a slot and a place in it, and so a
 * place of the cluster by power. Every slot stands for the same power. Triangles that have less than half a
 * slot may have none; their power goes to those before and after them. */
#ifndef GW_RENDER_EMISSIVE_LIGHTS_H
#define GW_RENDER_EMISSIVE_LIGHTS_H

#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"
#include "shaders/common/frame.h"

#include <stdint.h>

enum { GW_MAXIMUM_EMISSIVE_LIGHTS = 64, GW_MOST_EMISSIVE_SLOTS = 4096 };

typedef struct gw_emissive_light {
    uint32_t first_slot, slot_count; /* count: a power of two */
    uint32_t triangles;
    double area;      /* m^2 */
    double color[3];  /* irradiance at 1 m of all of it, turned to there: radiance times area */
    double folded;    /* share of its power whose triangles have no slot */
    double middle[3]; /* scene metres, by power */
    double deviation; /* m, of places from the middle */
} gw_emissive_light;

typedef struct gw_emissive_lights {
    uint32_t count;
    uint32_t faint_triangles; /* that no light stands for */
    double faint;             /* their share of the power of all */
    gw_emissive_light lights[GW_MAXIMUM_EMISSIVE_LIGHTS];
    uint32_t slot_count;
    gw_emissive_slot *slots; /* owned */
} gw_emissive_lights;

/* At most `most` lights, of what emits at least the radiance `faintest` in some channel. Clusters are cut
 * across their longest direction where that lowers the variance of places most, always the one with the most
 * power times variance, until there are `most` or all are small beside the scene. */
gw_code gw_emissive_lights_make(const gw_scene *scene, uint32_t most, float faintest, gw_emissive_lights *out,
                                gw_error *error);
void gw_emissive_lights_finish(gw_emissive_lights *lights);

#endif
