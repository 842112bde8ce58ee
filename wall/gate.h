/* The frame gate: what keeps the tiles on the same frame.
 *
 * Rank 0 sends each live tile one message per frame that is both release and frame state, and keeps one
 * posted receive per live tile for its answer; a tile that has not answered by the deadline is lost, and the
 * others go on. Only point-to-point messages, at most one outstanding per tile, no collective: a dead, hung
 * or slow tile costs the others one deadline, once. Rank 0's own tile is not part of the gate. The thread
 * that called MPI_Init. */
#ifndef GW_WALL_GATE_H
#define GW_WALL_GATE_H

#include "base/status.h"
#include "render/frame_state.h"
#include "render/predicted_error.h"
#include "render/renderer.h"
#include "wall/layout.h"

#include <stdint.h>

typedef enum gw_release_kind { GW_RELEASE_FRAME, GW_RELEASE_QUIT } gw_release_kind;

typedef struct gw_release {
    uint32_t kind;
    uint32_t last;    /* 1: the last frame of the run */
    uint32_t pixels;  /* 1: the answer's pixels are wanted */
    uint32_t predict; /* 1: the predicted error is wanted */
    gw_frame_state state;
} gw_release;

/* A tile's answer to a release; its pixels follow if the release wants them. */
typedef struct gw_done {
    uint32_t frame;
    int32_t code;      /* gw_code; not 0: text says why, and no pixels follow */
    int64_t render_ns; /* time in gw_renderer_frame */
    gw_counters counters;
    gw_predicted_error predicted; /* of its tile, if it was wanted */
    char text[sizeof((gw_error *)0)->text];
} gw_done;

typedef enum gw_tile_state { GW_TILE_LIVE, GW_TILE_LOST } gw_tile_state;

/* Rank 0's view of one other tile. */
typedef struct gw_gate_tile {
    gw_tile_state state;
    uint32_t lost_frame; /* frame at which it was declared lost */
    int complete;        /* this frame's answer and pixels are here */
    gw_done done;        /* this frame's answer */
    uint8_t *pixels;     /* [height][width][4]; of the last frame whose pixels were wanted */
} gw_gate_tile;

typedef struct gw_gate gw_gate;

/* Rank 0: tiles 1..tile_count-1 of the layout. */
gw_code gw_gate_create(const gw_layout *layout, gw_gate **out, gw_error *error);
void gw_gate_destroy(gw_gate **gate); /* only when no tile is lost: MPI may still own a lost tile's memory */

/* Releases every live tile into the frame. */
gw_code gw_gate_release(gw_gate *gate, const gw_release *release, gw_error *error);
/* Waits until every live tile has answered; one from which nothing has come for `patience` ns is lost.
 * Returns the number of tiles lost in this frame through *lost. */
gw_code gw_gate_collect(gw_gate *gate, int64_t patience, uint32_t *lost, gw_error *error);
/* Tells every tile, lost ones too, to leave; waits for the live ones to have taken it, at most 2 s. */
void gw_gate_quit(gw_gate *gate);
const gw_gate_tile *gw_gate_tile_of(const gw_gate *gate, uint32_t tile);

/* Another rank: waits for the next release; GW_ENDED_EARLY when none comes for `patience` ns. */
gw_code gw_gate_wait(gw_release *out, int64_t patience, gw_error *error);
/* Answers it; size bytes of pixels follow when pixels is not NULL. */
gw_code gw_gate_answer(const gw_done *done, const uint8_t *pixels, size_t size, gw_error *error);
/* Answers a quit. */
void gw_gate_leave(void);

#endif
