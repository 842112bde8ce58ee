/* One end of the line between rank 0 and one tile: messages and blocks of pixels, never waiting. What carries
 * them is MPI (wall/wire_mpi.c); the gate does not know. The thread that made it. */
#ifndef GW_WALL_WIRE_H
#define GW_WALL_WIRE_H

#include <stddef.h>
#include <stdint.h>

enum { GW_WIRE_MESSAGE = 4096 }; /* bytes of the longest message */

typedef enum gw_wire_result {
    GW_WIRE_BROKEN = -1, /* the other end is gone, or talks nonsense */
    GW_WIRE_NOT_YET,     /* nothing has come, or what was sent before is still on its way */
    GW_WIRE_DONE
} gw_wire_result;

typedef struct gw_wire gw_wire;
struct gw_wire {
    /* Copies the message and sends it; at most one is on its way. */
    gw_wire_result (*send)(gw_wire *wire, const void *message, size_t size);
    /* A message of at most GW_WIRE_MESSAGE bytes. */
    gw_wire_result (*receive)(gw_wire *wire, void *message, size_t *size);
    /* A block whose size both ends know: called again with the same arguments until it is done. */
    gw_wire_result (*send_block)(gw_wire *wire, const void *block, size_t size);
    gw_wire_result (*receive_block)(gw_wire *wire, void *block, size_t size);
    /* 1 when nothing that was sent is still on its way out of this process. */
    int (*is_sent)(gw_wire *wire);
    void (*close)(gw_wire *wire); /* frees it */
    int descriptor;               /* readable when something comes, or -1 */
};

#endif
