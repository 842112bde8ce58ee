/* What rank 0 and a tile say to each other about frames: the same bytes over MPI and over TCP.
 *
 * Down goes a gw_release, under 512 bytes; up goes a gw_answer, of which only the part in use travels, and
 * after an answer whose pixels were wanted the pixels themselves. Both ends are the same program (a tile that
 * comes in by TCP proves that first), so structures travel as they stand. */
#ifndef GW_WALL_GATE_MESSAGE_H
#define GW_WALL_GATE_MESSAGE_H

#include "base/status.h"
#include "render/frame_state.h"
#include "render/predicted_error.h"
#include "render/renderer.h"
#include "wall/latency.h"
#include "wall/overlay.h"
#include "wall/wire.h"

#include <stddef.h>
#include <stdint.h>

typedef enum gw_release_kind {
    GW_RELEASE_FRAME = 1, /* present what you drew last, then draw this */
    GW_RELEASE_QUIT,      /* present what you drew last, then leave */
    GW_RELEASE_PONG,      /* an answer to a beat, or a word that rank 0 lives */
    GW_RELEASE_SITE       /* a gw_site follows as a block; the frames that name it hold for it */
} gw_release_kind;

typedef struct gw_release {
    uint32_t kind;
    uint32_t number;     /* of the frame in this run, from 0; states may be numbered otherwise */
    uint32_t last;       /* 1: the last frame of the run */
    uint32_t pixels;     /* 1: the answer's pixels are wanted */
    uint32_t predict;    /* 1: the predicted error is wanted */
    uint32_t silence_ms; /* rank 0 will be heard again within this time, or it is lost */
    uint32_t echo;       /* PONG: the beat that it answers; 0: none */
    uint32_t site;       /* the site that holds: 0 the one of the start, then 1, 2, ... */
    int64_t clock;       /* ns, of rank 0 when it sent this */
    gw_latency latency;  /* of the frame before, for the overlay */
    gw_frame_state state;
} gw_release;
_Static_assert(sizeof(gw_release) < 512, "release and frame state travel in one small message");

/* What a tile did for a frame. */
typedef struct gw_done {
    uint32_t frame;
    int32_t code;          /* gw_code; not 0: text says why, and no pixels follow */
    int64_t render_ns;     /* time in gw_renderer_frame */
    uint32_t site;         /* for which it was drawn */
    uint32_t making;       /* 1: kernels for frames like it are being made in the background */
    float lanes[GW_LANES]; /* ms, of the overlay: what surrounds the drawing is of the frame before */
    gw_counters counters;
    gw_predicted_error predicted; /* of its tile, if it was wanted */
    gw_luminance luminance;       /* likewise */
    char text[sizeof((gw_error *)0)->text];
} gw_done;

typedef enum gw_answer_kind {
    GW_ANSWER_DONE = 1, /* the frame is drawn; its pixels follow if they were wanted */
    GW_ANSWER_BEAT,     /* still at work, or waiting: I live */
    GW_ANSWER_LEFT      /* the last word */
} gw_answer_kind;

typedef struct gw_answer {
    uint32_t kind;
    uint32_t number;     /* of the release that is answered, or being worked on */
    uint32_t beat;       /* BEAT: its number, from 1 */
    uint32_t silence_ms; /* nothing may be heard for so long, because a kernel is compiled; 0: as usual */
    uint32_t presented;  /* number + 1 of the frame that was presented at this release; 0: none was */
    uint32_t pixels;     /* DONE: 1: pixels follow */
    uint32_t rejoin_ms; /* with `presented`, of a tile that was started again and shows its first frame: since
                           its process began; else 0 */
    uint32_t reserved;  /* 0 */
    int64_t presented_at; /* ns of rank 0's clock: when presenting it returned */
    int64_t clock_error;  /* ns, by which that may be wrong; 0: the same clock */
    int64_t processor;    /* ns that the process has used of its processors */
    gw_done done;
} gw_answer;

_Static_assert(sizeof(gw_answer) <= GW_WIRE_MESSAGE, "an answer is one message");

/* Bytes that must travel. */
size_t gw_answer_size(const gw_answer *answer);
/* 1 when `size` bytes of it that came from outside make sense; the text is then ended. */
int gw_answer_check(gw_answer *answer, size_t size);
int gw_release_check(const gw_release *release, size_t size);

#endif
