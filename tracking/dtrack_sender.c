/* Sends frames as a DTrack controller does, to one address. All that was given between two polls is one
 * frame. A body that a frame does not list counts as not tracked, one that it repeats as measured anew; but
 * sensors of one recording report at different rates. So a frame waits until every body that was seen in the
 * last LISTED has a new pose: frames come as often as the slowest body reports. */
#include "tracking/server_internal.h"

#include "tracking/dtrack_message.h"

#include <stdlib.h>
#include <string.h>

static const int64_t LISTED = 100000000; /* ns */
static const int64_t DAY = INT64_C(86400) * 1000000000;
enum { TEXT = 16384, BUTTONS = 16 /* the vendor's own readers refuse a Flystick with more */ };

typedef struct dtrack_sender {
    gw_datagram_sender sender;
    int waits;                              /* something was given since the last frame */
    int64_t newest, seen[GW_DTRACK_BODIES]; /* ns since 1970, of the newest event and each body's last pose */
    int fresh[GW_DTRACK_BODIES];            /* it has a pose that no frame had */
    gw_dtrack_frame frame;
    char text[TEXT];
} dtrack_sender;

static void take_pose(dtrack_sender *s, const gw_tracking_event *e, int64_t time) {
    gw_dtrack_pose *body = &s->frame.bodies[e->sensor];
    body->listed = 1;
    body->tracked = e->quality >= 0;
    for (int i = 0; i < 3; i++)
        body->position[i] = e->of.pose.position[i] * s->sender.base.unit;
    memcpy(body->orientation, e->of.pose.orientation, sizeof body->orientation);
    s->seen[e->sensor] = time;
    s->fresh[e->sensor] = 1;
    if (e->sensor >= s->frame.body_count)
        s->frame.body_count = e->sensor + 1;
}

/* Buttons and axes are those of Flystick 0, which stands nowhere. */
static void take_control(dtrack_sender *s, const gw_tracking_event *e) {
    gw_dtrack_flystick *f = &s->frame.flysticks[0];
    s->frame.flystick_count = 1;
    if (e->kind == GW_EVENT_BUTTON) {
        const uint32_t bit = 1u << e->sensor;
        f->button_count = e->sensor >= f->button_count ? e->sensor + 1 : f->button_count;
        f->buttons = e->of.button.pressed ? f->buttons | bit : f->buttons & ~bit;
    } else {
        f->axis_count = e->sensor >= f->axis_count ? e->sensor + 1 : f->axis_count;
        f->axes[e->sensor] = e->of.analog.value;
    }
}

static void send_event(gw_server *server, const gw_tracking_event *e, int64_t time) {
    dtrack_sender *s = (dtrack_sender *)server;
    const int room = e->kind == GW_EVENT_POSE     ? GW_DTRACK_BODIES
                     : e->kind == GW_EVENT_BUTTON ? BUTTONS
                     : e->kind == GW_EVENT_ANALOG ? GW_DTRACK_AXES
                                                  : 0;
    if (e->sensor >= room) {
        server->counters.unsendable++;
        return;
    }
    if (e->kind == GW_EVENT_POSE)
        take_pose(s, e, time);
    else
        take_control(s, e);
    s->newest = time;
    s->waits = 1;
}

static int is_seen(const dtrack_sender *s, int body) {
    return s->frame.bodies[body].listed && llabs(s->newest - s->seen[body]) <= LISTED;
}

static int is_due(const dtrack_sender *s) {
    for (int i = 0; i < s->frame.body_count; i++)
        if (is_seen(s, i) && !s->fresh[i])
            return 0;
    return s->waits;
}

static void poll_sender(gw_server *server, int64_t now) {
    dtrack_sender *s = (dtrack_sender *)server;
    (void)now;
    if (!is_due(s))
        return;
    for (int i = 0; i < s->frame.body_count; i++)
        if (!is_seen(s, i))
            s->frame.bodies[i].tracked = 0;
    memset(s->fresh, 0, sizeof s->fresh);
    s->waits = 0;
    s->frame.frame++;
    s->frame.has_day_time = 1;
    s->frame.day_time = (s->newest % DAY + DAY) % DAY;
    const size_t size = gw_dtrack_write(&s->frame, s->text, sizeof s->text);
    gw_datagram_sender_send(&s->sender, s->text, size);
}

gw_code gw_dtrack_sender_open(const gw_endpoint *at, gw_server **out, gw_error *error) {
    gw_code code = gw_datagram_sender_open(sizeof(dtrack_sender), at, out, error);
    if (code)
        return code;
    (*out)->send = send_event;
    (*out)->poll = poll_sender;
    return GW_OK;
}
