/* Live sources of a run, read on a thread of their own, and what has come and is not due yet because
 * added_latency holds it back. The conductor's thread. */
#ifndef GW_WALL_TRACKED_LIVE_H
#define GW_WALL_TRACKED_LIVE_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/setup.h"
#include "tracking/tracker.h"

#include <jansson.h>
#include <stdint.h>

typedef struct gw_tracked_live gw_tracked_live;

/* Opens the setup's sources. delay: ns by which everything arrives later than it does. */
gw_code gw_tracked_live_open(const gw_tracker_setup *setup, int64_t delay, const gw_log *log,
                             gw_tracked_live **out, gw_error *error);
void gw_tracked_live_close(gw_tracked_live **live);

/* Gives the tracker what has arrived; returns by when (ns, gw_now_ns clock). */
int64_t gw_tracked_live_feed(gw_tracked_live *live, gw_tracker *tracker);

/* Each source with its counters. */
json_t *gw_tracked_live_json(gw_tracked_live *live);

#endif
