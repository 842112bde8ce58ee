/* From a head's motion to the photons that show it: what each stage adds, by frame (docs/tracking.md). Rank 0
 * only; values. */
#ifndef GW_WALL_LATENCY_H
#define GW_WALL_LATENCY_H

#include "tracking/tracker.h"

#include <jansson.h>
#include <stdint.h>

typedef enum gw_latency_stage {
    GW_LATENCY_AGE,      /* from when the newest sample was taken to its arrival */
    GW_LATENCY_FILTER,   /* group delay */
    GW_LATENCY_WAIT,     /* from its arrival to the frame's state */
    GW_LATENCY_TRACE,    /* from release to the slowest tile's pixels */
    GW_LATENCY_GATE,     /* until all tiles have answered, so that the next release can present them */
    GW_LATENCY_SCAN_OUT, /* half a refresh period */
    GW_LATENCY_STAGES
} gw_latency_stage;

extern const char *const gw_latency_names[GW_LATENCY_STAGES]; /* "age", ... */

/* Of the first viewer in one frame, ms. Not tracked: age, filter and wait are 0. */
typedef struct gw_latency {
    int tracked;
    float ms[GW_LATENCY_STAGES];
    float predicted; /* by which the head was predicted to make up for it */
} gw_latency;

/* The first three stages: of the head, or of the gaze of a viewer whose head is not tracked. */
gw_latency gw_latency_of(const gw_viewer_view *viewer);
/* The others: ms from release to the slowest tile's pixels and to the last answer; Hz. */
void gw_latency_complete(gw_latency *latency, double slowest, double whole, double refresh);
double gw_latency_total(const gw_latency *latency);

/* Median, p95 and max of each stage, their total and the prediction, over the tracked ones of `count` frames;
 * null when none is. */
json_t *gw_latency_json(const gw_latency *frames, size_t count);

#endif
