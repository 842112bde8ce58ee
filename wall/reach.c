#include "wall/reach.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>
#include <unistd.h>

static gw_reach reach_of(int failed) {
    switch (failed) {
    case 0:
        return GW_REACHED;
    case ECONNREFUSED:
        return GW_REACH_REFUSED;
    case ETIMEDOUT:
        return GW_REACH_TIMED_OUT;
    case EHOSTUNREACH:
    case ENETUNREACH:
    case ENETDOWN:
        return GW_REACH_NO_ROUTE;
    default:
        return GW_REACH_FAILED;
    }
}

/* errno of the connection, 0 when it stands. */
static int wait_for(int made, int milliseconds) {
    struct pollfd wait = {.fd = made, .events = POLLOUT};
    int failed = 0;
    socklen_t size = sizeof failed;
    if (poll(&wait, 1, milliseconds) <= 0)
        return ETIMEDOUT;
    return getsockopt(made, SOL_SOCKET, SO_ERROR, &failed, &size) ? errno : failed;
}

gw_reach gw_reach_tcp(const char *address, uint16_t port, int milliseconds, int *out) {
    const struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    char text[8];
    if (out)
        *out = -1;
    snprintf(text, sizeof text, "%u", (unsigned)port);
    errno = EINVAL;
    if (getaddrinfo(address, text, &hints, &found))
        return GW_REACH_FAILED;
    int made = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, found->ai_protocol);
    int failed = made < 0 || connect(made, found->ai_addr, found->ai_addrlen) ? errno : 0;
    freeaddrinfo(found);
    if (failed == EINPROGRESS)
        failed = wait_for(made, milliseconds);
    if (made >= 0 && (failed || !out))
        close(made);
    else if (out)
        *out = made;
    errno = failed;
    return reach_of(failed);
}

const char *gw_reach_name(gw_reach reach) {
    static const char *const names[] = {"reached", "refused", "timed out", "no route", "failed"};
    return names[reach];
}
