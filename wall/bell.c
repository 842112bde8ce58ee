#include "wall/bell.h"

#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

enum { MAXIMUM_OTHERS = 192, MAXIMUM_RINGS = 256 };

static socklen_t name_of(uint64_t nonce, int rank, struct sockaddr_un *out) {
    memset(out, 0, sizeof *out);
    out->sun_family = AF_UNIX;
    int length =
        snprintf(out->sun_path + 1, sizeof out->sun_path - 1, "gazewall-bell-%016" PRIx64 "-%d", nonce, rank);
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
}

gw_code gw_bell_open(uint64_t nonce, int rank, gw_bell *out, gw_error *error) {
    struct sockaddr_un name;
    socklen_t length = name_of(nonce, rank, &name);
    out->nonce = nonce;
    out->socket = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (out->socket >= 0 && !bind(out->socket, (struct sockaddr *)&name, length))
        return GW_OK;
    gw_fail(error, GW_MACHINE, "the bell of rank %d could not be hung: %s", rank, strerror(errno));
    gw_bell_close(out);
    return GW_MACHINE;
}

void gw_bell_close(gw_bell *bell) {
    if (bell->socket >= 0)
        close(bell->socket);
    bell->socket = -1;
}

void gw_bell_ring(const gw_bell *bell, int rank) {
    struct sockaddr_un name;
    socklen_t length = name_of(bell->nonce, rank, &name);
    /* A queue that is full wakes the rank as well; one that is gone needs no waking. */
    (void)!sendto(bell->socket, "", 1, MSG_DONTWAIT | MSG_NOSIGNAL, (struct sockaddr *)&name, length);
}

void gw_bell_wait(gw_bell *bell, int64_t ns, const struct pollfd *others, nfds_t other_count) {
    struct pollfd wait[MAXIMUM_OTHERS + 1];
    nfds_t count = other_count < MAXIMUM_OTHERS ? other_count : MAXIMUM_OTHERS;
    wait[0] = (struct pollfd){.fd = bell->socket, .events = POLLIN};
    for (nfds_t i = 0; i < count; i++)
        wait[i + 1] = others[i];
    const struct timespec time = {.tv_sec = ns / 1000000000, .tv_nsec = ns % 1000000000};
    if (ppoll(wait, count + 1, &time, NULL) <= 0 || !wait[0].revents)
        return;
    char rings[16];
    for (int i = 0; i < MAXIMUM_RINGS && recv(bell->socket, rings, sizeof rings, MSG_DONTWAIT) >= 0; i++)
        ;
}
