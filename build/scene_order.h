/* The canonical order of a scene's triangles: by content, never by the place in the file. Any thread. */
#ifndef GW_BUILD_SCENE_ORDER_H
#define GW_BUILD_SCENE_ORDER_H

#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>
#include <stdint.h>

/* One vertex as the words that are compared: rebased position, normal, texture coordinates (float bits, no
 * -0), colour, in an animated scene the number of what it is at any time (scene_motion.h), second texture
 * coordinates, tangent. */
enum { GW_VERTEX_WORDS = 13, GW_POSITION_WORDS = 3 };

/* Rotates every triangle so that its least corner comes first (the winding stays), then sorts
 * scene->triangles and scene->material_of by the Morton code of the centroid, then content. `vertices` are
 * rows of GW_VERTEX_WORDS that the triangles index. marked [triangle_count] becomes 1 for triangles that no
 * ray can tell from the one before them. */
gw_code gw_scene_order(gw_scene *scene, const uint32_t *vertices, uint8_t *marked, gw_error *error);

#endif
