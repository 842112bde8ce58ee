#include "wall/hosts.h"

#include <arpa/inet.h>
#include <errno.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

#define HERE "localhost"

static void numeric(const struct sockaddr *address, socklen_t size, char out[64]) {
    if (getnameinfo(address, size, out, 64, NULL, 0, NI_NUMERICHOST))
        out[0] = '\0';
}

static socklen_t address_size(const struct sockaddr *address) {
    return address->sa_family == AF_INET ? sizeof(struct sockaddr_in) : sizeof(struct sockaddr_in6);
}

static int is_internet(const struct sockaddr *address) {
    return address && (address->sa_family == AF_INET || address->sa_family == AF_INET6);
}

/* 1 when an interface of this machine has the address. */
static int is_own_address(const char *address) {
    struct ifaddrs *all = NULL;
    int own = 0;
    if (getifaddrs(&all))
        return 0;
    for (const struct ifaddrs *i = all; i && !own; i = i->ifa_next) {
        char text[64];
        if (!is_internet(i->ifa_addr))
            continue;
        numeric(i->ifa_addr, address_size(i->ifa_addr), text);
        own = !strcmp(text, address);
    }
    freeifaddrs(all);
    return own;
}

static int is_own_name(const char *name) {
    char own[256] = "";
    if (!name[0] || !strcasecmp(name, HERE))
        return 1;
    gethostname(own, sizeof own - 1);
    size_t first = strcspn(own, ".");
    return !strcasecmp(name, own) || (strlen(name) == first && !strncasecmp(name, own, first));
}

/* Which of our addresses packets to it would come from: connecting a datagram socket sends nothing. */
static void find_route(gw_host *host, const struct addrinfo *to) {
    struct sockaddr_storage from;
    socklen_t size = sizeof from;
    int probe = socket(to->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (probe < 0 || connect(probe, to->ai_addr, to->ai_addrlen) ||
        getsockname(probe, (struct sockaddr *)&from, &size))
        host->route_failed = errno;
    else
        numeric((struct sockaddr *)&from, size, host->from);
    if (probe >= 0)
        close(probe);
}

static void look_up(gw_host *host) {
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    struct addrinfo *found = NULL;
    /* "user@name" is as ssh takes it. */
    const char *at = strrchr(host->name, '@'), *name = at ? at + 1 : host->name;
    host->here = is_own_name(name);
    if (!host->here) {
        host->resolve_failed = getaddrinfo(name, "22", &hints, &found);
        if (host->resolve_failed)
            return;
        numeric(found->ai_addr, found->ai_addrlen, host->address);
        host->here = is_own_address(host->address);
        if (!host->here)
            find_route(host, found);
        freeaddrinfo(found);
    }
    if (host->here)
        snprintf(host->name, sizeof host->name, HERE);
}

static uint32_t add_host(gw_hosts *out, gw_host host, uint32_t tile) {
    for (uint32_t i = 0; i < out->count; i++)
        if (!strcmp(out->host[i].name, host.name))
            return i;
    host.first_tile = tile;
    host.tile_count = 0;
    out->remote += !host.here;
    out->host[out->count] = host;
    return out->count++;
}

void gw_hosts_simulate(const gw_site *site, gw_hosts *out) {
    memset(out, 0, sizeof *out);
    out->count = 1;
    out->host[0] = (gw_host){.name = HERE, .here = 1, .tile_count = site->layout.tile_count};
}

/* "10.1.2.3" with the mask of the interface that has it: "10.1.2.0/24", and whether `other` is in it. */
static int in_subnet(const char *own, const char *other, char text[64]) {
    struct ifaddrs *all = NULL;
    struct in_addr a, b;
    int inside = 0;
    if (inet_pton(AF_INET, own, &a) != 1 || inet_pton(AF_INET, other, &b) != 1 || getifaddrs(&all))
        return 0;
    for (const struct ifaddrs *i = all; i; i = i->ifa_next) {
        if (!i->ifa_addr || i->ifa_addr->sa_family != AF_INET || !i->ifa_netmask)
            continue;
        struct sockaddr_in address, mask;
        memcpy(&address, i->ifa_addr, sizeof address);
        memcpy(&mask, i->ifa_netmask, sizeof mask);
        if (address.sin_addr.s_addr != a.s_addr)
            continue;
        const in_addr_t bits = mask.sin_addr.s_addr;
        struct in_addr net = {a.s_addr & bits};
        char dotted[INET_ADDRSTRLEN] = "";
        inet_ntop(AF_INET, &net, dotted, sizeof dotted);
        snprintf(text, 64, "%s/%d", dotted, __builtin_popcount(bits));
        inside = (b.s_addr & bits) == net.s_addr;
        break;
    }
    freeifaddrs(all);
    return inside;
}

static void find_network(const gw_site *site, gw_hosts *out) {
    for (uint32_t i = 0; i < out->count && !out->listen[0]; i++)
        if (!out->host[i].here)
            snprintf(out->listen, sizeof out->listen, "%s", out->host[i].from);
    /* The site's own word is about the first tile's machine. */
    if (out->remote && site->address[0] && is_own_address(site->address))
        snprintf(out->listen, sizeof out->listen, "%s", site->address);
    char subnet[64] = "";
    for (uint32_t i = 0; i < out->count; i++)
        if (!out->host[i].here && !in_subnet(out->listen, out->host[i].address, subnet))
            return;
    snprintf(out->subnet, sizeof out->subnet, "%s", subnet);
}

void gw_hosts_find(const gw_site *site, gw_hosts *out) {
    memset(out, 0, sizeof *out);
    for (uint32_t tile = 0; tile < site->layout.tile_count; tile++) {
        const char *name = site->panels[tile].host;
        gw_host host = {0};
        /* Tiles of one host stand together as a rule: it is looked up once. */
        if (tile && !strcmp(name, site->panels[tile - 1].host))
            host = out->host[out->of_tile[tile - 1]];
        else {
            snprintf(host.name, sizeof host.name, "%s", name);
            look_up(&host);
        }
        uint32_t index = add_host(out, host, tile);
        out->of_tile[tile] = index;
        out->host[index].tile_count++;
    }
    find_network(site, out);
}

gw_code gw_hosts_check(const gw_hosts *hosts, gw_error *error) {
    if (!hosts->remote || hosts->listen[0])
        return GW_OK;
    for (uint32_t i = 0; i < hosts->count; i++) {
        const gw_host *h = &hosts->host[i];
        if (!h->here && h->resolve_failed)
            return gw_fail(error, GW_MACHINE,
                           "host '%s': its name does not resolve here: %s; write its address in the site "
                           "file, or the name in /etc/hosts",
                           h->name, gai_strerror(h->resolve_failed));
        if (!h->here && h->route_failed)
            return gw_fail(error, GW_MACHINE, "host '%s' (%s): no way there from this machine: %s", h->name,
                           h->address, strerror(h->route_failed));
    }
    return gw_fail(error, GW_MACHINE, "this machine has no address for the other hosts");
}
