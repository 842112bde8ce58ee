/* What bench_tracking.c (heads, output) and bench_tracking_gaze.c share. */
#ifndef GW_WALL_BENCH_TRACKING_H
#define GW_WALL_BENCH_TRACKING_H

#include "base/status.h"
#include "tracking/generator_motion.h"
#include "tracking/tracker.h"

#include <stdint.h>

enum { GW_TRACKING_GRID = 1000, GW_TRACKING_ROWS = 64, GW_TRACKING_FIGURES = 6 };

/* One line of a table: a filter with its settings on what moves, and what came of it. */
typedef struct gw_tracking_row {
    const char *table;  /* "head", "gaze" */
    char filter[96];    /* as --set takes it */
    double rate, noise; /* Hz; mm or degrees along an axis */
    double figures[GW_TRACKING_FIGURES];
} gw_tracking_row;

extern const char *const gw_tracking_head_figures[GW_TRACKING_FIGURES],
    *const gw_tracking_gaze_figures[GW_TRACKING_FIGURES];

/* Something that moves in three coordinates, by its exact path: at GW_TRACKING_GRID places a second. */
typedef struct gw_tracking_path {
    double seconds;
    double (*at)[3]; /* owned */
} gw_tracking_path;

/* Between two of its places, and before its beginning and after its end. */
void gw_tracking_path_at(const gw_tracking_path *path, double time, double out[3]);
/* Seconds by which `seen` (at times[i], of count) follows the path: the shift of the least square difference,
 * from -0.1 to 0.3 s in steps of 0.2 ms. */
double gw_tracking_lag(const gw_tracking_path *path, const double *times, double (*seen)[3], size_t count);

/* Adds the gaze's rows; *cost in ns of processor per sample, of the costliest row. */
gw_code gw_bench_tracking_gaze(double seconds, gw_tracking_row *rows, uint32_t *count, gw_error *error);

/* A tracker of one source in wall axes and metres with settings "name=value ..." over the defaults. */
gw_code gw_bench_tracker(const char *settings, gw_tracker **out, gw_error *error);

#endif
