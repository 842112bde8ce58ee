/* Rank 0's part besides its tile: makes the frame states, opens the gate, collects the tiles, writes
 * pictures, frames.csv and the report, and sums up. The thread that called MPI_Init. */
#ifndef GW_WALL_CONDUCTOR_H
#define GW_WALL_CONDUCTOR_H

#include "base/hash.h"
#include "base/status.h"
#include "wall/budget.h"
#include "wall/exposure.h"
#include "wall/frames.h"
#include "wall/gate.h"
#include "wall/latency.h"
#include "wall/overlay.h"
#include "wall/pilot.h"
#include "wall/serve.h"
#include "wall/site_watch.h"
#include "wall/tracked.h"
#include "wall/video.h"

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>

struct gw_rank;

#define GW_ENDLESS UINT32_MAX

enum { GW_USUAL_FRAMES = 16 };

typedef struct gw_conductor {
    json_t *report;
    gw_tracked *tracked;    /* NULL with recorded states, or a gaze from the command line */
    gw_states recorded;     /* of --states */
    gw_fixations fixations; /* of the newest frame; all 0: nobody's is known */
    double stare[3];        /* mm, for --gaze */
    gw_camera_path path;    /* of --path; keys owned; no keys: the scene stands as it is placed */
    uint32_t frame_count;   /* GW_ENDLESS: until the run is ended */
    uint32_t kept;          /* so many states and times are kept: all, or the last of a run without an end */
    int64_t started;        /* ns; the time of frame 0 when frames follow the clock, or 0: they do not */
    int64_t first_time, step;            /* ns, of the track's clock */
    int scene_moves;                     /* it is animated, so every frame's time is a view of its own */
    gw_frame_state *states;              /* [kept], as sent; frame N at N modulo kept */
    double *milliseconds;                /* [kept], release to last pixel */
    gw_latency *latencies;               /* [kept] */
    double tile_ms[GW_USUAL_FRAMES];     /* median tile of the last frames, by number modulo */
    double ahead_ms[GW_USUAL_FRAMES];    /* from state to photons, of the last frames, by number modulo */
    uint32_t missed[GW_MISSED_LOST + 1]; /* tiles of this frame, by gw_tile_missed */
    uint32_t missing;                    /* tiles without which this frame went on */
    uint32_t presented;                  /* frames that rank 0's tile showed */
    uint32_t lost_count;                 /* tiles that were ever lost */
    double swap_median, swap_maximum;    /* ms, for the summary */
    uint32_t slowest_tile;               /* of the last frame */
    double slowest_ms;
    int making;           /* this tile makes kernels in the background, as of the last frame */
    gw_counters counters; /* of all tiles and frames */
    gw_budget budget;     /* of --budget, --budget-rays */
    gw_exposure exposure;
    gw_predicted_error predicted;   /* of all tiles, in all frames for which it was asked */
    gw_predicted_error seen;        /* of the last such frame */
    char *scene_line, *octree_line; /* for the summary */
    gw_gate *gate;
    gw_pilot *pilot;                  /* NULL when nobody steers */
    gw_serve *serve;                  /* of --serve, or NULL */
    FILE *rows;                       /* frames.csv, or NULL */
    gw_site_watch watch;              /* the site file */
    uint32_t reloads;                 /* how often another site was taken over: its number */
    gw_lanes *lanes;                  /* [tile_count], for the overlay, or NULL */
    uint8_t *shown[GW_MAXIMUM_TILES]; /* pixels with overlay and frame code, or NULL */
    gw_video *video;                  /* or NULL */
    gw_hash picture_hash;             /* of the last picture's own pixels */
} gw_conductor;

/* Reads track or states and opens what will be written, so that mistakes show before the long work. */
gw_code gw_conductor_init(gw_conductor *conductor, struct gw_rank *rank, int argc, char **argv,
                          gw_error *error);
/* Puts device, scene and octree into the report while rank 0 still has them. */
gw_code gw_conductor_describe(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error);
/* All frames, then quit, report and summary. GW_TILES_LOST when some tile was lost on the way. */
gw_code gw_conductor_run(gw_conductor *conductor, struct gw_rank *rank, gw_error *error);

#endif
