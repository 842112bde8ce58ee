/* Where on the wall viewers look, as points with an ellipse of confidence each (tracking/gaze_model.h): from
 * the gaze samples of the last 0.3 s, since the last saccade. Plain values; any thread. */
#ifndef GW_WALL_FIXATIONS_H
#define GW_WALL_FIXATIONS_H

#include "tracking/gaze_model.h"
#include "tracking/tracker.h"
#include "wall/layout.h"

typedef struct gw_viewer_fixation {
    int known;        /* 0: no gaze is known, a saccade goes on, or it is beside the wall: all else is 0 */
    int rests;        /* the samples are of one fixation (GW_FIXATION_DISK) */
    uint32_t samples; /* that met the wall; of a gaze that is taken from the head, 1 */
    double point[3];  /* mm, the middle of the samples */
    double half_angles[2]; /* deg, seen from the eye: of the ellipse in which the viewer looks 95 times of
                              100, by the samples' spread and the gaze's error together; the greater first */
} gw_viewer_fixation;

typedef struct gw_fixations {
    gw_viewer_fixation viewers[GW_TRACK_VIEWERS];
} gw_fixations;

/* view: the tracker's at `now`. */
void gw_fixations_find(const gw_tracker *tracker, const gw_tracker_view *view, int64_t now,
                       const gw_layout *layout, gw_fixations *out);

/* The tiles as rectangles; how many. */
uint32_t gw_layout_rectangles(const gw_layout *layout, gw_wall_rectangle out[GW_MAXIMUM_TILES]);

#endif
