/* Where the heads and gazes of a run come from: a recording that is played into the tracker, or sources that
 * are read while frames are drawn (tracking/reader.h). --track says which; without it the site's trackers,
 * else the embedded demo track. Rank 0, the conductor's thread. */
#ifndef GW_WALL_TRACKED_H
#define GW_WALL_TRACKED_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/tracker.h"
#include "wall/fixations.h"
#include "wall/site.h"

#include <jansson.h>
#include <stdint.h>

typedef struct gw_tracked gw_tracked;

typedef struct gw_tracked_options {
    const char *track; /* file or source; NULL: the site's, or the demo track */
    const gw_site *site;
    const gw_settings *settings;
    const gw_log *log;
} gw_tracked_options;

/* GW_BAD_INPUT names a file or source that is wrong. Puts what is in a recording into the report's key
 * `tracking`. */
gw_code gw_tracked_open(const gw_tracked_options *options, json_t *report, gw_tracked **out, gw_error *error);
void gw_tracked_close(gw_tracked **tracked);

/* ns, of a recording; 0 of live sources, which have no end. */
int64_t gw_tracked_duration(const gw_tracked *tracked);
int gw_tracked_is_live(const gw_tracked *tracked);

/* Everybody for a frame: of a recording at `time` (ns since its beginning), which then is also when it is
 * seen; of live sources now, for a frame that is seen `lead` ns later. Who is not tracked is where the layout
 * has its eye. The pointer holds until the next call. */
const gw_tracker_view *gw_tracked_look(gw_tracked *tracked, int64_t time, int64_t lead,
                                       const gw_layout *layout);
/* Where on that wall they look, as of the last look. */
const gw_fixations *gw_tracked_fixations(const gw_tracked *tracked);

/* What the device that navigates asks for, as of the last look. */
void gw_tracked_wand(const gw_tracked *tracked, gw_wand *out);
/* Where trackers stand, as a changed site says, if it is the site's that are followed. NULL does nothing. */
void gw_tracked_take_site(gw_tracked *tracked, const gw_site *site);

/* Adds states and counters of the run to the report's key `tracking`. */
void gw_tracked_report(gw_tracked *tracked, json_t *report);

#endif
