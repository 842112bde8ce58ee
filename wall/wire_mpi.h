/* A wire over MPI, and what the ranks tell each other about themselves before frame 1. The thread that called
 * MPI_Init. */
#ifndef GW_WALL_WIRE_MPI_H
#define GW_WALL_WIRE_MPI_H

#include "base/status.h"
#include "wall/share.h"
#include "wall/wire.h"

#include <stdint.h>
#include <sys/types.h>

/* To the tile of a rank, or with rank 0 to rank 0. Closing it does not free what MPI may still own. */
gw_code gw_wire_mpi(int rank, gw_wire **out, gw_error *error);

typedef struct gw_acquaintance {
    int64_t process; /* number of the rank's process, as it sees it */
    int32_t machine; /* world rank of its machine's first rank */
    int32_t reserved;
} gw_acquaintance;

/* Collective, before frame 1: rank 0 learns of everybody (`everybody` has a place for each rank; NULL
 * elsewhere), all learn the nonce by which the ranks of this run find each other's bells (wall/bell.h). */
gw_code gw_ranks_meet(const gw_share *share, gw_acquaintance *everybody, uint64_t *nonce, int64_t deadline,
                      gw_error *error);

#endif
