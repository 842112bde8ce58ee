/* A VRPN client: reports of one device by name. By TCP, or, on request, VRPN's other way: a datagram asks the
 * server to call back, and poses come by datagram. A lost server is sought every second, with all that was
 * learned of its numbers forgotten. What a server sends is bounded, counted, and passed over where it makes
 * no sense; only a length that is impossible ends the connection, because nothing after it can be found. */
#include "tracking/vrpn_client_internal.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t SECOND = 1000000000;
enum {
    CONNECT_S = 3,
    GREETING_S = 5,
    RETRY_S = 1,
    CALL_AGAIN_S = 2,
    SENDER_S = 2, /* a server that has the device has described it by then */
    SILENT_S = 3, /* without a message: is it still there? */
    PONG_WARN_S = 3,
    PONG_LOST_S = 10,
    OURS = 0, /* our number of the device */
    PING = 0  /* our number of the type */
};

/* --- states */

static void stand(gw_vrpn_client *c, gw_source_standing standing, const char *detail) {
    static const char *const words[] = {[GW_SOURCE_UNRESOLVED] = "its host's name does not resolve",
                                        [GW_SOURCE_REFUSED] = "its machine is there, but the port is closed",
                                        [GW_SOURCE_NO_ANSWER] = "no answer",
                                        [GW_SOURCE_NO_ROUTE] = "no way there",
                                        [GW_SOURCE_NO_GREETING] = "connected, but it gives no greeting",
                                        [GW_SOURCE_OTHER_PROTOCOL] = "what listens there does not speak VRPN",
                                        [GW_SOURCE_OTHER_VERSION] = "another major version of VRPN than 07",
                                        [GW_SOURCE_CLOSED] = "the connection is lost"};
    /* Each second anew is no news. */
    if (standing != c->base.status.standing && words[standing])
        gw_log_write(c->base.log, GW_LOG_WARNING, "tracker %s: %s%s%s", c->base.spec, words[standing],
                     detail[0] ? ": " : "", detail);
    c->base.status.standing = standing;
    snprintf(c->base.status.detail, sizeof c->base.status.detail, "%s", detail);
}

static void forget_server(gw_vrpn_client *c) {
    memset(c->is_ours, 0, sizeof c->is_ours);
    memset(c->types, 0, sizeof c->types);
    memset(c->pressed, 0, sizeof c->pressed);
    c->sender_known = c->senders_told = c->axis_count = 0;
    c->senders[0] = '\0';
    c->in_size = 0;
}

/* Gives the connection up; it is sought again. */
static void lose(gw_vrpn_client *c, gw_source_standing standing, const char *detail, int64_t now) {
    if (c->phase == GW_VRPN_SERVED)
        gw_source_emit_link(&c->base, 0, now);
    gw_socket_close(&c->stream);
    gw_socket_close(&c->listening);
    gw_socket_close(&c->datagrams);
    forget_server(c);
    stand(c, standing, detail);
    if (!gw_address_is_numeric(c->host))
        c->server.address[0] = '\0'; /* its name may lead elsewhere next time */
    c->phase = GW_VRPN_WAITING;
    c->deadline = now + RETRY_S * SECOND;
}

static void lose_by_errno(gw_vrpn_client *c, int64_t now) {
    const int failed = errno;
    lose(c,
         failed == ECONNREFUSED                            ? GW_SOURCE_REFUSED
         : failed == ETIMEDOUT                             ? GW_SOURCE_NO_ANSWER
         : failed == EHOSTUNREACH || failed == ENETUNREACH ? GW_SOURCE_NO_ROUTE
         : failed == EADDRNOTAVAIL || failed == EACCES     ? GW_SOURCE_NO_ROUTE
                                                           : GW_SOURCE_CLOSED,
         failed == ECONNREFUSED ? "" : strerror(failed), now);
}

/* --- sending; what the server does not take is the end of the connection, for we send next to nothing */

static void say(gw_vrpn_client *c, const uint8_t *bytes, size_t size, int64_t now) {
    if (c->phase != GW_VRPN_GREETING && c->phase != GW_VRPN_SERVED)
        return;
    const ssize_t sent = gw_socket_send(c->stream, bytes, size);
    if (sent < 0)
        lose_by_errno(c, now);
    else if ((size_t)sent < size)
        lose(c, GW_SOURCE_CLOSED, "it does not read", now);
}

static void say_message(gw_vrpn_client *c, int32_t type, int32_t sender, const uint8_t *payload, size_t size,
                        int64_t now) {
    uint8_t bytes[64];
    const gw_vrpn_message message = {
        .type = type, .sender = sender, .time = 0, .payload = payload, .payload_size = size};
    say(c, bytes, gw_vrpn_message_write(&message, bytes, sizeof bytes), now);
}

static void ping(gw_vrpn_client *c, int64_t now) {
    c->last_ping = now;
    if (!c->first_unanswered)
        c->first_unanswered = now;
    say_message(c, PING, OURS, NULL, 0, now);
}

/* What we are, as soon as the greeting was right. */
static void introduce(gw_vrpn_client *c, int64_t now) {
    uint8_t bytes[GW_VRPN_HEADER + 4 + GW_VRPN_NAME + 8], address[16];
    if (c->by_datagram)
        say_message(c, GW_VRPN_UDP_DESCRIPTION, c->datagram_port, address,
                    gw_vrpn_address_write(c->own_address, address), now);
    say(c, bytes,
        gw_vrpn_description_write(GW_VRPN_SENDER_DESCRIPTION, OURS, 0, c->device, bytes, sizeof bytes), now);
    say(c, bytes,
        gw_vrpn_description_write(GW_VRPN_TYPE_DESCRIPTION, PING, 0, GW_VRPN_TYPE_PING, bytes, sizeof bytes),
        now);
    c->first_unanswered = c->ponged = c->warned = 0;
    ping(c, now);
}

/* --- connecting */

static void greet(gw_vrpn_client *c, int64_t now) {
    uint8_t cookie[GW_VRPN_COOKIE];
    gw_vrpn_cookie_write(cookie);
    c->phase = GW_VRPN_GREETING;
    c->deadline = now + GREETING_S * SECOND;
    say(c, cookie, sizeof cookie, now);
}

static void send_call(gw_vrpn_client *c, int64_t now) {
    uint8_t text[32];
    const size_t size = gw_vrpn_callback_write(c->own_address, c->listening_port, text);
    c->deadline = now + CALL_AGAIN_S * SECOND;
    if (gw_socket_send_to(c->datagrams, &c->server, text, size) < 0)
        lose_by_errno(c, now);
}

/* VRPN's other way: the server is to connect to a port of ours. */
static void call(gw_vrpn_client *c, int64_t now) {
    gw_endpoint own = {.port = 0};
    memcpy(own.address, c->base.bind, sizeof own.address);
    c->phase = GW_VRPN_CALLING;
    if (c->base.bind[0])
        memcpy(c->own_address, c->base.bind, sizeof c->own_address);
    else if (gw_socket_own_address(&c->server, c->own_address)) {
        lose_by_errno(c, now);
        return;
    }
    c->listening = gw_socket_listen(&own, &c->listening_port);
    c->datagrams = c->listening < 0 ? -1 : gw_socket_datagrams(&own, NULL, &c->datagram_port);
    if (c->datagrams < 0)
        lose_by_errno(c, now);
    else
        send_call(c, now);
}

static void connect_to_server(gw_vrpn_client *c, int64_t now) {
    snprintf(c->base.status.address, sizeof c->base.status.address, "%s:%u", c->server.address,
             (unsigned)c->server.port);
    if (c->by_datagram) {
        call(c, now);
        return;
    }
    c->phase = GW_VRPN_CONNECTING;
    c->deadline = now + CONNECT_S * SECOND;
    c->stream = gw_socket_connect(&c->server, c->base.bind);
    if (c->stream < 0)
        lose_by_errno(c, now);
}

static void seek(gw_vrpn_client *c, int64_t now) {
    gw_error error = {0};
    if (c->server.address[0]) {
        connect_to_server(c, now);
        return;
    }
    c->phase = GW_VRPN_LOOKING_UP;
    if (gw_host_lookup_start(c->host, &c->lookup, &error))
        lose(c, GW_SOURCE_UNRESOLVED, error.text, now);
}

static void look_up(gw_vrpn_client *c, int64_t now) {
    const char *why = "";
    char address[16];
    const int settled = gw_host_lookup_settled(c->lookup, address, &why);
    if (settled == 0)
        return;
    gw_host_lookup_end(&c->lookup);
    if (settled < 0) {
        lose(c, GW_SOURCE_UNRESOLVED, why, now);
        return;
    }
    memcpy(c->server.address, address, sizeof c->server.address);
    connect_to_server(c, now);
}

static void settle(gw_vrpn_client *c, int64_t now) {
    const int settled = gw_socket_settled(c->stream);
    if (settled > 0) {
        memcpy(c->peer, c->server.address, sizeof c->peer);
        greet(c, now);
    } else if (settled < 0)
        lose_by_errno(c, now);
    else if (now >= c->deadline)
        lose(c, GW_SOURCE_NO_ANSWER, "", now);
}

static void wait_for_call(gw_vrpn_client *c, int64_t now) {
    gw_endpoint from;
    c->stream = gw_socket_accept(c->listening, &from);
    if (c->stream >= 0) {
        gw_socket_close(&c->listening);
        memcpy(c->peer, from.address, sizeof c->peer);
        greet(c, now);
    } else if (now >= c->deadline) {
        stand(c, GW_SOURCE_NO_ANSWER, "");
        send_call(c, now);
    }
}

/* --- what the server says */

static void take_greeting(gw_vrpn_client *c, int64_t now) {
    char version[8];
    snprintf(version, sizeof version, "%.5s", (const char *)c->in + 11);
    for (char *at = version; *at; at++)
        *at = *at >= ' ' && *at < 127 ? *at : '?';
    switch (gw_vrpn_cookie_read(c->in)) {
    case GW_VRPN_SPEAKS:
        break;
    case GW_VRPN_OTHER_VERSION:
        lose(c, GW_SOURCE_OTHER_VERSION, version, now);
        return;
    default:
        lose(c, GW_SOURCE_OTHER_PROTOCOL, "", now);
        return;
    }
    c->phase = GW_VRPN_SERVED;
    c->last_heard = now;
    stand(c, GW_SOURCE_SILENT, "");
    snprintf(c->base.status.version, sizeof c->base.status.version, "%s", version);
    gw_log_write(c->base.log, GW_LOG_INFO, "tracker %s: reached at %s, VRPN %s", c->base.spec,
                 c->base.status.address, version);
    gw_source_emit_link(&c->base, 1, now);
    introduce(c, now);
}

static void take_stream(gw_vrpn_client *c, int64_t now, int64_t arrival) {
    size_t offset = 0;
    gw_vrpn_message message;
    int got = 1;
    if (c->phase == GW_VRPN_GREETING) {
        if (c->in_size < GW_VRPN_COOKIE)
            return;
        take_greeting(c, now);
        offset = GW_VRPN_COOKIE;
    }
    while (c->phase == GW_VRPN_SERVED &&
           (got = gw_vrpn_message_read(c->in, c->in_size, &offset, &message)) > 0) {
        c->base.counters.packets++;
        gw_vrpn_client_take(c, &message, arrival);
    }
    if (got < 0) {
        c->base.counters.malformed++;
        lose(c, GW_SOURCE_CLOSED, "a message of impossible length", now);
    }
    if (c->phase != GW_VRPN_SERVED && c->phase != GW_VRPN_GREETING)
        return;
    memmove(c->in, c->in + offset, c->in_size - offset);
    c->in_size -= offset;
}

static void receive_stream(gw_vrpn_client *c, int64_t now) {
    for (int turn = 0; turn < 64 && (c->phase == GW_VRPN_GREETING || c->phase == GW_VRPN_SERVED); turn++) {
        int64_t arrival;
        const size_t room = sizeof c->in - c->in_size;
        const ssize_t got = gw_socket_receive(c->stream, c->in + c->in_size, room, now, &arrival, NULL);
        if (got == 0)
            lose(c, c->phase == GW_VRPN_GREETING ? GW_SOURCE_NO_GREETING : GW_SOURCE_CLOSED,
                 "the server closed it", now);
        else if (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
            lose_by_errno(c, now);
        if (got <= 0)
            return;
        c->base.counters.bytes += (uint64_t)got;
        c->in_size += (size_t)got;
        c->last_heard = now;
        take_stream(c, now, arrival);
        if ((size_t)got < room)
            return; /* there was no more */
    }
}

static void receive_datagrams(gw_vrpn_client *c, int64_t now) {
    uint8_t bytes[65536];
    for (int turn = 0; turn < 256 && c->phase == GW_VRPN_SERVED && c->datagrams >= 0; turn++) {
        int64_t arrival;
        gw_endpoint from;
        const ssize_t got = gw_socket_receive(c->datagrams, bytes, sizeof bytes, now, &arrival, &from);
        if (got < 0)
            return;
        c->base.counters.bytes += (uint64_t)got;
        if (strcmp(from.address, c->peer) != 0) {
            c->base.counters.unknown++;
            continue;
        }
        c->last_heard = now;
        size_t offset = 0;
        gw_vrpn_message message;
        while (gw_vrpn_message_read(bytes, (size_t)got, &offset, &message) > 0) {
            c->base.counters.packets++;
            gw_vrpn_client_take(c, &message, arrival);
        }
        c->base.counters.malformed += offset < (size_t)got;
    }
}

/* Pings go each second until one is answered, at the start and when nothing comes. A server that answered
 * once and then neither answers nor reports for 10 s is gone, whatever its machine's network says. */
static void keep_healthy(gw_vrpn_client *c, int64_t now) {
    if (c->phase != GW_VRPN_SERVED)
        return;
    const int silent = now - c->last_heard >= SILENT_S * SECOND;
    if ((c->first_unanswered || silent) && now - c->last_ping >= SECOND)
        ping(c, now);
    if (c->phase != GW_VRPN_SERVED || !c->first_unanswered)
        return;
    const int64_t waited = now - c->first_unanswered;
    if (waited >= PONG_LOST_S * SECOND && c->ponged && now - c->last_heard >= PONG_LOST_S * SECOND) {
        lose(c, GW_SOURCE_CLOSED, "no sign of life for 10 s", now);
        return;
    }
    const int due = waited >= PONG_LOST_S * SECOND ? 2 : waited >= PONG_WARN_S * SECOND ? 1 : 0;
    if (due > c->warned) {
        c->warned = due;
        gw_log_write(c->base.log, GW_LOG_WARNING, "tracker %s: the server has not answered a ping for %d s",
                     c->base.spec, due == 2 ? PONG_LOST_S : PONG_WARN_S);
    }
}

/* --- as a source */

static void poll_client(gw_source *source, int64_t now) {
    gw_vrpn_client *c = (gw_vrpn_client *)source;
    if (c->phase == GW_VRPN_WAITING && now >= c->deadline)
        seek(c, now);
    if (c->phase == GW_VRPN_LOOKING_UP)
        look_up(c, now);
    if (c->phase == GW_VRPN_CONNECTING)
        settle(c, now);
    if (c->phase == GW_VRPN_CALLING)
        wait_for_call(c, now);
    receive_stream(c, now);
    receive_datagrams(c, now);
    if (c->phase == GW_VRPN_GREETING && now >= c->deadline)
        lose(c, GW_SOURCE_NO_GREETING, "", now);
    keep_healthy(c, now);
    if (c->phase == GW_VRPN_SERVED && !c->senders_told && !c->sender_known &&
        now - source->status.reached >= SENDER_S * SECOND) {
        c->senders_told = 1;
        gw_log_write(source->log, GW_LOG_WARNING, "tracker %s: the server has no device '%s'; it has: %s",
                     source->spec, c->device, c->senders[0] ? c->senders : "none");
    }
    /* While a connection or a name is on its way it is looked at now and then; when it stands, for the pings.
     */
    c->again = c->phase == GW_VRPN_SERVED                                         ? now + SECOND / 2
               : c->phase == GW_VRPN_LOOKING_UP || c->phase == GW_VRPN_CONNECTING ? now + SECOND / 50
                                                                                  : c->deadline;
}

static int descriptors(const gw_source *source, int *out, int room) {
    const gw_vrpn_client *c = (const gw_vrpn_client *)source;
    const int all[] = {c->phase == GW_VRPN_GREETING || c->phase == GW_VRPN_SERVED ? c->stream : -1,
                       c->listening, c->phase == GW_VRPN_SERVED ? c->datagrams : -1};
    int count = 0;
    for (int i = 0; i < 3; i++)
        if (all[i] >= 0 && count < room)
            out[count++] = all[i];
    return count;
}

static int64_t next(const gw_source *source) {
    return ((const gw_vrpn_client *)source)->again;
}

static void look(const gw_source *source, int64_t now, gw_source_status *out) {
    const gw_vrpn_client *c = (const gw_vrpn_client *)source;
    if (out->standing != GW_SOURCE_SILENT || c->sender_known)
        return;
    if (now - out->reached < SENDER_S * SECOND) {
        out->standing = GW_SOURCE_SEEKS;
        return;
    }
    out->standing = GW_SOURCE_NO_SENDER;
    snprintf(out->detail, sizeof out->detail, "%s", c->senders[0] ? c->senders : "none");
}

static void close_client(gw_source *source) {
    gw_vrpn_client *c = (gw_vrpn_client *)source;
    gw_host_lookup_end(&c->lookup);
    gw_socket_close(&c->stream);
    gw_socket_close(&c->listening);
    gw_socket_close(&c->datagrams);
    free(c);
}

/* NAME@HOST[:PORT], with the "tcp://" that VRPN's own programs have there. */
static gw_code parse(gw_vrpn_client *c, const char *where, gw_error *error) {
    const char *spec = c->base.spec, *at = strchr(where, '@');
    const size_t name = at ? (size_t)(at - where) : 0;
    if (name == 0 || name >= sizeof c->device)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: a VRPN source is NAME@HOST[:PORT], the name of 1 to %d characters", spec,
                       GW_VRPN_NAME - 1);
    memcpy(c->device, where, name);
    const char *host = at + 1;
    host += strncmp(host, "tcp://", 6) == 0 ? 6 : 0;
    const char *colon = strchr(host, ':');
    const size_t length = colon ? (size_t)(colon - host) : strlen(host);
    if (length == 0 || length >= sizeof c->host || strspn(host, "/ ") > 0)
        return gw_fail(error, GW_BAD_INPUT, "%s: no host after the @", spec);
    memcpy(c->host, host, length);
    gw_endpoint port = {.port = GW_VRPN_PORT};
    gw_code code = colon ? gw_endpoint_parse(colon + 1, spec, &port, error) : GW_OK;
    if (!code && (port.port == 0 || port.address[0]))
        code = gw_fail(error, GW_BAD_INPUT, "%s: '%s' is no port, 1 to 65535", spec, colon ? colon + 1 : "");
    c->server.port = port.port;
    if (gw_address_is_numeric(c->host))
        memcpy(c->server.address, c->host, strlen(c->host));
    return code;
}

gw_code gw_vrpn_client_open(const gw_source *like, const char *where, int by_datagram, gw_source **out,
                            gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_vrpn_client), "VRPN client", error);
    if (code)
        return code;
    gw_vrpn_client *c = memory;
    c->base = *like;
    c->by_datagram = by_datagram;
    c->stream = c->listening = c->datagrams = -1;
    c->base.poll = poll_client;
    c->base.descriptors = descriptors;
    c->base.next = next;
    c->base.look = look;
    c->base.close = close_client;
    c->base.status.standing = GW_SOURCE_SEEKS;
    code = parse(c, where, error);
    if (code)
        close_client(&c->base);
    else
        *out = &c->base;
    return code;
}
