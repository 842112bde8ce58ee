/* A scene that moves: for a time, its pose and the octree of that pose. Every rank does this by itself, from
 * the frame's time alone; the bytes are the same everywhere. Belongs to the thread of its GL device. */
#ifndef GW_RENDER_MOVING_H
#define GW_RENDER_MOVING_H

#include "base/gl.h"
#include "base/log.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"

#include <jansson.h>
#include <stdint.h>

typedef struct gw_moving gw_moving;

/* For a scene with animation, which must outlive *out. settings: those of the octree's build. Starts the
 * device's pool of buffers: what is made for one pose serves the next. */
gw_code gw_moving_create(gw_gl *device, const gw_scene *scene, const gw_settings *settings, const gw_log *log,
                         gw_moving **out, gw_error *error);
void gw_moving_destroy(gw_moving **moving);

/* The scene at a time (ns) and its octree; both belong to `moving`, until the next call. */
gw_code gw_moving_to(gw_moving *moving, int64_t time, const gw_scene **scene, const gw_octree **octree,
                     gw_error *error);

/* {rebuilds, ms{mean,max}, phases_ms{pose,refinement,leaf_payload,inner_payload,assembly},
 * buffers{made,reused,idle_bytes}, held_vertices}, means over all rebuilds; NULL when memory is out. */
json_t *gw_moving_report(const gw_moving *moving);

#endif
