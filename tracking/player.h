/* Plays a recording into a tracker: at any time of the recording the tracker has taken what had arrived by
 * then, no more, each event once and in order. Going back begins anew. So what the tracker says at a time is
 * the same however one came there.
 *
 * The first event of every sensor is given before all others, so that a recording begins where it begins and
 * not at the neutral eye. One thread at a time. */
#ifndef GW_TRACKING_PLAYER_H
#define GW_TRACKING_PLAYER_H

#include "base/status.h"
#include "tracking/recording.h"
#include "tracking/tracker.h"

#include <stdint.h>

typedef struct gw_player gw_player;

/* How a recording is played: by the site's setup if names of its devices are those of the site's trackers,
 * else by the plain convention of docs/tracks.md, as whose only source the first device that reports any
 * viewer then stands in *out. site may be NULL. sources are for gw_player_open(). GW_BAD_INPUT when there is
 * no viewer. */
gw_code gw_player_setup(const gw_recording *recording, const gw_tracker_setup *site, gw_tracker_setup *out,
                        int8_t sources[GW_RECORDING_SENDERS], int *is_site, gw_error *error);
/* sources[i] is the source of the tracker's setup that the recording's sender i plays, or -1: nobody. The
 * recording must live as long as the player. delay: ns by which everything arrives later than recorded. */
gw_code gw_player_open(const gw_recording *recording, const int8_t *sources, int64_t delay, gw_player **out,
                       gw_error *error);
/* For a recording in millimetres and wall axes, as the demo track is: it is source 0. */
void gw_player_track_setup(gw_tracker_setup *out);
void gw_player_close(gw_player **player);

/* Gives the tracker what has arrived by `time` (ns since the recording's beginning). The tracker must be used
 * with this player only. */
void gw_player_feed(gw_player *player, gw_tracker *tracker, int64_t time);

#endif
