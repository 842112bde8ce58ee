/* Triangles so far away that with them in the scene's box all else would shrink to nothing. Any thread. */
#ifndef GW_BUILD_SCENE_OUTLIERS_H
#define GW_BUILD_SCENE_OUTLIERS_H

#include "base/status.h"
#include "build/scene.h"

/* The extent of a scene is here half the side of the cube about its middle that holds seven eighths of its
 * triangles whole; the middle is the median of the triangles' middles on each axis. Triangles that reach
 * farther than scene->outlier_extents times the extent from the middle are dropped, counted and noted; 0
 * keeps all. Order statistics do not move however far a few vertices are, and do not depend on the order in
 * the file. `world` as in gw_scene_finish; indices are in range and positions finite. */
gw_code gw_scene_drop_outliers(gw_scene *scene, const double *world, gw_error *error);

#endif
