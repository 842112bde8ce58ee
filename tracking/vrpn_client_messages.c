#include "tracking/vrpn_client_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a type of the server's is to us. */
typedef enum meaning { UNDESCRIBED, OTHER, POSE, BUTTON, BUTTON_STATES, AXES, TEXT, PONG } meaning;

static void note_sender(gw_vrpn_client *c, const char *name) {
    const size_t used = strlen(c->senders);
    if (strstr(c->senders, name))
        return;
    if (used + strlen(name) + 3 < sizeof c->senders)
        snprintf(c->senders + used, sizeof c->senders - used, "%s%s", used ? ", " : "", name);
}

static meaning meaning_of(const char *type) {
    static const struct {
        const char *type;
        meaning meaning;
    } rows[] = {
        {GW_VRPN_TYPE_POSE, POSE},   {GW_VRPN_TYPE_BUTTON, BUTTON}, {GW_VRPN_TYPE_BUTTONS, BUTTON_STATES},
        {GW_VRPN_TYPE_ANALOG, AXES}, {GW_VRPN_TYPE_TEXT, TEXT},     {GW_VRPN_TYPE_PONG, PONG}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (strcmp(type, rows[i].type) == 0)
            return rows[i].meaning;
    return OTHER;
}

static void take_description(gw_vrpn_client *c, const gw_vrpn_message *m) {
    const char *name = gw_vrpn_name_read(m->payload, m->payload_size);
    if (!name || m->sender < 0 || m->sender >= GW_VRPN_IDS) {
        c->base.counters.malformed++;
    } else if (m->type == GW_VRPN_TYPE_DESCRIPTION) {
        c->types[m->sender] = (uint8_t)meaning_of(name);
    } else {
        c->is_ours[m->sender] = strcmp(name, c->device) == 0;
        c->sender_known |= c->is_ours[m->sender];
        note_sender(c, name);
    }
}

static void take_pose(gw_vrpn_client *c, const gw_vrpn_message *m, gw_tracking_event *event) {
    gw_vrpn_pose pose;
    if (!gw_vrpn_pose_read(m->payload, m->payload_size, &pose)) {
        c->base.counters.malformed++;
        return;
    }
    event->kind = GW_EVENT_POSE;
    event->sensor = pose.sensor;
    memcpy(event->of.pose.position, pose.position, sizeof pose.position);
    memcpy(event->of.pose.orientation, pose.orientation, sizeof pose.orientation);
    gw_source_emit_pose(&c->base, event);
}

static void take_button(gw_vrpn_client *c, int32_t button, int32_t state, gw_tracking_event *event) {
    if (button < 0 || button >= GW_VRPN_CLIENT_BUTTONS) {
        c->base.counters.unknown++;
        return;
    }
    c->pressed[button] = state != 0;
    event->kind = GW_EVENT_BUTTON;
    event->sensor = button;
    event->of.button.pressed = state != 0;
    gw_source_emit(&c->base, event);
}

/* On connecting a server tells all of them: what differs is an event. */
static void take_buttons(gw_vrpn_client *c, const gw_vrpn_message *m, gw_tracking_event *event) {
    int32_t states[GW_VRPN_CHANNELS];
    const int count = gw_vrpn_buttons_read(m->payload, m->payload_size, states);
    c->base.counters.malformed += count < 0;
    for (int i = 0; i < count; i++)
        if (c->pressed[i] != (states[i] != 0))
            take_button(c, i, states[i], event);
}

/* Servers send all axes when one moves: what differs is an event. */
static void take_axes(gw_vrpn_client *c, const gw_vrpn_message *m, gw_tracking_event *event) {
    double values[GW_VRPN_CHANNELS];
    const int count = gw_vrpn_analog_read(m->payload, m->payload_size, values);
    c->base.counters.malformed += count < 0;
    for (int i = 0; i < count; i++) {
        if (i < c->axis_count && values[i] == c->axes[i])
            continue;
        if (!(fabs(values[i]) <= 1e9)) {
            c->base.counters.not_finite++;
            continue;
        }
        c->axes[i] = values[i];
        event->kind = GW_EVENT_ANALOG;
        event->sensor = i;
        event->of.analog.value = values[i];
        gw_source_emit(&c->base, event);
    }
    c->axis_count = count > c->axis_count ? count : c->axis_count;
}

static void take_text(gw_vrpn_client *c, const gw_vrpn_message *m) {
    uint32_t severity;
    char text[256];
    if (!gw_vrpn_text_read(m->payload, m->payload_size, &severity, text)) {
        c->base.counters.malformed++;
        return;
    }
    gw_log_write(c->base.log, severity ? GW_LOG_WARNING : GW_LOG_INFO, "tracker %s says: %s", c->base.spec,
                 text);
}

static void take_pong(gw_vrpn_client *c) {
    if (c->warned)
        gw_log_write(c->base.log, GW_LOG_INFO, "tracker %s answers pings again", c->base.spec);
    c->ponged = 1;
    c->first_unanswered = c->warned = 0;
}

void gw_vrpn_client_take(gw_vrpn_client *c, const gw_vrpn_message *m, int64_t arrival) {
    gw_tracking_event event = {
        .arrival = arrival, .device_time = m->time > 0 ? m->time : GW_NO_TIME, .quality = 1};
    if (m->type == GW_VRPN_SENDER_DESCRIPTION || m->type == GW_VRPN_TYPE_DESCRIPTION) {
        take_description(c, m);
        return;
    }
    if (m->type < 0 || m->type >= GW_VRPN_IDS || m->sender < 0 || m->sender >= GW_VRPN_IDS) {
        /* Where it would have datagrams and which logs it keeps is nothing to us. */
        c->base.counters.malformed += m->type < GW_VRPN_DISCONNECT || m->type >= GW_VRPN_IDS || m->type >= 0;
        return;
    }
    if (!c->is_ours[m->sender] || c->types[m->type] <= OTHER) {
        c->base.counters.unknown++;
        return;
    }
    switch ((meaning)c->types[m->type]) {
    case POSE:
        take_pose(c, m, &event);
        break;
    case BUTTON: {
        int32_t button, state;
        if (gw_vrpn_button_read(m->payload, m->payload_size, &button, &state))
            take_button(c, button, state, &event);
        else
            c->base.counters.malformed++;
        break;
    }
    case BUTTON_STATES:
        take_buttons(c, m, &event);
        break;
    case AXES:
        take_axes(c, m, &event);
        break;
    case TEXT:
        take_text(c, m);
        break;
    case PONG:
        take_pong(c);
        break;
    default:
        break;
    }
}
