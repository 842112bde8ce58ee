/* Faults that tests make a tile have at a frame, so that they are the same in every run: the option
 * --tile-fault KIND:TILE@FRAME, which may be given several times. */
#ifndef GW_WALL_TILE_FAULT_H
#define GW_WALL_TILE_FAULT_H

#include "base/status.h"

#include <stdint.h>

typedef enum gw_tile_fault_kind {
    GW_FAULT_KILL,    /* the process is killed in the middle of the frame */
    GW_FAULT_STOP,    /* it is stopped, and stays so until somebody continues it */
    GW_FAULT_HANG,    /* its drawing never ends */
    GW_FAULT_SLOW,    /* from that frame on it takes 200 ms longer */
    GW_FAULT_CONTEXT, /* the GL context is lost */
    GW_FAULT_DIE      /* from that frame on the process is killed, and every one that takes its place */
} gw_tile_fault_kind;

typedef struct gw_tile_fault {
    gw_tile_fault_kind kind;
    uint32_t tile, frame;
} gw_tile_fault;

enum { GW_MAXIMUM_FAULTS = 8 };

/* KIND:TILE@FRAME: kill, die, stop, hang, slow or context; numbers of the tile and the frame. */
gw_code gw_tile_fault_parse(const char *text, gw_tile_fault *out, gw_error *error);
/* While the tile draws the frame. GW_MACHINE as from a driver whose context is lost. */
gw_code gw_tile_fault_strike(const gw_tile_fault *faults, uint32_t count, uint32_t tile, uint32_t frame,
                             gw_error *error);

#endif
