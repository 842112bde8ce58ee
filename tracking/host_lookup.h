/* Looks up a host's IPv4 address without waiting: the C library does it on a thread of its own, so a name
 * server that does not answer stalls nobody. One owner. */
#ifndef GW_TRACKING_HOST_LOOKUP_H
#define GW_TRACKING_HOST_LOOKUP_H

#include "base/status.h"

typedef struct gw_host_lookup gw_host_lookup;

gw_code gw_host_lookup_start(const char *host, gw_host_lookup **out, gw_error *error);
/* 1 and the address; 0 not yet; -1 the name does not resolve, and why (text of the C library). */
int gw_host_lookup_settled(gw_host_lookup *lookup, char address[16], const char **why);
/* Whether or not it is settled. One that the library will not give up is left to it: the process's end, or
 * its own time-out, ends it. */
void gw_host_lookup_end(gw_host_lookup **lookup);

#endif
