/* A tile that was started again while the wall runs (docs/gate.md): comes to rank 0's door by TCP, loads
 * scene and octree from its machine's cache, and draws what rank 0 releases from then on. No MPI. The main
 * thread of a process of the launcher's. */
#ifndef GW_WALL_REJOIN_H
#define GW_WALL_REJOIN_H

#include "base/status.h"
#include "wall/rank.h"

/* place: TILE:START:ADDRESS:PORT, as the launcher says. The number of the tile, -1 when the text is none.
 * Takes the secret of the run from standard input where the environment does not have it. */
int gw_rejoin_number(const char *place);
/* To the end of the run. The line to the launcher stands. */
gw_code gw_rank_rejoin(gw_rank *rank, gw_error *error);

#endif
