/* `--serve` of sim and wall: every frame's eyes and gazes for other programs (tracking/server.h). A thread of
 * its own answers clients, so that they do not wait while a frame is drawn. Rank 0, made and used by the
 * thread of the conductor. */
#ifndef GW_WALL_SERVE_H
#define GW_WALL_SERVE_H

#include "render/frame_state.h"
#include "tracking/server.h"

typedef struct gw_serve gw_serve;

gw_code gw_serve_open(const char *spec, gw_serve **out, gw_error *error);
/* Sends the eye as the pose of sensor 0; of gaze i its eye as sensor 2 i and its direction as sensor 2 i + 1,
 * whose -z axis looks along it. In metres of wall space, stamped with the moment of sending. */
void gw_serve_frame(gw_serve *serve, const gw_frame_state *state);
/* What was served so far. */
gw_server_counters gw_serve_count(gw_serve *serve);
const char *gw_serve_name(const gw_serve *serve);
void gw_serve_close(gw_serve **serve);

#endif
