/* Whether a TCP port answers, and if not, how not: what tells a wrong address from a firewall. Any thread. */
#ifndef GW_WALL_REACH_H
#define GW_WALL_REACH_H

#include <stdint.h>

typedef enum gw_reach {
    GW_REACHED,
    GW_REACH_REFUSED,   /* the machine is there, nobody listens on the port */
    GW_REACH_TIMED_OUT, /* no answer: a firewall drops it, or the machine is off */
    GW_REACH_NO_ROUTE,  /* the network knows no way, or nobody has the address */
    GW_REACH_FAILED     /* anything else: errno tells */
} gw_reach;

/* address is numeric. Waits at most `milliseconds`. socket may be NULL; else it is the open connection when
 * GW_REACHED, which the caller closes, and -1 otherwise. */
gw_reach gw_reach_tcp(const char *address, uint16_t port, int milliseconds, int *socket);
/* "timed out", ... */
const char *gw_reach_name(gw_reach reach);

#endif
