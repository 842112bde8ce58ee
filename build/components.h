/* Connected components of a scene's mesh: triangles that hang together by welded vertices. Any thread. */
#ifndef GW_BUILD_COMPONENTS_H
#define GW_BUILD_COMPONENTS_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* *out, to be freed: for every welded vertex [scene->welded_count] the least welded vertex of its component.
 */
gw_code gw_components(const gw_scene *scene, uint32_t **out, gw_error *error);

#endif
