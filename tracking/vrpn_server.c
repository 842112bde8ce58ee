/* A VRPN server: one device with poses, buttons and axes for up to CLIENTS clients. Both ways to connect are
 * served: by TCP, and by a datagram that asks to be called back. A client that told a port for datagrams gets
 * poses and axes there, all else by TCP. The numbers of senders and types are each side's own. */
#include "tracking/server_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "tracking/vrpn_message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CLIENTS = 16,
    INPUT = GW_VRPN_HEADER + GW_VRPN_PAYLOAD + 8,
    OUTPUT = 1 << 18, /* bytes that may wait for a client: some thousand poses */
    CALL_BACK_MS = 2000,
    GREETING_MS = 5000,
    DEVICE = 0 /* our sender's number */
};

/* Our numbers of the types. */
enum { POSE, BUTTON, BUTTONS, ANALOG, PING, PONG, TYPES };
static const char *const types[TYPES] = {GW_VRPN_TYPE_POSE,   GW_VRPN_TYPE_BUTTON, GW_VRPN_TYPE_BUTTONS,
                                         GW_VRPN_TYPE_ANALOG, GW_VRPN_TYPE_PING,   GW_VRPN_TYPE_PONG};

typedef enum client_state { FREE, CALLING, GREETING, SERVED } client_state;

typedef struct client {
    client_state state;
    int socket;
    gw_endpoint peer, called, datagrams; /* called: as its datagram asked; datagrams: port 0 for none */
    char asked_from[16];                 /* where that datagram came from */
    int64_t deadline;                    /* of calling and greeting */
    size_t in_size, out_begin, out_end, datagram_size;
    /* 1: its number of our device, of ping. */
    uint8_t is_device[GW_VRPN_IDS], is_ping[GW_VRPN_IDS];
    uint8_t in[INPUT], out[OUTPUT], datagram[GW_VRPN_DATAGRAM];
} client;

typedef struct vrpn_server {
    gw_server base;
    int listening, datagrams;
    int32_t sequence;
    int32_t buttons[GW_SERVER_SENSORS];
    double axes[GW_SERVER_SENSORS];
    int button_count, axis_count;
    client *clients[CLIENTS]; /* NULL or owned */
} vrpn_server;

/* --- clients come and go */

static void drop(vrpn_server *s, client *c, const char *why) {
    if (c->state == SERVED) {
        s->base.counters.connected--;
        gw_log_write(s->base.log, GW_LOG_INFO, "VRPN client %s left: %s", c->peer.address, why);
    }
    gw_socket_close(&c->socket);
    c->state = FREE;
}

static client *new_client(vrpn_server *s) {
    for (int i = 0; i < CLIENTS; i++) {
        void *memory = s->clients[i];
        if (memory && s->clients[i]->state != FREE)
            continue;
        if (!memory && gw_allocate(&memory, 1, sizeof(client), "VRPN client", NULL))
            return NULL;
        s->clients[i] = memory;
        memset(s->clients[i], 0, offsetof(client, in));
        s->clients[i]->socket = -1;
        return s->clients[i];
    }
    return NULL;
}

/* --- sending */

static void put_stream(vrpn_server *s, client *c, const uint8_t *bytes, size_t size) {
    if (c->state != SERVED && c->state != GREETING)
        return;
    if (size > OUTPUT - c->out_end && c->out_begin > 0) {
        memmove(c->out, c->out + c->out_begin, c->out_end - c->out_begin);
        c->out_end -= c->out_begin;
        c->out_begin = 0;
    }
    if (size > OUTPUT - c->out_end) {
        s->base.counters.slow++;
        gw_log_write(s->base.log, GW_LOG_WARNING, "VRPN client %s does not read what it is sent",
                     c->peer.address);
        drop(s, c, "too slow");
        return;
    }
    memcpy(c->out + c->out_end, bytes, size);
    c->out_end += size;
}

static void flush(vrpn_server *s, client *c) {
    if (c->datagram_size > 0)
        (void)gw_socket_send_to(s->datagrams, &c->datagrams, c->datagram, c->datagram_size);
    c->datagram_size = 0;
    while (c->out_begin < c->out_end) {
        const ssize_t sent = gw_socket_send(c->socket, c->out + c->out_begin, c->out_end - c->out_begin);
        if (sent < 0)
            drop(s, c, strerror(errno));
        if (sent <= 0)
            return;
        c->out_begin += (size_t)sent;
    }
    c->out_begin = c->out_end = 0;
}

static void put_datagram(vrpn_server *s, client *c, const uint8_t *bytes, size_t size) {
    if (size > sizeof c->datagram - c->datagram_size) {
        (void)gw_socket_send_to(s->datagrams, &c->datagrams, c->datagram, c->datagram_size);
        c->datagram_size = 0;
    }
    if (size <= sizeof c->datagram) {
        memcpy(c->datagram + c->datagram_size, bytes, size);
        c->datagram_size += size;
    }
}

static size_t make_message(vrpn_server *s, int32_t type, int64_t time, const uint8_t *payload, size_t size,
                           uint8_t *bytes, size_t room) {
    const gw_vrpn_message message = {.type = type,
                                     .sender = DEVICE,
                                     .sequence = s->sequence++,
                                     .time = time,
                                     .payload = payload,
                                     .payload_size = size};
    return gw_vrpn_message_write(&message, bytes, room);
}

enum { LONGEST = GW_VRPN_HEADER + 8 + 8 * GW_VRPN_CHANNELS + 8 };

static void send_to_one(vrpn_server *s, client *c, int32_t type, int64_t time, const uint8_t *payload,
                        size_t size) {
    uint8_t bytes[LONGEST];
    put_stream(s, c, bytes, make_message(s, type, time, payload, size, bytes, sizeof bytes));
    s->base.counters.messages++;
}

static void send_to_all(vrpn_server *s, int32_t type, int64_t time, const uint8_t *payload, size_t size) {
    uint8_t bytes[LONGEST];
    const size_t whole = make_message(s, type, time, payload, size, bytes, sizeof bytes);
    const int low_latency = type == POSE || type == ANALOG;
    for (int i = 0; i < CLIENTS; i++) {
        client *c = s->clients[i];
        if (!c || c->state != SERVED)
            continue;
        if (low_latency && c->datagrams.port != 0)
            put_datagram(s, c, bytes, whole);
        else
            put_stream(s, c, bytes, whole);
        s->base.counters.messages++;
    }
}

static void send_pose(vrpn_server *s, const gw_tracking_event *e, int64_t time) {
    uint8_t payload[GW_VRPN_POSE];
    gw_vrpn_pose pose = {.sensor = e->sensor};
    for (int i = 0; i < 3; i++)
        pose.position[i] = e->of.pose.position[i] * (s->base.unit / 1000);
    memcpy(pose.orientation, e->of.pose.orientation, sizeof pose.orientation);
    gw_vrpn_pose_write(&pose, payload);
    send_to_all(s, POSE, time, payload, sizeof payload);
}

/* All axes go together, as VRPN has them. */
static size_t write_axes(const vrpn_server *s, uint8_t *payload) {
    return gw_vrpn_analog_write(s->axes, s->axis_count, payload);
}

static void send_event(gw_server *server, const gw_tracking_event *e, int64_t time) {
    vrpn_server *s = (vrpn_server *)server;
    uint8_t payload[8 + 8 * GW_VRPN_CHANNELS];
    switch (e->kind) {
    case GW_EVENT_POSE:
        if (e->quality >= 0)
            send_pose(s, e, time);
        break;
    case GW_EVENT_BUTTON:
        s->button_count = e->sensor >= s->button_count ? e->sensor + 1 : s->button_count;
        s->buttons[e->sensor] = e->of.button.pressed != 0;
        gw_vrpn_button_write(e->sensor, s->buttons[e->sensor], payload);
        send_to_all(s, BUTTON, time, payload, GW_VRPN_BUTTON);
        break;
    case GW_EVENT_ANALOG:
        s->axis_count = e->sensor >= s->axis_count ? e->sensor + 1 : s->axis_count;
        s->axes[e->sensor] = e->of.analog.value;
        send_to_all(s, ANALOG, time, payload, write_axes(s, payload));
        break;
    default:
        server->counters.unsendable++;
        break;
    }
}

/* --- receiving */

static void welcome(vrpn_server *s, client *c) {
    uint8_t bytes[GW_VRPN_HEADER + 4 + GW_VRPN_NAME + 8], payload[8 + 8 * GW_VRPN_CHANNELS];
    const int64_t time = gw_unix_ns();
    c->state = SERVED;
    s->base.counters.clients++;
    s->base.counters.connected++;
    gw_log_write(s->base.log, GW_LOG_INFO, "VRPN client %s came", c->peer.address);
    put_stream(s, c, bytes,
               gw_vrpn_description_write(GW_VRPN_SENDER_DESCRIPTION, DEVICE, time, s->base.device, bytes,
                                         sizeof bytes));
    for (int i = 0; i < TYPES; i++)
        put_stream(
            s, c, bytes,
            gw_vrpn_description_write(GW_VRPN_TYPE_DESCRIPTION, i, time, types[i], bytes, sizeof bytes));
    if (s->button_count > 0)
        send_to_one(s, c, BUTTONS, time, payload,
                    gw_vrpn_buttons_write(s->buttons, s->button_count, payload));
    if (s->axis_count > 0)
        send_to_one(s, c, ANALOG, time, payload, write_axes(s, payload));
}

static void greet(vrpn_server *s, client *c, const gw_endpoint *peer, int64_t now) {
    uint8_t cookie[GW_VRPN_COOKIE];
    c->peer = *peer;
    c->state = GREETING;
    c->deadline = now + GREETING_MS * INT64_C(1000000);
    gw_vrpn_cookie_write(cookie);
    put_stream(s, c, cookie, sizeof cookie);
}

/* A client's name for the device is another number on every connection, and it may describe others. */
static void take_description(vrpn_server *s, client *c, const gw_vrpn_message *m) {
    const char *name = gw_vrpn_name_read(m->payload, m->payload_size);
    if (!name || m->sender < 0 || m->sender >= GW_VRPN_IDS)
        s->base.counters.malformed++;
    else if (m->type == GW_VRPN_SENDER_DESCRIPTION)
        c->is_device[m->sender] = strcmp(name, s->base.device) == 0;
    else
        c->is_ping[m->sender] = strcmp(name, GW_VRPN_TYPE_PING) == 0;
}

/* Its connection proves its address, which its text may have wrong where it has several: only the port is
 * taken from that. */
static void take_datagram_port(vrpn_server *s, client *c, const gw_vrpn_message *m) {
    char address[16];
    if (m->sender < 1 || m->sender > UINT16_MAX ||
        !gw_vrpn_address_read(m->payload, m->payload_size, address)) {
        s->base.counters.malformed++;
        return;
    }
    c->datagrams = c->peer;
    c->datagrams.port = (uint16_t)m->sender;
}

static void take_message(vrpn_server *s, client *c, const gw_vrpn_message *m) {
    if (m->type == GW_VRPN_SENDER_DESCRIPTION || m->type == GW_VRPN_TYPE_DESCRIPTION)
        take_description(s, c, m);
    else if (m->type == GW_VRPN_UDP_DESCRIPTION)
        take_datagram_port(s, c, m);
    else if (m->type >= GW_VRPN_IDS || m->type < GW_VRPN_DISCONNECT || m->sender < 0 ||
             m->sender >= GW_VRPN_IDS)
        s->base.counters.malformed++;
    else if (m->type >= 0 && c->is_ping[m->type] && c->is_device[m->sender]) {
        send_to_one(s, c, PONG, gw_unix_ns(), NULL, 0);
        s->base.counters.pings++;
    } else
        s->base.counters.ignored++;
}

static void take_greeting(vrpn_server *s, client *c) {
    if (gw_vrpn_cookie_read(c->in) == GW_VRPN_SPEAKS) {
        welcome(s, c);
        return;
    }
    s->base.counters.refused++;
    gw_log_write(s->base.log, GW_LOG_WARNING, "%s came to the VRPN port and speaks no VRPN 07",
                 c->peer.address);
    drop(s, c, "another protocol");
}

/* What has come as far as it is whole. */
static void take_input(vrpn_server *s, client *c) {
    size_t offset = 0;
    if (c->state == GREETING) {
        if (c->in_size < GW_VRPN_COOKIE)
            return;
        take_greeting(s, c);
        offset = GW_VRPN_COOKIE;
    }
    gw_vrpn_message message;
    int got = 1;
    while (c->state == SERVED && (got = gw_vrpn_message_read(c->in, c->in_size, &offset, &message)) > 0)
        take_message(s, c, &message);
    if (got < 0) {
        s->base.counters.malformed++;
        drop(s, c, "a message of impossible length");
    }
    if (c->state == FREE)
        return;
    memmove(c->in, c->in + offset, c->in_size - offset);
    c->in_size -= offset;
}

static void receive(vrpn_server *s, client *c, int64_t now) {
    for (int turn = 0; turn < 16 && (c->state == GREETING || c->state == SERVED); turn++) {
        const ssize_t got =
            gw_socket_receive(c->socket, c->in + c->in_size, sizeof c->in - c->in_size, now, NULL, NULL);
        if (got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
            drop(s, c, got ? strerror(errno) : "it closed the connection");
            return;
        }
        if (got < 0)
            return;
        c->in_size += (size_t)got;
        take_input(s, c);
    }
}

/* --- the two ways to connect */

static void accept_clients(vrpn_server *s, int64_t now) {
    gw_endpoint from;
    for (int made; (made = gw_socket_accept(s->listening, &from)) >= 0;) {
        client *c = new_client(s);
        if (!c) {
            s->base.counters.refused++;
            gw_socket_close(&made);
            continue;
        }
        c->socket = made;
        greet(s, c, &from, now);
    }
}

static void call(vrpn_server *s, client *c, const char *address, int64_t now) {
    c->peer = c->called;
    snprintf(c->peer.address, sizeof c->peer.address, "%s", address);
    c->state = CALLING;
    c->deadline = now + CALL_BACK_MS * INT64_C(1000000);
    c->socket = gw_socket_connect(&c->peer, NULL);
    if (c->socket < 0) {
        s->base.counters.unreachable++;
        drop(s, c, "unreachable");
    }
}

/* A client repeats its datagram until it is called, so one that is being served is not called twice. */
static int is_known(const vrpn_server *s, const gw_endpoint *called) {
    for (int i = 0; i < CLIENTS; i++)
        if (s->clients[i] && s->clients[i]->state != FREE &&
            gw_endpoint_equal(&s->clients[i]->called, called))
            return 1;
    return 0;
}

static void take_calls(vrpn_server *s, int64_t now) {
    uint8_t data[GW_VRPN_DATAGRAM];
    for (int turn = 0; turn < 64; turn++) {
        gw_endpoint from, called;
        const ssize_t got = gw_socket_receive(s->datagrams, data, sizeof data, now, NULL, &from);
        if (got < 0)
            return;
        if ((size_t)got > sizeof data ||
            !gw_vrpn_callback_read(data, (size_t)got, called.address, &called.port)) {
            s->base.counters.malformed++;
            continue;
        }
        if (is_known(s, &called))
            continue;
        client *c = new_client(s);
        if (!c) {
            s->base.counters.refused++;
            continue;
        }
        c->called = called;
        memcpy(c->asked_from, from.address, sizeof c->asked_from);
        call(s, c, called.address, now);
    }
}

/* A client with several addresses may have named one that does not lead to it: then the one that its datagram
 * came from is tried. */
static void settle(vrpn_server *s, client *c, int64_t now) {
    const int settled = gw_socket_settled(c->socket);
    if (settled > 0) {
        const gw_endpoint peer = c->peer;
        greet(s, c, &peer, now);
    } else if (settled < 0 || now >= c->deadline) {
        gw_socket_close(&c->socket);
        if (strcmp(c->peer.address, c->asked_from) != 0) {
            call(s, c, c->asked_from, now);
            return;
        }
        s->base.counters.unreachable++;
        gw_log_write(s->base.log, GW_LOG_INFO, "VRPN client %s port %u asked to be called, but is not there",
                     c->called.address, (unsigned)c->called.port);
        drop(s, c, "unreachable");
    }
}

static void poll_server(gw_server *server, int64_t now) {
    vrpn_server *s = (vrpn_server *)server;
    accept_clients(s, now);
    take_calls(s, now);
    for (int i = 0; i < CLIENTS; i++) {
        client *c = s->clients[i];
        if (!c)
            continue;
        if (c->state == CALLING)
            settle(s, c, now);
        receive(s, c, now);
        if (c->state == GREETING && now >= c->deadline) {
            server->counters.refused++;
            drop(s, c, "no greeting");
        }
        if (c->state == GREETING || c->state == SERVED)
            flush(s, c);
    }
}

static int descriptors(const gw_server *server, int *out, int room) {
    const vrpn_server *s = (const vrpn_server *)server;
    int count = 0;
    const int own[] = {s->listening, s->datagrams};
    for (int i = 0; i < 2 && count < room; i++)
        out[count++] = own[i];
    for (int i = 0; i < CLIENTS && count < room; i++)
        if (s->clients[i] && (s->clients[i]->state == GREETING || s->clients[i]->state == SERVED))
            out[count++] = s->clients[i]->socket;
    return count;
}

static void close_server(gw_server *server) {
    vrpn_server *s = (vrpn_server *)server;
    for (int i = 0; i < CLIENTS; i++) {
        if (s->clients[i])
            gw_socket_close(&s->clients[i]->socket);
        free(s->clients[i]);
    }
    gw_socket_close(&s->listening);
    gw_socket_close(&s->datagrams);
    free(s);
}

/* One number for both ports; where any will do, one that is free for both. */
static int open_ports(vrpn_server *s, const gw_endpoint *at) {
    for (int turn = 0; turn < 16; turn++) {
        gw_endpoint same = *at;
        s->listening = gw_socket_listen(at, &s->base.port);
        if (s->listening < 0)
            return -1;
        same.port = s->base.port;
        s->datagrams = gw_socket_datagrams(&same, NULL, NULL);
        if (s->datagrams >= 0)
            return 0;
        const int failed = errno;
        gw_socket_close(&s->listening);
        errno = failed;
        if (at->port != 0 || failed != EADDRINUSE)
            return -1;
    }
    return -1;
}

gw_code gw_vrpn_server_open(const gw_endpoint *at, gw_server **out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(vrpn_server), "VRPN server", error);
    if (code)
        return code;
    vrpn_server *s = memory;
    s->listening = s->datagrams = -1;
    s->base.send = send_event;
    s->base.poll = poll_server;
    s->base.descriptors = descriptors;
    s->base.close = close_server;
    if (open_ports(s, at)) {
        code = gw_fail(error, GW_MACHINE, "port %u cannot be listened to: %s%s", (unsigned)at->port,
                       strerror(errno), errno == EADDRINUSE ? "; take another port, or end its user" : "");
        close_server(&s->base);
        return code;
    }
    *out = &s->base;
    return GW_OK;
}
