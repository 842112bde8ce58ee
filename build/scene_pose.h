/* A finished scene at a time: the same triangles, materials and welded vertices with the positions and
 * normals of a pose. One thread at a time. */
#ifndef GW_BUILD_SCENE_POSE_H
#define GW_BUILD_SCENE_POSE_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

typedef struct gw_posed gw_posed;

/* For a scene with animation, which must outlive *out. Stands at time 0. */
gw_code gw_posed_create(const gw_scene *scene, gw_posed **out, gw_error *error);
void gw_posed_destroy(gw_posed **posed);

/* Puts the scene into its pose at a time (ns; clips are looped). Allocates nothing. The same time gives the
 * same bits on every machine, and time 0 those of the finished scene. Vertices that leave [-1,1]^3, between
 * the times at which the importer measured the animation, are held at its border and counted. */
void gw_posed_move(gw_posed *posed, int64_t time);

/* What stands at that time; valid until the next move. Its hash is that of the scene, at any time. */
const gw_scene *gw_posed_scene(const gw_posed *posed);
uint64_t gw_posed_held(const gw_posed *posed);

/* Scene metres as a rebased position in [-1,1]^3, without negative zeros; 1 when it had to be held there. */
int gw_scene_rebase_point(const gw_scene *scene, const double world[3], float out[3]);
/* Unit length, or zero (and 0 returned) where the normal is none. */
int gw_scene_clean_normal(const float normal[3], float out[3]);

#endif
