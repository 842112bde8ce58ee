#include "tracking/socket.h"

#include "base/clock.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

/* --- addresses */

int gw_address_is_numeric(const char *address) {
    struct in_addr unused;
    return inet_pton(AF_INET, address, &unused) == 1;
}

int gw_address_is_multicast(const char *address) {
    struct in_addr number;
    return inet_pton(AF_INET, address, &number) == 1 && IN_MULTICAST(ntohl(number.s_addr));
}

gw_code gw_endpoint_parse(const char *text, const char *what, gw_endpoint *out, gw_error *error) {
    gw_endpoint made = *out;
    if (text[0] == '\0')
        return GW_OK;
    const char *colon = strrchr(text, ':'), *port = colon ? colon + 1 : text;
    const size_t length = colon ? (size_t)(colon - text) : 0;
    if (length >= sizeof made.address)
        return gw_fail(error, GW_BAD_INPUT, "%s: '%.*s' is no numeric IPv4 address, as 10.0.0.5", what,
                       (int)length, text);
    if (colon) {
        memcpy(made.address, text, length);
        made.address[length] = '\0';
        if (!gw_address_is_numeric(made.address))
            return gw_fail(error, GW_BAD_INPUT, "%s: '%s' is no numeric IPv4 address, as 10.0.0.5", what,
                           made.address);
    }
    char *end;
    const unsigned long number = port[0] >= '0' && port[0] <= '9' ? strtoul(port, &end, 10) : 65536;
    if (number > 65535 || *end != '\0')
        return gw_fail(error, GW_BAD_INPUT, "%s: '%s' is no port, 0 to 65535", what, port);
    made.port = (uint16_t)number;
    *out = made;
    return GW_OK;
}

int gw_endpoint_equal(const gw_endpoint *a, const gw_endpoint *b) {
    return a->port == b->port && strcmp(a->address, b->address) == 0;
}

static struct sockaddr_in to_system(const gw_endpoint *endpoint) {
    struct sockaddr_in out = {.sin_family = AF_INET, .sin_port = htons(endpoint->port)};
    if (endpoint->address[0] != '\0')
        inet_pton(AF_INET, endpoint->address, &out.sin_addr);
    return out;
}

static void from_system(const struct sockaddr_in *address, gw_endpoint *out) {
    memset(out, 0, sizeof *out);
    inet_ntop(AF_INET, &address->sin_addr, out->address, sizeof out->address);
    out->port = ntohs(address->sin_port);
}

/* --- making sockets */

static int give_up(int made) {
    const int failed = errno;
    if (made >= 0)
        close(made);
    errno = failed;
    return -1;
}

static int make(int type) {
    return socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

static int bind_to(int made, const gw_endpoint *at, uint16_t *out) {
    struct sockaddr_in address = to_system(at);
    socklen_t size = sizeof address;
    if (bind(made, (struct sockaddr *)&address, size) ||
        getsockname(made, (struct sockaddr *)&address, &size))
        return -1;
    if (out)
        *out = ntohs(address.sin_port);
    return 0;
}

static void set(int made, int level, int option, int value) {
    (void)setsockopt(made, level, option, &value, sizeof value);
}

int gw_socket_listen(const gw_endpoint *at, uint16_t *out) {
    const int made = make(SOCK_STREAM);
    if (made < 0)
        return -1;
    set(made, SOL_SOCKET, SO_REUSEADDR, 1);
    return bind_to(made, at, out) || listen(made, 16) ? give_up(made) : made;
}

/* Both ends of a connection: small packets leave at once, and arrivals are stamped. */
static void prepare_stream(int made) {
    set(made, IPPROTO_TCP, TCP_NODELAY, 1);
    set(made, SOL_SOCKET, SO_TIMESTAMPNS, 1);
}

int gw_socket_accept(int listening, gw_endpoint *from) {
    struct sockaddr_in address;
    socklen_t size = sizeof address;
    const int made = accept4(listening, (struct sockaddr *)&address, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (made < 0)
        return -1;
    prepare_stream(made);
    from_system(&address, from);
    return made;
}

int gw_socket_connect(const gw_endpoint *to, const char *bind) {
    const int made = make(SOCK_STREAM);
    if (made < 0)
        return -1;
    if (bind && bind[0] != '\0') {
        gw_endpoint from = {.port = 0};
        snprintf(from.address, sizeof from.address, "%s", bind);
        if (bind_to(made, &from, NULL))
            return give_up(made);
    }
    prepare_stream(made);
    struct sockaddr_in address = to_system(to);
    if (connect(made, (struct sockaddr *)&address, sizeof address) && errno != EINPROGRESS)
        return give_up(made);
    return made;
}

int gw_socket_settled(int connecting) {
    struct pollfd look = {.fd = connecting, .events = POLLOUT};
    int failed = 0;
    socklen_t size = sizeof failed;
    if (poll(&look, 1, 0) <= 0)
        return 0;
    if (getsockopt(connecting, SOL_SOCKET, SO_ERROR, &failed, &size))
        return -1;
    errno = failed;
    return failed ? -1 : 1;
}

int gw_socket_datagrams(const gw_endpoint *at, const char *group, uint16_t *out) {
    const int made = make(SOCK_DGRAM), joins = group && gw_address_is_multicast(group);
    if (made < 0)
        return -1;
    set(made, SOL_SOCKET, SO_TIMESTAMPNS, 1);
    if (!joins)
        return bind_to(made, at, out) ? give_up(made) : made;
    /* Several programs of one machine may listen to a group; bound to it, nothing else comes through. */
    gw_endpoint there = {.port = at->port};
    struct ip_mreq join = {.imr_multiaddr.s_addr = inet_addr(group)};
    if (at->address[0] != '\0')
        join.imr_interface.s_addr = inet_addr(at->address);
    snprintf(there.address, sizeof there.address, "%s", group);
    set(made, SOL_SOCKET, SO_REUSEADDR, 1);
    if (bind_to(made, &there, out) || setsockopt(made, IPPROTO_IP, IP_ADD_MEMBERSHIP, &join, sizeof join))
        return give_up(made);
    return made;
}

int gw_socket_own_address(const gw_endpoint *to, char address[16]) {
    const int made = make(SOCK_DGRAM);
    struct sockaddr_in there = to_system(to), own;
    socklen_t size = sizeof own;
    if (made < 0)
        return -1;
    if (connect(made, (struct sockaddr *)&there, sizeof there) ||
        getsockname(made, (struct sockaddr *)&own, &size))
        return give_up(made);
    close(made);
    inet_ntop(AF_INET, &own.sin_addr, address, 16);
    return 0;
}

void gw_socket_close(int *socket) {
    if (*socket >= 0)
        close(*socket);
    *socket = -1;
}

/* --- sending and receiving */

/* The kernel stamps arrivals with the clock that people set; that time's distance from now is what counts. */
static int64_t arrival_of(struct msghdr *message, int64_t now) {
    const int64_t plausible = 1000000000;
    for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c; c = CMSG_NXTHDR(message, c)) {
        if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS)
            continue;
        struct timespec stamp;
        memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
        const int64_t passed = gw_unix_ns() - ((int64_t)stamp.tv_sec * 1000000000 + stamp.tv_nsec);
        const int64_t arrival = gw_now_ns() - passed;
        /* Not where that clock was set in between. */
        if (passed >= 0 && passed < plausible)
            return arrival < now ? arrival : now;
    }
    return now;
}

ssize_t gw_socket_receive(int socket, void *bytes, size_t size, int64_t now, int64_t *arrival,
                          gw_endpoint *from) {
    union {
        struct cmsghdr header;
        char room[CMSG_SPACE(sizeof(struct timespec))];
    } control;
    struct sockaddr_in address = {0};
    struct iovec part = {.iov_base = bytes, .iov_len = size};
    struct msghdr message = {.msg_name = &address,
                             .msg_namelen = sizeof address,
                             .msg_iov = &part,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control};
    const ssize_t got = recvmsg(socket, &message, MSG_DONTWAIT);
    if (got < 0)
        return -1;
    if (arrival)
        *arrival = arrival_of(&message, now);
    if (from)
        from_system(&address, from);
    return message.msg_flags & MSG_TRUNC ? (ssize_t)size + 1 : got;
}

ssize_t gw_socket_send(int socket, const void *bytes, size_t size) {
    const ssize_t sent = send(socket, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    return sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) ? 0 : sent;
}

ssize_t gw_socket_send_to(int socket, const gw_endpoint *to, const void *bytes, size_t size) {
    const struct sockaddr_in address = to_system(to);
    const ssize_t sent = sendto(socket, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT,
                                (const struct sockaddr *)&address, sizeof address);
    return sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) ? 0 : sent;
}
