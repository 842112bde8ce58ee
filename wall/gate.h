/* The frame gate, rank 0's end: what keeps the tiles on the same frame. (A tile's end: wall/gate_client.h.)
 *
 * Rank 0 sends each tile one message per frame that is both release and frame state, never waiting and never
 * with two on their way, and keeps one posted receive per tile. No collective: a dead, hung or slow tile
 * costs the others one deadline, once. A frame either waits until every live tile has it (lock-step), or goes
 * on at its deadline without those that are late (live); a tile that was late is not waited for again until
 * it has kept up for a while, and skips to the newest frame whenever it comes back. A tile from which nothing
 * comes, not even a beat, is lost; started again, it comes back by TCP (wall/gate_door.h). Rank 0's own tile
 * is not part of the gate. The thread that called MPI_Init. */
#ifndef GW_WALL_GATE_H
#define GW_WALL_GATE_H

#include "base/log.h"
#include "base/status.h"
#include "wall/bell.h"
#include "wall/gate_door.h"
#include "wall/gate_message.h"
#include "wall/layout.h"
#include "wall/link.h"
#include "wall/share.h"
#include "wall/site.h"
#include "wall/swap_skew.h"

#include <stdint.h>

typedef enum gw_tile_state { GW_TILE_LIVE, GW_TILE_LATE, GW_TILE_LOST } gw_tile_state;

/* Why a frame went on without a tile. */
typedef enum gw_tile_missed {
    GW_MISSED_NOT,
    GW_MISSED_LATE,
    GW_MISSED_SKIPPED,
    GW_MISSED_LOST
} gw_tile_missed;

/* Rank 0's view of one other tile. */
typedef struct gw_gate_tile {
    gw_tile_state state; /* LATE: it missed a frame and has not kept up since */
    uint32_t lost_frame; /* number of the frame at which it was last declared lost */
    uint32_t late;       /* frames into which it was released and that went on without it */
    uint32_t skipped;    /* frames into which it was not released, because it had not come back yet */
    uint32_t presented;  /* frames that it showed */
    uint32_t lost;       /* times that it was declared lost */
    uint32_t returned;   /* times that it came back after that */
    uint32_t
        rejoin_ms;   /* from the start of its process to its first presented frame, if it was started again */
    char fault[256]; /* what was wrong with it last; "": nothing ever */
    int compiling;   /* it said that it compiles a kernel, and has not answered since */
    int complete;    /* this frame's answer and pixels are here */
    gw_tile_missed missed; /* after collecting: why they are not */
    gw_done done;          /* this frame's answer */
    int64_t processor;     /* ns that its process has used of its processors */
    uint8_t *pixels;       /* [height][width][4]; of the last frame whose pixels were wanted */
} gw_gate_tile;

/* How long what is waited for. */
typedef struct gw_patience {
    int live;      /* 0: lock-step */
    int64_t frame; /* ns from the beginning of collecting, after which a live frame goes on */
    int64_t death; /* ns of silence after which a tile is lost */
} gw_patience;

typedef struct gw_gate gw_gate;

typedef struct gw_gate_options {
    const gw_layout *layout;
    const gw_share *share;
    int live;         /* a lost tile may come back */
    int64_t silence;  /* ns: rank 0 will be heard at least so often by a tile that is released or waits */
    int64_t deadline; /* gw_now_ns clock, of the meeting */
    uint32_t frames;  /* of the run */
    /* 1 and the end of a tile's process that another witness saw, each once; or NULL. */
    int (*died)(void *context, gw_death *out);
    void *died_context;
    const gw_log *log;
} gw_gate_options;

/* Rank 0: tiles 1..tile_count-1 of the layout. Collective with gw_gate_client_open on the other ranks, before
 * frame 1. */
gw_code gw_gate_create(const gw_gate_options *options, gw_gate **out, gw_error *error);
void gw_gate_destroy(gw_gate **gate);

/* From the next frame on this site holds, number `epoch`: every tile gets it before it is released into a
 * frame. Tiles and their pixels are as before. */
gw_code gw_gate_take_site(gw_gate *gate, const gw_site *site, uint32_t epoch, gw_error *error);
/* Releases every tile that waits into the frame; numbers it, and fills in kind, clock, silence and site.
 */
void gw_gate_release(gw_gate *gate, gw_release *release);
/* Takes what has come and answers beats: from within rank 0's own drawing, so that nobody takes it for dead.
 * silence: ns for which rank 0 may not be heard, because a kernel is compiled; 0: as usual. */
void gw_gate_attend(gw_gate *gate, int64_t silence);
/* Waits until the frame is complete or goes on without some tiles. */
void gw_gate_collect(gw_gate *gate, const gw_patience *patience);
/* Another witness saw the tile's process end: it is lost at once. */
void gw_gate_tile_died(gw_gate *gate, uint32_t tile, const char *how);
/* Tells every tile, lost ones too, to leave. */
void gw_gate_quit(gw_gate *gate);
/* Waits for those that are not lost to have taken it, at most 2 s. */
void gw_gate_wait_until_left(gw_gate *gate);
/* A bit for each tile that compiles kernels: before it can answer, or in the background. */
uint64_t gw_gate_compiling(const gw_gate *gate);
const gw_gate_tile *gw_gate_tile_of(const gw_gate *gate, uint32_t tile);
/* Tiles that were started again come in from now on, at a port of the address; site: the one in force,
 * borrowed until gw_gate_take_site. Only in live mode; before the first frame. */
gw_code gw_gate_open_door(gw_gate *gate, const gw_door_options *options, const gw_site *site,
                          gw_error *error);
/* NULL when there is none. */
const gw_door *gw_gate_door(const gw_gate *gate);
/* When the tiles presented the frames; rank 0 adds its own. */
gw_swap_skew *gw_gate_swaps(gw_gate *gate);

#endif
