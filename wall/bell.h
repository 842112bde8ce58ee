/* Bells: how ranks of one machine wake each other at once without spinning while they wait.
 *
 * MPI only notices a message when it is asked, so a waiting rank either burns a processor or sleeps too long.
 * Each rank therefore has a datagram socket with a name of the run in the abstract name space (nothing is
 * left behind); who sends something over MPI rings the receiver's bell afterwards. A bell says nothing but
 * "look": rung by a stranger it costs a look. Ranks of other machines have none, and are looked after by
 * naps. One thread. */
#ifndef GW_WALL_BELL_H
#define GW_WALL_BELL_H

#include "base/status.h"

#include <poll.h>
#include <stdint.h>

typedef struct gw_bell {
    int socket;
    uint64_t nonce; /* of the run */
} gw_bell;

gw_code gw_bell_open(uint64_t nonce, int rank, gw_bell *out, gw_error *error);
void gw_bell_close(gw_bell *bell);
void gw_bell_ring(const gw_bell *bell, int rank);
/* Sleeps until the bell rings, one of `others` is ready, or `ns` have passed. */
void gw_bell_wait(gw_bell *bell, int64_t ns, const struct pollfd *others, nfds_t other_count);

#endif
