/* What the parts of `gazewall replay` share. Main thread. */
#ifndef GW_WALL_REPLAY_H
#define GW_WALL_REPLAY_H

#include "tracking/recording.h"
#include "tracking/recording_statistics.h"

#include <jansson.h>

/* To standard output. */
void gw_replay_print(const gw_recording *recording, const gw_recording_statistics *statistics);
/* Fills the key `tracking` of a report (wall/report.h) with all that gw_replay_print says. */
void gw_replay_report(json_t *report, const gw_recording *recording,
                      const gw_recording_statistics *statistics);

#endif
