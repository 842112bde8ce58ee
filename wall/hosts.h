/* The machines of a wall: which host draws which tile, which of them is this one, how the others are reached
 * and on which address of this machine they find the launcher. Launcher and doctor. */
#ifndef GW_WALL_HOSTS_H
#define GW_WALL_HOSTS_H

#include "base/status.h"
#include "wall/site.h"

#include <stdint.h>

typedef struct gw_host {
    char name[64];      /* as the site has it; of this machine "localhost" */
    char address[64];   /* numeric; "" when the name does not resolve here (ssh may know it all the same) */
    char from[64];      /* numeric address of this machine's interface towards it; "": none known */
    int here;           /* it is this machine */
    int resolve_failed; /* getaddrinfo()'s code, 0: none */
    int route_failed;   /* errno of the way there, 0: none */
    uint32_t tile_count, first_tile;
} gw_host;

typedef struct gw_hosts {
    uint32_t count; /* in the order of their first tiles */
    gw_host host[GW_MAXIMUM_TILES];
    uint32_t of_tile[GW_MAXIMUM_TILES]; /* index into host */
    uint32_t remote;                    /* how many are not this machine */
    char listen[64]; /* numeric address on which this machine is found; "" without others */
    char subnet[64]; /* "10.0.0.0/24" that holds all of them, IPv4 only; "": there is none */
} gw_hosts;

/* All tiles on this machine, whatever the site says. */
void gw_hosts_simulate(const gw_site *site, gw_hosts *out);
/* The site's hosts, with what the resolver and the routing table say about each. */
void gw_hosts_find(const gw_site *site, gw_hosts *out);
/* GW_MACHINE when the others would not find this machine. */
gw_code gw_hosts_check(const gw_hosts *hosts, gw_error *error);

#endif
