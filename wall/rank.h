/* One rank of the wall: a process that owns one tile, its GL device, its renderer and a view of the shared
 * octree. Rank 0 also imports, builds and conducts (wall/conductor.h). The thread that called MPI_Init. */
#ifndef GW_WALL_RANK_H
#define GW_WALL_RANK_H

#include "base/status.h"
#include "render/renderer.h"
#include "wall/build_together.h"
#include "wall/gate.h"
#include "wall/gate_client.h"
#include "wall/link.h"
#include "wall/model.h"
#include "wall/overlay.h"
#include "wall/present.h"
#include "wall/share.h"
#include "wall/sim_options.h"
#include "wall/site.h"

#include <stdint.h>

typedef struct gw_rank {
    gw_sim_options options;
    gw_site site;
    uint32_t site_epoch; /* number of it: 0 the one of the start */
    gw_link line;        /* to the launcher */
    gw_model model;      /* rank 0: scene and octree until they are shared */
    gw_share share;
    gw_together together; /* rank 0: who built the octree */
    gw_renderer *renderer;
    int number;                   /* rank, and index of its tile */
    int size;                     /* ranks */
    int64_t begin, load_deadline; /* gw_now_ns clock */
    uint8_t *pixels;              /* of its tile, [height][width][4] */
    uint8_t *shown;               /* the same with overlay and frame code; NULL: nothing is drawn over them */
    gw_lanes lanes;               /* of the overlay */
    float lane_ms[GW_LANES];      /* measured last */
    gw_missed missed;             /* that this tile knows of */
    gw_latency latency;           /* as the last release told it */
    uint32_t next;                /* number of the frame that it expects */
    uint8_t *eye_pixels;          /* of one eye, where the tile shows two; else NULL */
    gw_gate_client gate;          /* ranks above 0 */
    gw_gate *conducted;           /* rank 0 */
    int64_t attended;             /* ns, when rank 0 last listened while it drew */
    gw_present *present;          /* of its tile; NULL: headless */
    int64_t rejoined;  /* ns, when this process began, if it was started again and has shown nothing yet */
    int programs_kept; /* 1: those of the first frame */
    uint32_t drawn;    /* number + 1 of the frame in pixels that is not presented yet; 0: none */
} gw_rank;

/* Draws this rank's tile for a release and writes its picture if the run has a folder for pictures. A failure
 * is told in done->code and done->text. */
void gw_rank_draw(gw_rank *rank, const gw_release *release, gw_done *done);

/* Presents what was drawn last: 1, and its frame's number and when that was (gw_now_ns clock). 0 when it has
 * been presented already. */
int gw_rank_present(gw_rank *rank, uint32_t *number, int64_t *when);

/* From here on the tile is drawn for another site, in which its pixels are the same. */
gw_code gw_rank_take_site(gw_rank *rank, const gw_site *site, uint32_t epoch, gw_error *error);

/* --- what a rank of MPI and a tile that was started again have in common */

static inline int gw_rank_needs_scene(const gw_rank *rank) {
    return rank->options.pictures.pattern == GW_PATTERN_NONE && !rank->options.gate_only;
}

/* Opens the tile's window, where it has one, and says in it that the scene is being loaded. */
gw_code gw_rank_open_window(gw_rank *rank, gw_error *error);
/* The shared scene and octree on the open device, and what draws them. */
gw_code gw_rank_create_renderer(gw_rank *rank, gw_error *error);
/* Memory for its pixels, and where they are shown. */
gw_code gw_rank_make_room(gw_rank *rank, gw_error *error);
/* Ranks above 0: draws what rank 0 releases until it says quit. */
gw_code gw_rank_follow(gw_rank *rank, gw_error *error);

/* --- rank_picture.c */

/* Notes how long that took since `begin` (gw_now_ns clock). */
void gw_rank_time(gw_rank *rank, gw_lane lane, int64_t begin);
/* The overlay of any tile, as this rank knows it, over a picture of that tile. */
void gw_rank_overlay(const gw_rank *rank, uint32_t tile, const gw_frame_state *state, const gw_done *done,
                     const gw_lanes *lanes, const gw_missed *missed, gw_image *image);
/* Draws overlay and frame code over a copy of what was drawn, as the options want; fills in done->lanes. */
gw_code gw_rank_decorate(gw_rank *rank, const gw_frame_state *state, gw_done *done, gw_error *error);
/* What is shown and written: the pixels, or their copy. */
const uint8_t *gw_rank_shown(const gw_rank *rank);
#endif
