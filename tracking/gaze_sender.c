/* Sends gazes as the datagrams of docs/gaze-datagram.md, each at once. */
#include "tracking/server_internal.h"

#include "tracking/gaze_datagram.h"

typedef struct gaze_sender {
    gw_datagram_sender sender;
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
    gw_datagram_sender_send(&s->sender, data, sizeof data);
}

static void poll_sender(gw_server *server, int64_t now) {
    (void)server;
    (void)now;
}

gw_code gw_gaze_sender_open(const gw_endpoint *at, gw_server **out, gw_error *error) {
    gw_code code = gw_datagram_sender_open(sizeof(gaze_sender), at, out, error);
    if (code)
        return code;
    (*out)->takes_gazes = 1;
    (*out)->send = send_event;
    (*out)->poll = poll_sender;
    return GW_OK;
}
