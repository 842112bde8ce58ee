/* The frame gate, a tile's end: takes releases, answers them, lets itself be heard every 200 ms while it
 * draws or waits, learns rank 0's clock from the replies, and notices when rank 0 is lost. The thread that
 * draws the tile. */
#ifndef GW_WALL_GATE_CLIENT_H
#define GW_WALL_GATE_CLIENT_H

#include "base/status.h"
#include "wall/bell.h"
#include "wall/gate_message.h"
#include "wall/share.h"
#include "wall/site.h"
#include "wall/wire.h"

#include <stdint.h>

typedef struct gw_gate_client {
    gw_wire *wire;
    gw_bell bell;                   /* socket -1: rank 0 is on another machine, or the wire wakes by itself */
    int here;                       /* rank 0's machine, so rank 0's clock */
    int64_t heard, looked, allowed; /* ns: rank 0 was heard, was listened to, may be silent */
    uint32_t beat;                  /* number of the last beat; 0: none yet */
    int beat_out;                   /* it is not answered yet */
    int64_t beat_at;
    int64_t offset, offset_error; /* ns, to add to this clock for rank 0's; error negative: not known */
    gw_site site;                 /* the last one that came */
    uint32_t site_epoch;          /* its number; 0: none came */
    uint32_t site_coming;         /* number of the one that is on its way, if site_due */
    int site_due;
    int has_release; /* one came while this tile drew */
    gw_release release;
    uint32_t number;      /* of the frame in work */
    uint32_t presented;   /* what goes with the next answer */
    int64_t presented_at; /* ns of this clock */
    uint32_t rejoin_ms; /* goes with the next answer, too: how long a tile that was started again took to its
                           first frame; 0: nothing is to be told */
    int64_t nap;        /* us */
    /* How rank 0 was lost, if another witness saw it; NULL: it was not. */
    const char *(*lost)(void *context);
    void *lost_context;
    void (*idle)(void *context); /* NULL, or called while this tile waits, at least every 10 ms */
    void *idle_context;
} gw_gate_client;

/* Over MPI; collective with gw_gate_create. The client is all zero before, but for the witness. */
gw_code gw_gate_client_open(gw_gate_client *client, const gw_share *share, int rank, int64_t deadline,
                            gw_error *error);
/* Over a wire of its own, for a tile that was started again; the client owns it. here: it is rank 0's
 * machine, so its clock; site: number of the one that the tile has. */
void gw_gate_client_join(gw_gate_client *client, gw_wire *wire, int here, uint32_t site);
void gw_gate_client_close(gw_gate_client *client);

/* Waits for the next frame or the word to leave. GW_ENDED_EARLY when rank 0 is lost. */
gw_code gw_gate_client_wait(gw_gate_client *client, gw_release *out, gw_error *error);
/* From within the drawing: lets itself be heard if it is time. silence: s for which nothing may be heard,
 * because a kernel is compiled; 0: as usual. */
void gw_gate_client_pulse(gw_gate_client *client, double silence);
/* The frame with that number was presented (gw_now_ns clock). */
void gw_gate_client_presented(gw_gate_client *client, uint32_t number, int64_t when);
/* Answers the release; size bytes of pixels follow when pixels is not NULL. */
gw_code gw_gate_client_answer(gw_gate_client *client, const gw_done *done, const uint8_t *pixels, size_t size,
                              gw_error *error);
/* The last word, after a quit. */
void gw_gate_client_leave(gw_gate_client *client);

#endif
