/* Waiting for MPI without burning the processor: ranks share the machine with the software GL of the others,
 * and MPI's own blocking calls spin. Also puts MPI's errors into words. The thread that called MPI_Init. */
#ifndef GW_WALL_MPI_WAIT_H
#define GW_WALL_MPI_WAIT_H

#include "base/status.h"

#include <mpi.h>
#include <stdint.h>

/* GW_OK, or GW_MACHINE with MPI's own words about `result`. what names the step. */
gw_code gw_mpi_check(int result, const char *what, gw_error *error);

/* Tests the request until it is complete, sleeping between (at most 1 ms). Past deadline (gw_now_ns clock; 0:
 * none) fails with GW_ENDED_EARLY "what: nothing came in time ..." and leaves the request pending. */
gw_code gw_mpi_wait(MPI_Request *request, int64_t deadline, const char *what, gw_error *error);

/* Sleeps a little longer each time: start with *nap = 0 and set it back to 0 after progress. */
void gw_mpi_nap(int64_t *nap);

#endif
