/* Removes what Open MPI leaves behind when mpirun was killed: its session folder and the segments of its
 * shared memory. mpirun removes both itself when it ends in any other way. The launcher, after all ranks are
 * gone. */
#ifndef GW_WALL_MPIRUN_SWEEP_H
#define GW_WALL_MPIRUN_SWEEP_H

#include <stdint.h>
#include <sys/types.h>

/* mpirun: its process id; job: Open MPI's number of the run, 0 when no rank came so far as to tell. */
void gw_mpirun_sweep(pid_t mpirun, uint32_t job);

#endif
