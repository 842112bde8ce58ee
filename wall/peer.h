/* Embree as a peer: closest hits of a scene's triangles by another program's hands. Loaded at run time
 * (libembree3.so.3); built in only where its header was there when this was compiled. One thread; tracing
 * uses all processors. */
#ifndef GW_WALL_PEER_H
#define GW_WALL_PEER_H

#include "base/status.h"
#include "build/scene.h"
#include "render/renderer.h"

#include <stddef.h>

typedef struct gw_peer gw_peer;

/* Builds its own structure over the rebased triangles, robust or in its default mode. GW_MACHINE when Embree
 * is not there. */
gw_code gw_peer_create(const gw_scene *scene, int robust, gw_peer **out, gw_error *error);
void gw_peer_destroy(gw_peer **peer);
const char *gw_peer_name(const gw_peer *peer); /* "Embree 3.13.5" */

/* How rays are handed over: one by one (rtcIntersect1), or in arrays of 256 declared coherent
 * (rtcIntersect1M), which Embree makes into packets as wide as the processor's vectors. */
typedef enum gw_peer_way { GW_PEER_SINGLE, GW_PEER_STREAM } gw_peer_way;

/* Nearest hit of each ray; triangle ids are the scene's. */
gw_code gw_peer_trace(gw_peer *peer, gw_peer_way way, const gw_ray *rays, size_t count, gw_hit *hits,
                      gw_error *error);

#endif
