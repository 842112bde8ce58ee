/* Reading recordings from VRPN logs (reference implementation 07.38; records as docs/tracks.md lists them).
 */
#include "base/memory.h"
#include "tracking/big_endian.h"
#include "tracking/recording_builder.h"
#include "tracking/recording_format.h"
#include "tracking/vrpn_message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAJOR_OLDEST = 4, MAJOR_NEWEST = 7 };

/* A record as it stands in the file. */
typedef struct record {
    int32_t type, sender;
    int64_t time; /* ns since 1970 */
    const uint8_t *payload;
    size_t size;
} record;

/* The clocks of the event that comes next. */
typedef struct stamp {
    int given;
    int32_t sender;
    int64_t time, device_time, latency; /* ns */
    double quality;
} stamp;

typedef struct reader {
    gw_recording_builder *builder;
    gw_recording_counters *counters;
    gw_log_type types[GW_LOG_IDS];
    int32_t senders[GW_LOG_IDS]; /* number in the recording + 1; 0: not described */
    stamp stamp;
    int end_promised, ended; /* the mark of a recording's end: it was to come, it came */
} reader;

/* "vrpn: ver. 07.38": peers compare up to the last dot, which is the major version. */
static int is_cookie(const uint8_t *bytes, size_t size) {
    static const char prefix[] = "vrpn: ver. ";
    const size_t digits = sizeof prefix - 1;
    if (size < GW_LOG_COOKIE || memcmp(bytes, prefix, digits) != 0)
        return 0;
    const uint8_t *version = bytes + digits;
    if (version[0] < '0' || version[0] > '9' || version[1] < '0' || version[1] > '9' || version[2] != '.')
        return 0;
    int major = (version[0] - '0') * 10 + (version[1] - '0');
    return major >= MAJOR_OLDEST && major <= MAJOR_NEWEST;
}

/* The name in a description of an id that may be, or NULL. */
static const char *described_name(const record *r) {
    const int known = r->sender >= 0 && r->sender < GW_LOG_IDS;
    return known ? gw_vrpn_name_read(r->payload, r->size) : NULL;
}

static gw_log_type type_named(const char *name) {
    for (int type = 0; type < GW_LOG_TYPES; type++)
        if (gw_log_type_names[type] != NULL && strcmp(gw_log_type_names[type], name) == 0)
            return (gw_log_type)type;
    return GW_LOG_OTHER;
}

static gw_code read_system_record(reader *reading, const record *r, gw_error *error) {
    if (r->type < -5) {
        reading->counters->unknown_type++;
        return GW_OK;
    }
    if (r->type >= -2) {
        const char *name = described_name(r);
        int32_t number = 0;
        if (name != NULL && r->type == -1)
            number = gw_builder_sender(reading->builder, name, error);
        if (number == -2)
            return GW_MACHINE;
        if (name == NULL || number < 0) {
            reading->counters->bad_payload++;
            return GW_OK;
        }
        if (r->type == -1)
            reading->senders[r->sender] = number + 1;
        else
            reading->end_promised |= (reading->types[r->sender] = type_named(name)) == GW_LOG_END;
    }
    reading->counters->descriptions++;
    return GW_OK;
}

static int64_t get_int64(const uint8_t *bytes) {
    return (int64_t)((uint64_t)(uint32_t)gw_get_int32(bytes) << 32 | (uint32_t)gw_get_int32(bytes + 4));
}

static void read_stamp(reader *reading, const record *r) {
    const int64_t slack = 1000000; /* ns: times of records are cut to microseconds */
    stamp next = {.given = 1, .sender = r->sender};
    int good = r->size == GW_STAMP_SIZE;
    if (good) {
        next.time = get_int64(r->payload);
        next.device_time = get_int64(r->payload + 8);
        next.latency = get_int64(r->payload + 16);
        next.quality = gw_get_double(r->payload + 24);
        good = next.time >= r->time - slack && next.time <= r->time + slack &&
               gw_clocks_are_good(next.device_time, next.latency, next.quality);
    }
    if (good) {
        reading->counters->stamps++;
        reading->stamp = next;
    } else {
        reading->counters->bad_payload++;
    }
}

/* Appends an event with its clocks: those of the stamp before it, or what the record says of them. */
static gw_code put(reader *reading, const record *r, const stamp *clocks, gw_tracking_event *event,
                   gw_error *error) {
    event->device_time = clocks->device_time;
    event->latency = clocks->latency;
    event->quality = clocks->quality;
    if (event->sensor < 0) {
        reading->counters->bad_sensor++;
    } else if (!gw_event_settle(event)) {
        reading->counters->not_finite++;
    } else {
        reading->counters->used++;
        return gw_builder_event(reading->builder, (uint32_t)reading->senders[r->sender] - 1, clocks->time,
                                event, error);
    }
    return GW_OK;
}

/* Buttons and analogs of one record; they count as one record. */
static gw_code put_several(reader *reading, const record *r, const stamp *clocks, gw_log_type type,
                           gw_error *error) {
    const int buttons = type == GW_LOG_BUTTONS;
    const double wanted = r->size >= 8 && !buttons ? gw_get_double(r->payload)
                          : r->size >= 4           ? gw_get_int32(r->payload)
                                                   : -1;
    const int limit = buttons ? GW_BUTTON_LIMIT : GW_ANALOG_LIMIT;
    const size_t unit = buttons ? 4 : 8;
    if (!(wanted >= 0 && wanted <= limit && wanted == floor(wanted)) ||
        r->size != unit * (1 + (size_t)wanted)) {
        reading->counters->bad_payload++;
        return GW_OK;
    }
    const int count = (int)wanted;
    for (int i = 0; i < count && !buttons; i++)
        if (!isfinite(gw_get_double(r->payload + 8 + 8 * i))) {
            reading->counters->not_finite++;
            return GW_OK;
        }
    gw_code code = GW_OK;
    const uint64_t used = reading->counters->used;
    for (int i = 0; i < count && code == GW_OK; i++) {
        gw_tracking_event event = {.kind = buttons ? GW_EVENT_BUTTON : GW_EVENT_ANALOG, .sensor = i};
        if (buttons)
            event.of.button.pressed = gw_get_int32(r->payload + 4 + 4 * i) != 0;
        else
            event.of.analog.value = gw_get_double(r->payload + 8 + 8 * i);
        code = put(reading, r, clocks, &event, error);
    }
    reading->counters->used = used + 1;
    return code;
}

static void get_doubles(const uint8_t *bytes, int count, double *out) {
    for (int i = 0; i < count; i++)
        out[i] = gw_get_double(bytes + 8 * i);
}

/* A gaze: int32 viewer, int32 flags, origin, direction, openness. */
static void read_gaze(const uint8_t *payload, gw_tracking_event *event) {
    const int32_t flags = gw_get_int32(payload + 4);
    event->kind = GW_EVENT_GAZE;
    event->of.gaze.frame = flags & GW_GAZE_FLAG_HEAD ? GW_GAZE_IN_HEAD : GW_GAZE_IN_DEVICE;
    event->of.gaze.has_origin = (flags & GW_GAZE_FLAG_ORIGIN) != 0;
    get_doubles(payload + 8, 3, event->of.gaze.origin);
    get_doubles(payload + 32, 3, event->of.gaze.direction);
    event->of.gaze.openness = gw_get_double(payload + 56);
}

static gw_code read_event(reader *reading, const record *r, const stamp *clocks, gw_log_type type,
                          gw_error *error) {
    static const size_t sizes[GW_LOG_TYPES] = {[GW_LOG_POSE] = GW_POSE_SIZE,
                                               [GW_LOG_BUTTON] = GW_BUTTON_SIZE,
                                               [GW_LOG_GAZE] = GW_GAZE_SIZE,
                                               [GW_LOG_LINK] = GW_LINK_SIZE,
                                               [GW_LOG_UNTRACKED] = GW_UNTRACKED_SIZE};
    if (type == GW_LOG_BUTTONS || type == GW_LOG_ANALOGS)
        return put_several(reading, r, clocks, type, error);
    if (r->size != sizes[type] || (type == GW_LOG_UNTRACKED && !(clocks->quality < 0.0))) {
        reading->counters->bad_payload++;
        return GW_OK;
    }
    gw_tracking_event event = {.kind = GW_EVENT_POSE, .sensor = gw_get_int32(r->payload)};
    if (type == GW_LOG_POSE) { /* the four bytes after the sensor are padding */
        get_doubles(r->payload + 8, 3, event.of.pose.position);
        get_doubles(r->payload + 32, 4, event.of.pose.orientation);
    } else if (type == GW_LOG_BUTTON) {
        event.kind = GW_EVENT_BUTTON;
        event.of.button.pressed = gw_get_int32(r->payload + 4) != 0;
    } else if (type == GW_LOG_GAZE) {
        read_gaze(r->payload, &event);
    } else if (type == GW_LOG_LINK) {
        event.kind = GW_EVENT_LINK;
        event.of.link.up = event.sensor != 0;
        event.sensor = 0;
    }
    return put(reading, r, clocks, &event, error);
}

static gw_code read_text(reader *reading, const record *r, gw_error *error) {
    if (r->size != GW_TEXT_SIZE) {
        reading->counters->bad_payload++;
        return GW_OK;
    }
    reading->counters->texts++;
    return gw_builder_note(reading->builder, (const char *)r->payload + 8, GW_TEXT_SIZE - 8, error);
}

static gw_code read_record(reader *reading, const record *r, gw_error *error) {
    const gw_log_type type = r->type >= 0 && r->type < GW_LOG_IDS ? reading->types[r->type] : GW_LOG_UNKNOWN;
    /* Without a stamp nothing is known but the record's time: it is the device's in VRPN's own logs. */
    stamp clocks = {.time = r->time, .device_time = r->time, .quality = 1.0};
    const int is_event =
        type >= GW_LOG_POSE && type != GW_LOG_TEXT && type != GW_LOG_STAMP && type != GW_LOG_END;
    if (reading->stamp.given && reading->stamp.sender == r->sender && is_event) {
        clocks = reading->stamp;
    } else if (reading->stamp.given) {
        reading->counters->stamps--; /* its event is not there */
        reading->counters->bad_payload++;
    }
    reading->stamp.given = 0;
    reading->counters->records++;
    reading->ended = type == GW_LOG_END;
    if (r->type < 0)
        return read_system_record(reading, r, error);
    if (type == GW_LOG_UNKNOWN)
        reading->counters->unknown_type++;
    else if (type == GW_LOG_OTHER)
        reading->counters->other_type++;
    else if (type == GW_LOG_END)
        reading->counters->descriptions++;
    else if (r->sender < 0 || r->sender >= GW_LOG_IDS || reading->senders[r->sender] == 0)
        reading->counters->unknown_sender++;
    else if (type == GW_LOG_TEXT)
        return read_text(reading, r, error);
    else if (type == GW_LOG_STAMP)
        read_stamp(reading, r);
    else
        return read_event(reading, r, &clocks, type, error);
    return GW_OK;
}

/* Looks at the next record: 1 when it is whole, 0 at the end that it should have; -1 and the damage when it
 * is neither. */
static int next_record(reader *reading, record *out) {
    gw_byte_stream *stream = reading->builder->stream;
    gw_recording_damage *damage = &reading->builder->recording->damage;
    const uint8_t *bytes;
    size_t there = gw_byte_stream_peek(stream, GW_LOG_HEADER, &bytes);
    const char *problem = gw_byte_stream_problem(stream);
    if (there == 0 && problem == NULL && (reading->ended || !reading->end_promised))
        return 0;
    *damage = (gw_recording_damage){
        .found = 1, .offset = gw_byte_stream_offset(stream), .record = reading->counters->records + 1};
    if (there == 0 && problem == NULL) {
        snprintf(damage->text, sizeof damage->text,
                 "the mark of its end was expected: who recorded it was ended before it was closed");
        return -1;
    }
    const char *why = problem != NULL ? problem : "the file is cut off";
    if (there < GW_LOG_HEADER) {
        snprintf(damage->text, sizeof damage->text,
                 "a record's header of %d bytes was expected, %zu are there: %s", GW_LOG_HEADER, there, why);
        return -1;
    }
    const int32_t size = gw_get_int32(bytes + 16);
    if (size < 0 || size > GW_LOG_PAYLOAD) {
        snprintf(damage->text, sizeof damage->text, "a payload of 0 to %d bytes was expected, not of %ld",
                 GW_LOG_PAYLOAD, (long)size);
        return -1;
    }
    there = gw_byte_stream_peek(stream, GW_LOG_HEADER + (size_t)size, &bytes) - GW_LOG_HEADER;
    if (there < (size_t)size) {
        problem = gw_byte_stream_problem(stream);
        snprintf(damage->text, sizeof damage->text, "a payload of %ld bytes was expected, %zu are there: %s",
                 (long)size, there, problem != NULL ? problem : "the file is cut off");
        return -1;
    }
    damage->found = 0;
    /* Seconds and microseconds are 32 bits each, so the sum cannot overflow, whatever they say. */
    *out = (record){.type = gw_get_int32(bytes),
                    .sender = gw_get_int32(bytes + 4),
                    .time = (int64_t)gw_get_int32(bytes + 8) * 1000000000 +
                            (int64_t)gw_get_int32(bytes + 12) * 1000,
                    .payload = bytes + GW_LOG_HEADER,
                    .size = (size_t)size};
    return 1;
}

gw_code gw_recording_read_log(gw_recording_builder *builder, gw_error *error) {
    const char *name = builder->recording->name;
    const uint8_t *bytes;
    size_t there = gw_byte_stream_peek(builder->stream, GW_LOG_COOKIE, &bytes);
    if (!is_cookie(bytes, there)) {
        const char *problem = gw_byte_stream_problem(builder->stream);
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: byte 0: not a VRPN log of major version 4 to 7 (it must begin with \"vrpn: ver. "
                       "07.38\" or alike)%s%s",
                       name, problem != NULL ? ": " : "", problem != NULL ? problem : "");
    }
    gw_byte_stream_take(builder->stream, GW_LOG_COOKIE);
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(reader), "reader of a recording", error);
    if (code != GW_OK)
        return code;
    reader *reading = memory;
    reading->builder = builder;
    reading->counters = &builder->recording->counters;
    record next;
    while (code == GW_OK && next_record(reading, &next) > 0) {
        code = read_record(reading, &next, error);
        gw_byte_stream_take(builder->stream, GW_LOG_HEADER + next.size);
    }
    free(reading);
    return code == GW_OK ? GW_OK : gw_context(error, "%s", name);
}
