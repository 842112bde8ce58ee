/* What the parts of `gazewall replay` share. Main thread. */
#ifndef GW_WALL_REPLAY_H
#define GW_WALL_REPLAY_H

#include "base/log.h"
#include "tracking/recording.h"
#include "tracking/recording_statistics.h"
#include "wall/replay_views.h"
#include "wall/site.h"

#include <jansson.h>

/* To standard output. suspected: what gw_replay_suspect() says of its unit, or "". */
void gw_replay_print(const gw_recording *recording, const gw_recording_statistics *statistics,
                     const char *suspected);
/* Fills the key `tracking` of a report (wall/report.h) with all that gw_replay_print says. */
void gw_replay_report(json_t *report, const gw_recording *recording,
                      const gw_recording_statistics *statistics, const char *suspected);

/* Position and speed of every sensor over time with its gaps, as it was recorded; and the gazes of the
 * viewers on the wall of the site; for free(). */
gw_code gw_replay_draw(const gw_recording *recording, const gw_recording_statistics *statistics,
                       gw_replay_views *views, const gw_site *site, char **svg, size_t *size,
                       gw_error *error);

typedef struct gw_replay_pace {
    const char *serve; /* as gw_server_open takes it */
    double speed;      /* 1: as it was recorded; 0: one step for each line of standard input */
    int loop;
} gw_replay_pace;

/* Until the recording is over, or standard input when it is stepped through, or a signal comes, whose number
 * is then told. A VRPN server waits for its first client. */
gw_code gw_replay_play(const gw_recording *recording, const gw_replay_pace *pace, const gw_log *log,
                       int quiet, int *interrupted, gw_error *error);

#endif
