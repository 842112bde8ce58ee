/* The sides of a mesh's triangles, brought together at the edges that they share. Any thread. */
#ifndef GW_BUILD_MESH_SIDES_H
#define GW_BUILD_MESH_SIDES_H

#include "base/status.h"
#include "build/radix_sort.h"
#include "build/scene.h"

/* *out, to be freed: three sides a triangle, in the order of their edges. key: the edge's two welded
 * vertices, the lesser in the high half; value: twice the triangle, plus 1 when it runs from the lesser to
 * the greater. Of the scene only triangles and welded are read. */
gw_code gw_mesh_sides(const gw_scene *scene, gw_keyed **out, gw_error *error);

#endif
