/* The doctor's look at the tracker that the site names: a recording, or a VRPN server by NAME@HOST[:PORT].
 * Its port is asked and its greeting compared (VRPN's 24-byte cookie: all up to the last dot must match). */
#include "wall/doctor.h"
#include "wall/reach.h"

#include "base/file.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { VRPN_PORT = 3883, COOKIE = 24, MATCHING = 14, REACH_MS = 3000, GREETING_MS = 3000 };

static const char cookie[COOKIE] = "vrpn: ver. 07.38  0";

#define FIND(finding, code, ...) gw_doctor_find(d, finding, code, "tracker", __VA_ARGS__)

/* NAME@HOST[:PORT], with "vrpn:" or VRPN's own "tcp://" where people write it; 0: it is none. */
static int parse(const char *source, char host[256], unsigned *port) {
    const char *at = strchr(source, '@');
    if (!at || at == source)
        return 0;
    at += strncmp(at + 1, "tcp://", 6) ? 1 : 7;
    *port = VRPN_PORT;
    snprintf(host, 256, "%s", at);
    char *colon = strrchr(host, ':');
    if (colon) {
        char *end;
        unsigned long number = strtoul(colon + 1, &end, 10);
        if (!number || number > 65535 || *end)
            return 0;
        *port = (unsigned)number;
        *colon = '\0';
    }
    return host[0] != '\0';
}

/* Bytes of the greeting that came. */
static size_t exchange(int made, char greeting[COOKIE]) {
    size_t size = 0;
    (void)!send(made, cookie, COOKIE, MSG_NOSIGNAL);
    while (size < COOKIE) {
        struct pollfd wait = {.fd = made, .events = POLLIN};
        if (poll(&wait, 1, GREETING_MS) <= 0)
            break;
        ssize_t more = recv(made, greeting + size, COOKIE - size, MSG_DONTWAIT);
        if (more <= 0)
            break;
        size += (size_t)more;
    }
    return size;
}

static void listen_to(gw_doctor *d, const char *address, unsigned port) {
    int made;
    char greeting[COOKIE + 1] = "";
    switch (gw_reach_tcp(address, (uint16_t)port, REACH_MS, &made)) {
    case GW_REACHED:
        break;
    case GW_REACH_REFUSED:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s is there, but its port %u is closed: start the VRPN server",
             address, port);
        return;
    case GW_REACH_TIMED_OUT:
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "no answer from %s port %u in %d s: a firewall drops it, or the machine is off", address, port,
             REACH_MS / 1000);
        return;
    default:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "no way to %s: %s", address, strerror(errno));
        return;
    }
    size_t size = exchange(made, greeting);
    close(made);
    if (size < COOKIE)
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "%s port %u is open, but gave no VRPN greeting in %d s: is it another server?", address, port,
             GREETING_MS / 1000);
    else if (memcmp(greeting, cookie, 11) != 0)
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "%s port %u is open, but no VRPN server: another program listens there", address, port);
    else if (memcmp(greeting, cookie, MATCHING) != 0)
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s port %u speaks VRPN %.5s, not 07: use a server of version 7",
             address, port, greeting + 11);
    else
        FIND(GW_FINDING_GOOD, GW_OK, "%s port %u speaks VRPN %.5s", address, port, greeting + 11);
}

void gw_doctor_tracker(gw_doctor *d) {
    const char *source = d->site->tracker;
    char host[256], address[64] = "";
    unsigned port;
    if (!source[0])
        return;
    if (gw_file_exists(source)) {
        FIND(GW_FINDING_GOOD, GW_OK, "%s is a recording", source);
        return;
    }
    if (!parse(source, host, &port)) {
        FIND(GW_FINDING_WRONG, GW_BAD_INPUT,
             "'%s' is neither a file nor a VRPN server NAME@HOST[:PORT], as Tracker0@10.0.0.5", source);
        return;
    }
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    struct addrinfo *found = NULL;
    int failed = getaddrinfo(host, NULL, &hints, &found);
    if (failed) {
        FIND(GW_FINDING_WRONG, GW_BAD_INPUT, "the name '%s' does not resolve: %s", host,
             gai_strerror(failed));
        return;
    }
    getnameinfo(found->ai_addr, found->ai_addrlen, address, sizeof address, NULL, 0, NI_NUMERICHOST);
    freeaddrinfo(found);
    listen_to(d, address, port);
}
