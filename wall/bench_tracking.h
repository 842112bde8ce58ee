/* What bench_tracking.c (heads, output), bench_tracking_gaze.c and bench_tracking_shipped.c share. */
#ifndef GW_WALL_BENCH_TRACKING_H
#define GW_WALL_BENCH_TRACKING_H

#include "base/status.h"
#include "tracking/generator_motion.h"
#include "tracking/tracker.h"

#include <stdint.h>

enum {
    GW_TRACKING_GRID = 1000,
    GW_TRACKING_ROWS = 96,
    GW_TRACKING_FIGURES = 7, /* at most: a table without that many has no name for the rest */
    GW_TRACKING_HEAD_FILTERS = 6,
    GW_TRACKING_GAZE_FILTERS = 5,
    GW_TRACKING_SACCADES = 256
};

/* One line of a table: a filter with its settings on what moves, and what came of it. */
typedef struct gw_tracking_row {
    const char *table;  /* "head", "gaze" */
    char track[32];     /* a shipped track; "": a person measured with this rate and noise */
    char filter[96];    /* as --set takes it */
    double rate, noise; /* Hz; mm or degrees along an axis */
    double figures[GW_TRACKING_FIGURES];
} gw_tracking_row;

static const double GW_TRACKING_LEAD = 0.05; /* s from a frame's state to its photons */

extern const char *const gw_tracking_head_filters[GW_TRACKING_HEAD_FILTERS],
    *const gw_tracking_gaze_filters[GW_TRACKING_GAZE_FILTERS];
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

/* Which of a person's saccades were found, each once, and how often there was none. */
typedef struct gw_tracking_findings {
    uint8_t found[GW_TRACKING_SACCADES];
    uint64_t told; /* by the tracker, so far */
    double wrong;
} gw_tracking_findings;

/* After each sample. A saccade is found where one goes on, or ended less than `late` seconds ago. */
void gw_tracking_note(const gw_person *person, double time, double late, uint64_t told,
                      gw_tracking_findings *findings);
double gw_tracking_missed(const gw_person *person, double seconds, const gw_tracking_findings *findings);
/* Seconds since the saccade that ended last; far back when one goes on. */
double gw_tracking_since_saccade(const gw_person *person, double time);

/* Add their rows: of gazes, and of the shipped tracks beside the people that they were made from. */
gw_code gw_bench_tracking_gaze(double seconds, gw_tracking_row *rows, uint32_t *count, gw_error *error);
gw_code gw_bench_tracking_shipped(gw_tracking_row *rows, uint32_t *count, gw_error *error);

/* A tracker of one source in wall axes and metres, or of a setup, with settings "name=value ..." over the
 * defaults. setup may be NULL. */
gw_code gw_bench_tracker(const char *settings, const gw_tracker_setup *setup, gw_tracker **out,
                         gw_error *error);

#endif
