/* The scene's surfaces as navigation asks for them, found by the renderer's own traversal of the octree.
 * Thread of the renderer's device. */
#ifndef GW_WALL_SURFACES_H
#define GW_WALL_SURFACES_H

#include "render/renderer.h"
#include "wall/navigate.h"

typedef struct gw_scene_surfaces {
    gw_renderer *renderer;
    const gw_scene *scene;
    gw_error error; /* of the first ray that could not be traced; then nothing is met any more */
} gw_scene_surfaces;

/* All borrowed; what is returned points to *store. */
gw_surfaces gw_scene_surfaces_of(gw_scene_surfaces *store, gw_renderer *renderer, const gw_scene *scene);

#endif
