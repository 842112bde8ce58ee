/* The door of the gate, rank 0's end: a TCP port on one address at which tiles that were started again come
 * in (docs/gate.md). Nobody is waited for: few strangers at a time, each with a deadline, at most one that
 * loads for each tile; whoever does not tell the secret of the run is dropped, counted, and told once a
 * second. The thread that conducts the frames. */
#ifndef GW_WALL_GATE_DOOR_H
#define GW_WALL_GATE_DOOR_H

#include "base/log.h"
#include "base/status.h"
#include "wall/rejoin_message.h"
#include "wall/site.h"
#include "wall/wire.h"

#include <stdint.h>

typedef struct gw_door gw_door;

typedef struct gw_door_options {
    const char *address;          /* numeric, of an interface of this machine */
    uint16_t port;                /* 0: any that is free */
    const char *secret, *program; /* of the run, and hash of this program; borrowed until it is closed */
    gw_rejoin_keys keys;          /* what tiles are drawn with */
    int64_t patience;             /* ns that a tile may take to load it */
    const gw_log *log;
} gw_door_options;

/* What the gate says of a tile that wants in. */
typedef struct gw_door_keeper {
    void *context;
    /* NULL when such a start of the tile may take its place, else why not. */
    const char *(*refuse)(void *context, uint32_t tile, uint32_t start);
    int (*is_here)(void *context, uint32_t tile); /* on rank 0's machine */
    const char *(*name)(void *context, uint32_t tile);
    const gw_site *site; /* in force, and its number */
    uint32_t site_epoch;
    uint32_t number; /* of the next frame */
} gw_door_keeper;

/* A tile that could draw; who takes it owns the wire. */
typedef struct gw_newcomer {
    uint32_t tile, start;
    uint32_t site; /* number of the site that it has */
    int64_t process;
    gw_wire *wire;
} gw_newcomer;

/* GW_MACHINE when nothing can listen there. */
gw_code gw_door_open(const gw_door_options *options, gw_door **out, gw_error *error);
void gw_door_close(gw_door **door);
/* "10.0.0.1:40123" */
const char *gw_door_name(const gw_door *door);
/* Goes on with everybody at the door, at most every 5 ms. */
void gw_door_attend(gw_door *door, const gw_door_keeper *keeper);
/* 1 and a tile that is ready; 0: none (any more). */
int gw_door_take(gw_door *door, gw_newcomer *out);
/* Connections that were dropped so far. */
uint32_t gw_door_refused(const gw_door *door);

#endif
