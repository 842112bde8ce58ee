/* What has become of a process of this machine, from /proc. Any thread. */
#ifndef GW_WALL_PROCESS_STATE_H
#define GW_WALL_PROCESS_STATE_H

#include <stdint.h>

typedef enum gw_process_state {
    GW_PROCESS_UNKNOWN, /* it cannot be seen from here */
    GW_PROCESS_RUNS,    /* or sleeps */
    GW_PROCESS_STOPPED, /* by a signal or a debugger */
    GW_PROCESS_GONE
} gw_process_state;

/* A process by its number and the time of its start, so that another one under the same number is not taken
 * for it. start 0: it could not be seen when it was looked for. */
typedef struct gw_process {
    int64_t number;
    uint64_t start;
} gw_process;

gw_process gw_process_find(int64_t number);
/* ns since this process began, to 10 ms or so; 0 when it cannot be told. */
int64_t gw_process_age(void);
gw_process_state gw_process_look(const gw_process *process);

#endif
