/* Pictures of an octree's cells, coloured by level, on the CPU. Any thread. */
#ifndef GW_BUILD_OCTREE_PICTURE_H
#define GW_BUILD_OCTREE_PICTURE_H

#include "base/image.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"

/* Along axis 0, 1 or 2 (x, y, z; the picture's right and up are z and y, x and z, x and y): left a cut
 * through the middle leaf - empty cells as outlines, leaves filled -, then the leaves as seen from the axis'
 * positive end, darker with distance, then a legend of levels. `side` is the pixels of the scene's longer
 * side, 64 to 4096. */
gw_code gw_octree_picture(const gw_scene *scene, const gw_octree *octree, int axis, uint32_t side,
                          gw_image *out, gw_error *error);

#endif
