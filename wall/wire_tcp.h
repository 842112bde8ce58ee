/* A wire over TCP, for a tile that was started again and has no place in MPI any more. Every message and
 * every block goes behind a head that says which it is and how long, so that two ends that disagree break the
 * line instead of taking one for the other. Nothing here waits, and nothing depends on keep-alive: the gate's
 * beats tell who lives. The thread that made it. */
/* clang-format off */
/* A head, numbers little-endian:
 *   0    4    "GWM1": a message follows, "GWB1": a block
 *   4    4    its bytes; of a message at most GW_WIRE_MESSAGE, of a block those that the receiver expects
 */
/* clang-format on */
#ifndef GW_WALL_WIRE_TCP_H
#define GW_WALL_WIRE_TCP_H

#include "base/status.h"
#include "wall/wire.h"

/* Takes the connected socket over, also when it fails. */
gw_code gw_wire_tcp(int socket, gw_wire **out, gw_error *error);

#endif
