/* What the two halves of `bench modes` share: measuring (bench_modes.c) and telling (bench_modes_report.c).
 */
#ifndef GW_WALL_BENCH_MODES_H
#define GW_WALL_BENCH_MODES_H

#include "render/flicker.h"
#include "wall/bench_view.h"
#include "wall/report.h"

enum { GW_MODES_FRAMES = 64 /* most stations on the path */ };

typedef enum gw_mode {
    GW_MODE_EXACT,
    GW_MODE_TRIANGLES,
    GW_MODE_VOXELS,
    GW_MODE_HYBRID,
    GW_MODE_ONE_KERNEL,
    GW_MODE_FULL_RATE,
    GW_MODE_FOVEATED,
    GW_MODE_COUNT
} gw_mode;

typedef struct gw_mode_outcome {
    const char *name, *what;
    gw_counters counters;       /* over all stations */
    double ms[GW_MODES_FRAMES]; /* of each station: the least of the rounds */
    double mean_ms, ratio;      /* over stations; to the exact mode's */
    double flip;                /* mean, as a foveal viewer would see it everywhere */
    double seen_flip;           /* mean, behind the acuity filter of the gaze */
    gw_flicker plain, seen;     /* as measured */
    gw_flicker_result flicker, seen_flicker;
} gw_mode_outcome;

typedef struct gw_bench_modes {
    gw_bench *bench;
    gw_bench_path path;
    uint32_t stations, rounds; /* pairs of frames along the path; times that each is drawn */
    double pixels_per_degree;  /* of the first station */
    int by_processor;          /* 1: times are the process's: software GL runs there, and so may others */
    gw_mode_outcome outcomes[GW_MODE_COUNT];
} gw_bench_modes;

/* Fills bench->report's "bench", writes modes.csv, modes.json and modes-time.svg, if there is a folder. */
gw_code gw_modes_write(gw_bench_modes *modes, gw_error *error);
void gw_modes_print(const gw_bench_modes *modes);

#endif
