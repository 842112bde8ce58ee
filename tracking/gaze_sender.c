/* Sends gazes as the datagrams of docs/gaze-datagram.md, each at once. */
#include "tracking/server_internal.h"

#include "base/memory.h"
#include "tracking/gaze_datagram.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef struct gaze_sender {
    gw_server base;
    int socket;
    gw_endpoint to;
    uint32_t sequence[GW_SERVER_SENSORS];
} gaze_sender;

static void send_event(gw_server *server, const gw_tracking_event *e, int64_t time) {
    gaze_sender *s = (gaze_sender *)server;
    uint8_t data[GW_GAZE_DATAGRAM];
    if (e->kind != GW_EVENT_GAZE) {
        server->counters.unsendable++;
        return;
    }
    gw_tracking_event stamped = *e;
    const gw_gaze_extra extra = {.sequence = s->sequence[e->sensor]++};
    stamped.device_time = time;
    gw_gaze_datagram_write(&stamped, &extra, server->unit / 1000, data);
    if (gw_socket_send_to(s->socket, &s->to, data, sizeof data) > 0)
        server->counters.messages++;
    else
        server->counters.unreachable++;
}

static void poll_sender(gw_server *server, int64_t now) {
    (void)server;
    (void)now;
}

static void close_sender(gw_server *server) {
    gaze_sender *s = (gaze_sender *)server;
    gw_socket_close(&s->socket);
    free(s);
}

gw_code gw_gaze_sender_open(const gw_endpoint *at, gw_server **out, gw_error *error) {
    const gw_endpoint anywhere = {.port = 0};
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gaze_sender), "gaze sender", error);
    if (code)
        return code;
    gaze_sender *s = memory;
    s->to = *at;
    s->base.port = at->port;
    s->base.takes_gazes = 1;
    s->base.send = send_event;
    s->base.poll = poll_sender;
    s->base.close = close_sender;
    s->socket = gw_socket_datagrams(&anywhere, NULL, NULL);
    if (s->socket < 0) {
        code = gw_fail(error, GW_MACHINE, "no socket for datagrams: %s", strerror(errno));
        close_sender(&s->base);
        return code;
    }
    *out = &s->base;
    return GW_OK;
}
