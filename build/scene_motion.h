/* The part of gw_scene_finish that knows of animation: where the scene reaches over time, which vertices are
 * the same at any time, and the animation in the order of the finished vertices. One thread. */
#ifndef GW_BUILD_SCENE_MOTION_H
#define GW_BUILD_SCENE_MOTION_H

#include "build/animation.h"
#include "build/scene.h"

typedef struct gw_scene_motion {
    double *world;        /* [file vertices][3] at time 0, scene metres */
    double bounds[2][3];  /* over all times looked at, with a margin for those between */
    uint32_t *content_of; /* [file vertices] number of what a vertex is at any time, in an order of content */
    uint32_t *motion_of;  /* [contents] number of how it moves: equal where only normals differ */
    uint32_t content_count;
} gw_scene_motion;

/* Takes the pose at time 0 as the scene's positions (motion->world) and normals (scene->normals), measures
 * and numbers. Only for a scene with animation. */
gw_code gw_scene_motion_init(gw_scene *scene, gw_scene_motion *motion, gw_error *error);
void gw_scene_motion_finish(gw_scene_motion *motion);

/* Bounds over time of the vertices that `used` marks (by anything but UINT32_MAX). */
gw_code gw_scene_motion_measure(const gw_scene *scene, const uint32_t *used, gw_scene_motion *motion,
                                gw_error *error);

/* The animation's vertices become file vertices source_of[0..count). */
gw_code gw_scene_motion_select(gw_scene *scene, const uint32_t *source_of, uint32_t count, gw_error *error);

#endif
