/* The command lines of `gazewall sim` and `gazewall wall`, which their ranks read a second time: launcher and
 * ranks see the same options. */
#ifndef GW_WALL_SIM_OPTIONS_H
#define GW_WALL_SIM_OPTIONS_H

#include "base/status.h"
#include "wall/build_together.h"
#include "wall/options.h"
#include "wall/picture_options.h"
#include "wall/side_car.h"
#include "wall/site.h"
#include "wall/tile_fault.h"

#include <stdint.h>

/* Which wall: shared with `render`, which knows only size and wall_width. */
typedef struct gw_wall_options {
    uint32_t tiles[2], size[2];                                   /* columns x rows; px of the whole wall */
    uint32_t widths[GW_MAXIMUM_TILES], heights[GW_MAXIMUM_TILES]; /* px, of an uneven split */
    size_t width_count, height_count;                             /* 0: an even one */
    double wall_width, bezel;                                     /* mm */
    const char *site;
    const gw_site *given; /* instead of all of this, or NULL; borrowed */
    int tiles_given, size_given, wall_width_given;
    gw_stereo stereo; /* of every panel, if stereo_given */
    int stereo_given;
    double eye_distance; /* mm; negative: the site's */
} gw_wall_options;

/* 2x2 tiles are sim's default, render has one; 960x540 px, 2000 mm wide. */
void gw_wall_options_init(gw_wall_options *options, uint32_t columns, uint32_t rows);
/* The wall that the options describe: a site file or a split. */
gw_code gw_wall_site(const gw_wall_options *options, gw_site *out, gw_error *error);
/* The same, with what is odd about a site file. */
gw_code gw_wall_site_noting(const gw_wall_options *options, gw_site *out, gw_site_notes *notes,
                            gw_error *error);
/* Its layout alone. */
gw_code gw_wall_layout(const gw_wall_options *options, gw_layout *out, gw_error *error);

typedef enum gw_gaze_choice { GW_GAZE_FROM_TRACK, GW_GAZE_AT_PIXEL, GW_GAZE_NONE } gw_gaze_choice;
/* Takes what --gaze or --no-gaze wants, unless the other one was given. */
gw_code gw_choose_gaze(gw_gaze_choice *choice, gw_gaze_choice wanted, gw_error *error);

/* What can be seen of a run while it goes on. */
typedef enum gw_windows {
    GW_WINDOWS_NONE,
    GW_WINDOWS_WALL,  /* the whole wall in one window of rank 0: live, steered by mouse and keys */
    GW_WINDOWS_TILES, /* every tile in its own */
    GW_WINDOWS_SITE   /* those tiles for which the site file names a display */
} gw_windows;

typedef struct gw_sim_options {
    gw_draw_options draw; /* first: its parser is a child of this one's */
    gw_wall_options wall;
    gw_picture_options pictures;
    gw_side_car remade;      /* of --remake */
    const char *track;       /* NULL: the embedded demo track */
    const char *serve;       /* as whom to send eyes and gazes to other programs, or NULL */
    const char *path;        /* camera path of the scene, or NULL */
    const char *states;      /* recorded frame states to repeat, or NULL */
    const char *save_states; /* or NULL */
    const char *out;         /* folder for pictures and frames.csv, or NULL */
    const char *input;       /* file of keys and pointer moves that steer the run, or NULL */
    gw_windows windows;
    int headless;    /* asked for: no window whatever the site says */
    uint32_t frames; /* 0: as many as states has, without end where somebody steers, else 1 */
    double step;     /* s between frames; negative: spread over the track */
    gw_gaze_choice gaze;
    double gaze_pixel[2];
    double budget_ms, budget_rays; /* of a frame; 0: none */
    double still[2];               /* mm and degrees that count as standing still when samples add up */
    int live;                      /* frames go on without late tiles; else lock-step */
    double load_deadline, frame_deadline; /* s; 0: the site's */
    double death_deadline;                /* s; 0: the site's when live, else from the frames so far */
    int64_t restarts; /* how often a minute a lost tile of a live wall is started again; negative: as the site
                         says */
    int gate_only;    /* nothing is loaded or drawn: what the gate alone costs */
    gw_tile_fault tile_faults[GW_MAXIMUM_FAULTS]; /* hidden, for tests */
    uint32_t tile_fault_count;
    uint32_t builders;      /* ranks that build the octree together; 0: one of every machine */
    gw_builder_fault fault; /* hidden, for tests: what rank fault_rank pretends */
    int fault_rank;
    int machines; /* hidden, for tests: pretend that the ranks stand on so many machines */
    int cluster;  /* the verb is wall: the site's hosts draw its tiles, and without frames it has no end */
    int dry_run;  /* print the command, start nothing */
    const char *agent;  /* wall: what starts programs on other hosts in place of ssh, or NULL */
    const char *link;   /* hidden: the launcher's address, for ranks */
    const char *rejoin; /* hidden: where a tile that is started again comes in (wall/rejoin.h), or NULL */
} gw_sim_options;

/* 1 when somebody steers the run while it goes on: by a window, or by --input. */
int gw_sim_is_steered(const gw_sim_options *options);

/* 1 when time passes as it does from frame to frame, and, without --frames, until somebody ends it. */
int gw_sim_runs_free(const gw_sim_options *options);

/* The times in force: the site's, but for those that the command line gives. */
gw_site_times gw_sim_times(const gw_sim_options *options, const gw_site *site);

/* How often a minute a tile that was lost is started again; 0: never. */
uint32_t gw_sim_restarts(const gw_sim_options *options, const gw_site *site);

/* argv[0] is "sim", "wall" or "rank". */
gw_code gw_sim_options_parse(int argc, char **argv, gw_sim_options *out, int *helped, gw_error *error);

/* The part of it that --remake has: reads the side-car and puts what it holds into the options (remake.c). */
gw_code gw_sim_options_remake(gw_sim_options *options, gw_error *error);

#endif
