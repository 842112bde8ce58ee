/* What a run would take from a recording: its viewers, as the tracker with its usual settings has them, in
 * the rooms of a site's trackers or by the plain convention. Main thread. */
#ifndef GW_WALL_REPLAY_VIEWS_H
#define GW_WALL_REPLAY_VIEWS_H

#include "tracking/player.h"

#include <stddef.h>

typedef struct gw_replay_views {
    gw_tracker_setup setup; /* no source: there is no viewer in the recording */
    gw_player *player;      /* owned, as is the tracker; NULL: no viewer */
    gw_tracker *tracker;
} gw_replay_views;

/* trackers: a site's; NULL: none. The recording must live as long. */
gw_code gw_replay_views_open(const gw_recording *recording, const gw_tracker_setup *trackers,
                             gw_replay_views *out, gw_error *error);
void gw_replay_views_close(gw_replay_views *views);

/* A viewer at a time (ns) of the recording. */
gw_viewer_view gw_replay_viewer(gw_replay_views *views, uint32_t viewer, int64_t time);
/* A sentence if heads are where no head can be, which another unit explains (gw_room_suspect); else 0. */
int gw_replay_suspect(gw_replay_views *views, const gw_recording *recording, char *text, size_t size);

#endif
