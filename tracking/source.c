#include "tracking/source.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "tracking/quaternion.h"
#include "tracking/source_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double FARTHEST = 1e9;           /* of any unit: no place in a room */
static const int64_t CLOCK_STEP = 1000000000; /* ns */

/* --- making events */

void gw_source_emit(gw_source *source, const gw_tracking_event *event) {
    source->counters.events++;
    if (event->sensor >= 0 && event->sensor < GW_SOURCE_SENSORS &&
        (event->kind == GW_EVENT_POSE || event->kind == GW_EVENT_GAZE)) {
        source->counters.sensors[event->sensor].events++;
        source->counters.sensors[event->sensor].untracked += event->quality < 0;
    }
    if (event->kind != GW_EVENT_LINK && !source->status.first_event)
        source->status.first_event = event->arrival;
    gw_tracking_event sent = *event;
    if (sent.arrival < source->last_arrival) /* stamps of the kernel's other clock are true to microseconds */
        sent.arrival = source->last_arrival;
    source->last_arrival = sent.arrival;
    if (source->sink)
        source->sink(source->sink_context, &sent);
}

void gw_source_emit_link(gw_source *source, int up, int64_t arrival) {
    const gw_tracking_event event = {
        .kind = GW_EVENT_LINK, .arrival = arrival, .device_time = GW_NO_TIME, .quality = 1, .of.link.up = up};
    if (up) {
        source->counters.connections++;
        source->status.reached = arrival;
        source->status.first_event = 0;
    } else
        source->counters.losses++;
    gw_source_emit(source, &event);
}

static int is_pose(gw_tracking_event *event) {
    for (int i = 0; i < 3; i++)
        if (!(fabs(event->of.pose.position[i]) <= FARTHEST))
            return 0;
    for (int i = 0; i < 4; i++)
        if (!(fabs(event->of.pose.orientation[i]) <= FARTHEST))
            return 0;
    return gw_turn_normalise(event->of.pose.orientation);
}

/* Device times of one sensor must rise. */
static gw_source_order order_of(const gw_sensor_newest *newest, const gw_tracking_event *event) {
    const int64_t time = event->device_time;
    if (!newest->known || time == GW_NO_TIME || newest->time == GW_NO_TIME)
        return GW_ORDER_NEWER;
    if (time < newest->time)
        return newest->time - time < CLOCK_STEP ? GW_ORDER_OLDER : GW_ORDER_NEWER;
    if (time == newest->time && memcmp(newest->numbers, &event->of.pose, sizeof newest->numbers) == 0)
        return GW_ORDER_SAME;
    return GW_ORDER_NEWER;
}

void gw_source_emit_pose(gw_source *source, gw_tracking_event *event) {
    _Static_assert(sizeof event->of.pose == sizeof source->newest->numbers, "a pose is seven numbers");
    if (event->sensor < 0 || event->sensor >= GW_SOURCE_SENSORS) {
        source->counters.unknown++;
        return;
    }
    gw_sensor_newest *newest = &source->newest[event->sensor];
    gw_sensor_counters *counters = &source->counters.sensors[event->sensor];
    if (!is_pose(event)) {
        source->counters.not_finite++;
        return;
    }
    const gw_source_order order = order_of(newest, event);
    counters->duplicated += order == GW_ORDER_SAME;
    counters->reordered += order == GW_ORDER_OLDER;
    if (order != GW_ORDER_NEWER)
        return;
    newest->known = 1;
    newest->time = event->device_time;
    memcpy(newest->numbers, &event->of.pose, sizeof newest->numbers);
    gw_source_emit(source, event);
}

gw_source_order gw_source_sequence(gw_source *source, int sensor, uint32_t sequence) {
    gw_sensor_newest *newest = &source->newest[sensor];
    gw_sensor_counters *counters = &source->counters.sensors[sensor];
    const int32_t ahead = (int32_t)(sequence - newest->sequence);
    if (newest->has_sequence && ahead == 0) {
        counters->duplicated++;
        return GW_ORDER_SAME;
    }
    if (newest->has_sequence && ahead < 0 && ahead > -GW_SEQUENCE_JUMP) {
        counters->reordered++;
        return GW_ORDER_OLDER;
    }
    const int jumps = ahead < 0 || ahead > GW_SEQUENCE_JUMP;
    if (newest->has_sequence && jumps)
        counters->jumps++;
    else if (newest->has_sequence)
        counters->lost += (uint32_t)ahead - 1;
    newest->has_sequence = 1;
    newest->sequence = sequence;
    return GW_ORDER_NEWER;
}

/* --- opening */

enum { VRPN, VRPN_DATAGRAMS, DTRACK, GAZE, PATH, MOUSE, NOTHING, FORMS };
static const char *const forms[FORMS] = {"vrpn:", "vrpn+udp:", "dtrack:", "gaze:", "path:", "mouse", "null"};

/* Which form a spec has, and what follows its prefix; FORMS: none. */
static int form_of(const char *spec, const char **rest) {
    for (int form = 0; form < FORMS; form++) {
        const size_t length = strlen(forms[form]);
        const int takes_more = form < MOUSE;
        if (strncmp(spec, forms[form], length) == 0 && (takes_more || !spec[length])) {
            *rest = spec + length;
            return form;
        }
    }
    *rest = spec;
    return strchr(spec, '@') ? VRPN : FORMS;
}

int gw_source_is(const char *spec) {
    const char *rest;
    return form_of(spec, &rest) != FORMS;
}

static void nothing_polled(gw_source *source, int64_t now) {
    (void)source;
    (void)now;
}

static void nothing_closed(gw_source *source) {
    free(source);
}

static gw_code open_nothing(const gw_source *like, gw_source **out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_source), "tracking source", error);
    if (code)
        return code;
    *out = memory;
    **out = *like;
    (*out)->poll = nothing_polled;
    (*out)->close = nothing_closed;
    (*out)->status.standing = GW_SOURCE_SILENT;
    return GW_OK;
}

static gw_code fail_form(const char *spec, gw_error *error) {
    char word[32];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(spec, ":") + 1, spec);
    const char *near = gw_suggest(word, forms, FORMS);
    return gw_fail(
        error, GW_BAD_INPUT,
        "'%s' is neither a file nor a tracking source: NAME@HOST[:PORT], vrpn+udp:NAME@HOST[:PORT], "
        "dtrack:[ADDRESS:]PORT, gaze:[ADDRESS:]PORT, path:FILE, mouse or null%s%s%s",
        spec, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

gw_code gw_source_open(const char *spec, const gw_source_options *options, gw_source **out, gw_error *error) {
    gw_source like = {.log = options ? options->log : NULL};
    const char *bind = options && options->bind ? options->bind : "", *rest;
    *out = NULL;
    if (strlen(spec) >= sizeof like.spec)
        return gw_fail(error, GW_BAD_INPUT, "a tracking source of %zu characters is too long (%zu)",
                       strlen(spec), sizeof like.spec - 1);
    snprintf(like.spec, sizeof like.spec, "%s", spec);
    if (bind[0] && !gw_address_is_numeric(bind))
        return gw_fail(error, GW_BAD_INPUT, "%s: '%s' is no numeric IPv4 address to bind to", spec, bind);
    snprintf(like.bind, sizeof like.bind, "%s", bind);
    switch (form_of(spec, &rest)) {
    case VRPN:
        return gw_vrpn_client_open(&like, rest, 0, out, error);
    case VRPN_DATAGRAMS:
        return gw_vrpn_client_open(&like, rest, 1, out, error);
    case DTRACK:
        return gw_dtrack_source_open(&like, rest, out, error);
    case GAZE:
        return gw_gaze_source_open(&like, rest, out, error);
    case PATH:
        return gw_path_source_open(&like, rest, out, error);
    case MOUSE:
        return gw_mouse_source_open(&like, out, error);
    case NOTHING:
        return open_nothing(&like, out, error);
    default:
        return fail_form(spec, error);
    }
}

void gw_source_close(gw_source **source) {
    if (*source)
        (*source)->close(*source);
    *source = NULL;
}

/* --- using */

void gw_source_poll(gw_source *source, int64_t now, gw_event_sink sink, void *context) {
    source->sink = sink;
    source->sink_context = context;
    source->poll(source, now);
    source->sink = NULL;
}

int gw_source_descriptors(const gw_source *source, int *descriptors, int room) {
    return source->descriptors ? source->descriptors(source, descriptors, room) : 0;
}

int64_t gw_source_next(const gw_source *source) {
    return source->next ? source->next(source) : INT64_MAX;
}

gw_sensor_counters gw_source_sum(const gw_source_counters *counters) {
    gw_sensor_counters sum = {0};
    for (int i = 0; i < GW_SOURCE_SENSORS; i++) {
        const gw_sensor_counters *c = &counters->sensors[i];
        sum.events += c->events;
        sum.lost += c->lost;
        sum.jumps += c->jumps;
        sum.duplicated += c->duplicated;
        sum.reordered += c->reordered;
        sum.untracked += c->untracked;
    }
    return sum;
}

const char *gw_source_name(const gw_source *source) {
    return source->spec;
}

const gw_source_counters *gw_source_count(const gw_source *source) {
    return &source->counters;
}

void gw_source_look(const gw_source *source, int64_t now, gw_source_status *out) {
    *out = source->status;
    if (source->look)
        source->look(source, now, out);
    if (out->standing == GW_SOURCE_SILENT && out->first_event)
        out->standing = GW_SOURCE_REPORTS;
}
