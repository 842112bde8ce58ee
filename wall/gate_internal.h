/* What the files of the gate share: wall/gate.c releases and collects frames, gate_rejoin.c takes tiles that
 * were started again. */
#ifndef GW_WALL_GATE_INTERNAL_H
#define GW_WALL_GATE_INTERNAL_H

#include "wall/gate.h"
#include "wall/process_state.h"
#include "wall/wire.h"

typedef struct gw_gate_member {
    gw_gate_tile tile;
    gw_wire *wire; /* NULL: broken */
    gw_process process;
    uint32_t start;      /* which start of it by the launcher this is; 0: mpirun's */
    int rank, here;      /* here: on rank 0's machine, so its process can be seen */
    int bell;            /* it has one */
    int due;             /* the frame in work is to be sent to it */
    int outstanding;     /* it was released and has not answered */
    int pixels_due;      /* it has answered, its pixels are coming */
    int told, left;      /* to leave; it has left */
    uint32_t released;   /* number of the frame into which it was released last */
    int64_t released_at; /* ns */
    int64_t heard;       /* ns, when something last came from it */
    int64_t silence;     /* ns, that it has announced */
    int64_t looked;      /* ns, when its process was looked at */
    int64_t allowed;     /* ns from then on: an answer within them is in time */
    uint32_t kept_up;    /* frames in a row, since it was late */
    uint32_t probation;  /* frames in a row that make it live again */
    int pong_due;
    uint32_t echo;
    uint32_t site;        /* number of the site that it has */
    uint32_t site_coming; /* and of the one that is on its way to it, if there is one */
    int site_under_way;
    gw_site *site_sent; /* what is on its way: a copy, because a newer one may come meanwhile */
    gw_answer incoming;
    size_t pixel_bytes;
} gw_gate_member;

struct gw_gate {
    uint32_t count; /* tiles of the layout; member 0 is not used */
    gw_gate_member *members;
    const gw_layout *layout;
    const gw_log *log;
    int (*died)(void *context, gw_death *out);
    void *died_context;
    int live;
    int64_t silence, looked, nap;
    int64_t frame; /* ns, of the patience with the last frame */
    uint32_t next; /* number of the next frame */
    gw_site *site; /* the one that holds, once it is not the one of the start any more */
    uint32_t site_epoch;
    gw_release current; /* of the frame in work */
    gw_bell bell;
    gw_swap_skew swaps;
    gw_door *door; /* NULL: no tile comes back that was started again */
    gw_door_keeper keeper;
};

/* What was wrong with the tile last, in words; and a line of the log: "tile c0r0 (rank 3) WHAT frame 12:
 * ...". */
void gw_gate_name_fault(gw_gate_member *m, const char *format, ...) __attribute__((format(printf, 2, 3)));
void gw_gate_tell(const gw_gate *gate, const gw_gate_member *m, const char *what);

/* Goes on with those at the door, and takes in who is ready. */
void gw_gate_attend_door(gw_gate *gate);

#endif
