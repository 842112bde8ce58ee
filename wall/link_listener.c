/* The launcher's listening sockets: a Unix one for its own machine, a TCP one on one address for others. */
#include "wall/link.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { WAITING = 128, PATIENCE_S = 1 };

static gw_code listen_here(gw_link_listener *out, gw_error *error) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    /* The abstract name: a zero byte, then the name. */
    size_t length = strlen(out->local_name);
    memcpy(address.sun_path + 1, out->local_name, length);
    socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + length);
    out->local = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (out->local < 0 || bind(out->local, (struct sockaddr *)&address, size) || listen(out->local, WAITING))
        return gw_fail(error, GW_MACHINE, "the line to the ranks could not be opened: %s", strerror(errno));
    return GW_OK;
}

static void name_network(gw_link_listener *out, const char *address) {
    struct sockaddr_storage bound;
    socklen_t size = sizeof bound;
    char port[16] = "";
    if (!getsockname(out->network, (struct sockaddr *)&bound, &size))
        getnameinfo((struct sockaddr *)&bound, size, NULL, 0, port, sizeof port, NI_NUMERICSERV);
    snprintf(out->network_name, sizeof out->network_name, "tcp:%s:%s", address, port);
}

static gw_code listen_network(const char *address, gw_link_listener *out, gw_error *error) {
    const struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_PASSIVE};
    struct addrinfo *found = NULL;
    int failed = getaddrinfo(address, "0", &hints, &found);
    if (failed)
        return gw_fail(error, GW_BAD_INPUT, "'%s' is no numeric address: %s", address, gai_strerror(failed));
    out->network = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, found->ai_protocol);
    int bad = out->network < 0 || bind(out->network, found->ai_addr, found->ai_addrlen) ||
              listen(out->network, WAITING);
    gw_code code = bad ? gw_fail(error, GW_MACHINE, "nothing can listen at %s on this machine: %s", address,
                                 strerror(errno))
                       : GW_OK;
    freeaddrinfo(found);
    if (!code)
        name_network(out, address);
    return code;
}

gw_code gw_link_listen(const char *address, gw_link_listener *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    out->local = out->network = -1;
    uint64_t random[3];
    if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random)
        return gw_fail(error, GW_MACHINE, "the kernel gives no random numbers: %s", strerror(errno));
    snprintf(out->local_name, sizeof out->local_name, "gazewall-%ld-%016llx", (long)getpid(),
             (unsigned long long)random[0]);
    snprintf(out->secret, sizeof out->secret, "%016llx%016llx", (unsigned long long)random[1],
             (unsigned long long)random[2]);
    gw_code code = listen_here(out, error);
    if (!code && address)
        code = listen_network(address, out, error);
    if (code)
        gw_link_close(out);
    return code;
}

void gw_link_close(gw_link_listener *listener) {
    if (listener->local >= 0)
        close(listener->local);
    if (listener->network >= 0)
        close(listener->network);
    listener->local = listener->network = -1;
}

static int accept_here(int listener, pid_t *pid) {
    for (;;) {
        int taken = accept4(listener, NULL, NULL, SOCK_CLOEXEC);
        if (taken < 0)
            return -1;
        struct ucred who;
        socklen_t size = sizeof who;
        if (!getsockopt(taken, SOL_SOCKET, SO_PEERCRED, &who, &size) && who.uid == geteuid()) {
            *pid = who.pid;
            gw_line_prepare(taken, 0, PATIENCE_S);
            return taken;
        }
        close(taken);
    }
}

int gw_link_accept(const gw_link_listener *listener, pid_t *pid, char from[64]) {
    int taken = accept_here(listener->local, pid);
    if (taken >= 0) {
        snprintf(from, 64, "this machine");
        return taken;
    }
    if (listener->network < 0)
        return -1;
    struct sockaddr_storage peer;
    socklen_t size = sizeof peer;
    taken = accept4(listener->network, (struct sockaddr *)&peer, &size, SOCK_CLOEXEC);
    if (taken < 0)
        return -1;
    *pid = 0;
    if (getnameinfo((struct sockaddr *)&peer, size, from, 64, NULL, 0, NI_NUMERICHOST))
        snprintf(from, 64, "an unknown address");
    gw_line_prepare(taken, 1, PATIENCE_S);
    return taken;
}
