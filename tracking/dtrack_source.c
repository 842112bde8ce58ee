/* Listens to DTrack's datagrams. Bodies are sensors by their id; Flysticks follow, after the calibrated
 * bodies. A body that a frame does not list is not tracked, which is an event as long as it was listed once.
 * Buttons of Flystick f are 8 f and on, its axes 2 f and on; they are told when they change. Positions are
 * millimetres. Where a controller is named, the short datagram that opens firewalls goes to it. */
#include "tracking/source_internal.h"

#include "base/clock.h"
#include "tracking/dtrack_message.h"

#include <string.h>

enum { FLYSTICK_BUTTONS = 8, FLYSTICK_AXES = 2, CONTROLLER_PORT = 50107 };
static const int64_t OPENING = 10000000000; /* ns from one such datagram to the next */
static const char opener[] = "fw4dtsdkc";

typedef struct dtrack_source {
    gw_datagram_source base;
    int64_t opened; /* ns: the last opener */
    int has_frame;
    uint32_t frame, step; /* step: how far the counter usually moves, of a divided rate */
    int bodies;           /* sensors before the Flysticks: never fewer than before */
    uint8_t seen[GW_DTRACK_BODIES + GW_DTRACK_FLYSTICKS];
    uint32_t buttons[GW_DTRACK_FLYSTICKS];
    double axes[GW_DTRACK_FLYSTICKS][FLYSTICK_AXES];
    gw_dtrack_frame parsed;
    uint8_t bytes[GW_DTRACK_DATAGRAM];
} dtrack_source;

enum {
    SENSORS = GW_SOURCE_SENSORS < GW_DTRACK_BODIES + GW_DTRACK_FLYSTICKS
                  ? GW_SOURCE_SENSORS
                  : GW_DTRACK_BODIES + GW_DTRACK_FLYSTICKS
};

/* The counter of frames is that of all sensors. 0: this frame is to be passed over. */
static int is_newer(dtrack_source *s) {
    const int32_t ahead = (int32_t)(s->parsed.frame - s->frame);
    if (!s->parsed.has_frame)
        return 1;
    const int known = s->has_frame, anew = !known || ahead <= -GW_SEQUENCE_JUMP;
    if (anew) {
        s->has_frame = 1;
        s->step = 0;
    } else if (ahead > 0 && (s->step == 0 || (uint32_t)ahead < s->step)) {
        s->step = (uint32_t)ahead;
    }
    const uint32_t steps = !anew && ahead > 0 ? (uint32_t)ahead / s->step : 1;
    const int jumps = known && (anew || steps > GW_SEQUENCE_JUMP);
    for (int i = 0; i < SENSORS; i++) {
        gw_sensor_counters *counters = &s->base.base.counters.sensors[i];
        if (!s->seen[i])
            continue;
        counters->jumps += (uint64_t)jumps;
        counters->lost += jumps ? 0 : steps - 1;
        counters->duplicated += !anew && ahead == 0;
        counters->reordered += !anew && ahead < 0;
    }
    if (anew || ahead > 0)
        s->frame = s->parsed.frame;
    return anew || ahead > 0;
}

static void emit_pose(dtrack_source *s, int sensor, const gw_dtrack_pose *pose, gw_tracking_event *event) {
    if (sensor >= GW_SOURCE_SENSORS) {
        s->base.base.counters.unknown += pose->listed != 0;
        return;
    }
    if (!pose->tracked && !s->seen[sensor])
        return;
    s->seen[sensor] = 1;
    event->kind = GW_EVENT_POSE;
    event->sensor = sensor;
    event->quality = pose->tracked ? 1 : -1;
    memset(&event->of, 0, sizeof event->of);
    event->of.pose.orientation[3] = 1;
    if (pose->tracked) {
        memcpy(event->of.pose.position, pose->position, sizeof pose->position);
        memcpy(event->of.pose.orientation, pose->orientation, sizeof pose->orientation);
    }
    gw_source_emit_pose(&s->base.base, event);
}

static void emit_controls(dtrack_source *s, int number, gw_tracking_event *event) {
    const gw_dtrack_flystick *f = &s->parsed.flysticks[number];
    event->quality = 1;
    for (int i = 0; i < f->button_count && i < FLYSTICK_BUTTONS; i++) {
        const uint32_t bit = 1u << i;
        if (!((f->buttons ^ s->buttons[number]) & bit))
            continue;
        event->kind = GW_EVENT_BUTTON;
        event->sensor = FLYSTICK_BUTTONS * number + i;
        memset(&event->of, 0, sizeof event->of);
        event->of.button.pressed = (f->buttons & bit) != 0;
        gw_source_emit(&s->base.base, event);
    }
    s->buttons[number] = f->buttons;
    for (int i = 0; i < f->axis_count && i < FLYSTICK_AXES; i++) {
        if (f->axes[i] == s->axes[number][i])
            continue;
        s->axes[number][i] = f->axes[i];
        event->kind = GW_EVENT_ANALOG;
        event->sensor = FLYSTICK_AXES * number + i;
        memset(&event->of, 0, sizeof event->of);
        event->of.analog.value = f->axes[i];
        gw_source_emit(&s->base.base, event);
    }
}

static void emit_frame(dtrack_source *s, int64_t arrival) {
    const gw_dtrack_frame *f = &s->parsed;
    gw_tracking_event event = {.arrival = arrival, .device_time = GW_NO_TIME, .latency = f->latency};
    if (f->has_unix_time)
        event.device_time = f->unix_time;
    else if (f->has_day_time)
        event.device_time = gw_dtrack_unix_time(f->day_time, gw_unix_ns());
    const int bodies = f->calibrated > f->body_count ? f->calibrated : f->body_count;
    if (bodies > s->bodies) { /* the Flysticks move on */
        const int before = s->bodies < SENSORS ? s->bodies : SENSORS;
        memset(s->seen + before, 0, sizeof s->seen - (size_t)before);
        s->bodies = bodies;
    }
    for (int i = 0; f->has_bodies && i < s->bodies && i < GW_DTRACK_BODIES; i++)
        emit_pose(s, i, &f->bodies[i], &event);
    for (int i = 0; i < f->flystick_count; i++) {
        if (!f->flysticks[i].pose.listed)
            continue;
        emit_pose(s, s->bodies + i, &f->flysticks[i].pose, &event);
        emit_controls(s, i, &event);
    }
}

static void take(dtrack_source *s, size_t size, int64_t arrival) {
    gw_source *source = &s->base.base;
    if (size > sizeof s->bytes) {
        source->counters.malformed++;
        return;
    }
    const int understood = gw_dtrack_read(s->bytes, size, &s->parsed);
    source->counters.malformed += s->parsed.malformed;
    source->counters.not_finite += s->parsed.not_finite;
    source->counters.unknown += s->parsed.lines_unknown;
    if (!understood) {
        source->counters.malformed += !s->parsed.malformed;
        if (source->counters.connections == source->counters.losses)
            source->status.standing = GW_SOURCE_OTHER_PROTOCOL;
        return;
    }
    if (source->counters.connections == source->counters.losses) {
        gw_source_emit_link(source, 1, arrival);
        source->status.standing = GW_SOURCE_SILENT;
        s->has_frame = 0;
    }
    s->base.last = arrival;
    if (is_newer(s))
        emit_frame(s, arrival);
}

static void poll_source(gw_source *source, int64_t now) {
    dtrack_source *s = (dtrack_source *)source;
    ptrdiff_t got;
    int64_t arrival;
    if (s->base.only.address[0] && (!s->opened || now - s->opened >= OPENING)) {
        gw_endpoint controller = s->base.only;
        controller.port = CONTROLLER_PORT;
        s->opened = now;
        (void)gw_socket_send_to(s->base.socket, &controller, opener, sizeof opener);
    }
    for (int turn = 0; turn < 256; turn++) {
        got = gw_datagram_source_next(&s->base, s->bytes, sizeof s->bytes, now, &arrival);
        if (got < 0)
            break;
        take(s, (size_t)got, arrival);
    }
    gw_datagram_source_watch(&s->base, now);
}

static int64_t next(const gw_source *source) {
    const dtrack_source *s = (const dtrack_source *)source;
    const int64_t watch = gw_datagram_source_wakes(source);
    const int64_t open = s->base.only.address[0] ? s->opened + OPENING : INT64_MAX;
    return watch < open ? watch : open;
}

gw_code gw_dtrack_source_open(const gw_source *like, const char *where, gw_source **out, gw_error *error) {
    gw_datagram_source *made;
    gw_code code = gw_datagram_source_open(like, where, sizeof(dtrack_source), "DTrack listener", poll_source,
                                           &made, error);
    if (code)
        return code;
    made->base.next = next;
    *out = &made->base;
    return GW_OK;
}
