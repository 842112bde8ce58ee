/* Triangles that no ray can tell from another. Any thread. */
#ifndef GW_BUILD_SCENE_DUPLICATES_H
#define GW_BUILD_SCENE_DUPLICATES_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* Drops and counts the triangles that are `marked` [triangle_count] as equal to another, but for those of a
 * closed component that would not be closed without them: where a surface folds back on itself a face may be
 * there twice and once more turned over, and crossings of a ray count. rows: what the triangles index,
 * GW_VERTEX_WORDS each. */
gw_code gw_scene_drop_duplicates(gw_scene *scene, const uint32_t *rows, uint32_t row_count,
                                 const uint8_t *marked, gw_error *error);

#endif
