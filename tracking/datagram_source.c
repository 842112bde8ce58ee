/* What the sources that listen to datagrams share: the port, who may send, and when nobody does any more. */
#include "tracking/source_internal.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t SILENCE = 2000000000; /* ns after which a sender of datagrams is lost */

static gw_code listen_at(gw_datagram_source *s, const char *where, gw_error *error) {
    gw_source *source = &s->base;
    gw_endpoint given = {.port = 0}, at = {.port = 0};
    uint16_t port;
    gw_code code = gw_endpoint_parse(where, source->spec, &given, error);
    if (code)
        return code;
    if (!where[0])
        return gw_fail(error, GW_BAD_INPUT, "%s: name the port to listen to, as %s5000", source->spec,
                       source->spec);
    memcpy(at.address, source->bind, sizeof at.address);
    at.port = given.port;
    s->only = given;
    if (gw_address_is_multicast(given.address))
        s->only.address[0] = '\0';
    s->socket = gw_socket_datagrams(&at, given.address, &port);
    if (s->socket < 0)
        return gw_fail(error, GW_MACHINE, "%s: port %u cannot be listened to: %s%s", source->spec,
                       (unsigned)given.port, strerror(errno),
                       errno == EADDRINUSE      ? "; another program has it"
                       : errno == EADDRNOTAVAIL ? "; that is no address of this machine"
                       : errno == ENODEV        ? "; no interface leads there: name one to bind to"
                                                : "");
    snprintf(source->status.address, sizeof source->status.address, "%s:%u",
             given.address[0] ? given.address : "0.0.0.0", (unsigned)port);
    if (given.port == 0)
        gw_log_write(
            source->log, GW_LOG_WARNING,
            "tracker %s: port 0 is any that is free: %u now, another one next time; name one that its "
            "sender knows",
            source->spec, (unsigned)port);
    source->status.standing = GW_SOURCE_SILENT;
    return GW_OK;
}

ptrdiff_t gw_datagram_source_next(gw_datagram_source *s, uint8_t *bytes, size_t size, int64_t now,
                                  int64_t *arrival) {
    gw_source *source = &s->base;
    for (int others = 0; others < 1024; others++) {
        gw_endpoint from;
        const ptrdiff_t got = gw_socket_receive(s->socket, bytes, size, now, arrival, &from);
        if (got < 0)
            return -1;
        source->counters.packets++;
        source->counters.bytes += (uint64_t)got;
        if (!s->only.address[0] || strcmp(s->only.address, from.address) == 0)
            return got;
        source->counters.unknown++;
    }
    return -1;
}

static int is_up(const gw_source *source) {
    return source->counters.connections > source->counters.losses;
}

void gw_datagram_source_watch(gw_datagram_source *s, int64_t now) {
    gw_source *source = &s->base;
    if (!is_up(source) || now - s->last < SILENCE)
        return;
    gw_source_emit_link(source, 0, now);
    source->status.standing = GW_SOURCE_SILENT;
    gw_log_write(source->log, GW_LOG_WARNING, "tracker %s: nothing has come for 2 s", source->spec);
}

int64_t gw_datagram_source_wakes(const gw_source *source) {
    return is_up(source) ? ((const gw_datagram_source *)source)->last + SILENCE : INT64_MAX;
}

/* --- opening and closing */

static int descriptors(const gw_source *source, int *out, int room) {
    if (room > 0)
        out[0] = ((const gw_datagram_source *)source)->socket;
    return room > 0;
}

static void close_source(gw_source *source) {
    gw_socket_close(&((gw_datagram_source *)source)->socket);
    free(source);
}

gw_code gw_datagram_source_open(const gw_source *like, const char *where, size_t size, const char *what,
                                void (*poll)(gw_source *source, int64_t now), gw_datagram_source **out,
                                gw_error *error) {
    void *memory = NULL;
    *out = NULL;
    gw_code code = gw_allocate(&memory, 1, size, what, error);
    if (code)
        return code;
    gw_datagram_source *s = memory;
    s->base = *like;
    s->base.poll = poll;
    s->base.descriptors = descriptors;
    s->base.next = gw_datagram_source_wakes;
    s->base.close = close_source;
    code = listen_at(s, where, error);
    if (code)
        free(s);
    else
        *out = s;
    return code;
}
