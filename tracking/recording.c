#include "tracking/recording.h"

#include "base/memory.h"
#include "tracking/recording_builder.h"
#include "tracking/recording_format.h"
#include "tracking/vrpn_message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t FILE_LIMIT = (uint64_t)1 << 30;
static const double PLACE_LIMIT = 1e9;              /* in whatever unit: no room is as large */
static const int64_t STEP_BACK = 1000000000;        /* ns; less is a record out of order */
static const int64_t STEP_AHEAD = 3600000000000;    /* ns; more is a clock that was set, not a hole */
static const int64_t ARRIVAL_LIMIT = (int64_t)1e18; /* ns: 31 years */
static const int64_t TIME_LIMIT = (int64_t)2200000000 * 1000000000;
static const int64_t LATENCY_LIMIT = 1000000000000;

const char *const gw_log_type_names[GW_LOG_TYPES] = {
    [GW_LOG_POSE] = GW_VRPN_TYPE_POSE,         [GW_LOG_BUTTON] = GW_VRPN_TYPE_BUTTON,
    [GW_LOG_BUTTONS] = GW_VRPN_TYPE_BUTTONS,   [GW_LOG_ANALOGS] = GW_VRPN_TYPE_ANALOG,
    [GW_LOG_TEXT] = GW_VRPN_TYPE_TEXT,         [GW_LOG_STAMP] = "gazewall Stamp",
    [GW_LOG_GAZE] = "gazewall Gaze",           [GW_LOG_LINK] = "gazewall Link",
    [GW_LOG_UNTRACKED] = "gazewall Untracked", [GW_LOG_END] = "gazewall End"};

const char *const gw_csv_columns[GW_CSV_COLUMNS] = {
    "arrival_s", "sender", "kind", "sensor", "device_s", "latency_s", "quality",  "x",     "y",    "z", "qx",
    "qy",        "qz",     "qw",   "dx",     "dy",       "dz",        "openness", "frame", "value"};
const char *const gw_csv_kinds[5] = {"pose", "gaze", "button", "analog", "link"};

int32_t gw_recording_sender(const gw_recording *recording, const char *name) {
    for (uint32_t i = 0; i < recording->sender_count; i++)
        if (strcmp(recording->senders[i], name) == 0)
            return (int32_t)i;
    return -1;
}

int32_t gw_builder_sender(gw_recording_builder *builder, const char *name, gw_error *error) {
    gw_recording *recording = builder->recording;
    int32_t known = gw_recording_sender(recording, name);
    if (known >= 0)
        return known;
    if (recording->sender_count == GW_RECORDING_SENDERS)
        return -1;
    void *memory = recording->senders;
    gw_code code = gw_grow(&memory, &builder->sender_capacity, recording->sender_count + 1,
                           sizeof *recording->senders, "senders", error);
    recording->senders = memory;
    if (code != GW_OK)
        return -2;
    snprintf(recording->senders[recording->sender_count], GW_SENDER_NAME, "%s", name);
    return (int32_t)recording->sender_count++;
}

/* Makes a vector of `count` numbers one of length 1; 0 when there is no direction in it. One that has this
 * length but for rounding keeps its bits, so that what was written is read back as it was. */
static int make_unit(double *vector, int count) {
    double largest = 0.0, length = 0.0;
    for (int i = 0; i < count; i++) {
        if (!isfinite(vector[i]))
            return 0;
        largest = fmax(largest, fabs(vector[i]));
        length += vector[i] * vector[i];
    }
    if (fabs(length - 1.0) < 1e-15)
        return 1;
    if (!(largest > 1e-6)) /* an honest one has a component of at least 1/2 */
        return 0;
    length = 0.0;
    for (int i = 0; i < count; i++) { /* scaled first, so that squares stay in range */
        vector[i] /= largest;
        length += vector[i] * vector[i];
    }
    length = sqrt(length);
    for (int i = 0; i < count; i++)
        vector[i] /= length;
    return 1;
}

static int is_place(const double at[3]) {
    return fabs(at[0]) <= PLACE_LIMIT && fabs(at[1]) <= PLACE_LIMIT && fabs(at[2]) <= PLACE_LIMIT;
}

int gw_event_settle(gw_tracking_event *event) {
    static const double nowhere[3] = {0, 0, 0}, straight[4] = {0, 0, 0, 1}, ahead[3] = {0, 0, -1};
    const int tracked = event->quality >= 0.0;
    switch (event->kind) {
    case GW_EVENT_POSE:
        if (tracked)
            return is_place(event->of.pose.position) && make_unit(event->of.pose.orientation, 4);
        memcpy(event->of.pose.position, nowhere, sizeof nowhere);
        memcpy(event->of.pose.orientation, straight, sizeof straight);
        return 1;
    case GW_EVENT_GAZE:
        if (!event->of.gaze.has_origin || !tracked)
            memcpy(event->of.gaze.origin, nowhere, sizeof nowhere);
        if (!tracked)
            memcpy(event->of.gaze.direction, ahead, sizeof ahead);
        return is_place(event->of.gaze.origin) && make_unit(event->of.gaze.direction, 3) &&
               event->of.gaze.openness >= 0.0 && event->of.gaze.openness <= 1.0;
    case GW_EVENT_ANALOG:
        return isfinite(event->of.analog.value);
    default:
        return 1;
    }
}

int gw_clocks_are_good(int64_t device_time, int64_t latency, double quality) {
    return (device_time == GW_NO_TIME || (device_time > -TIME_LIMIT && device_time < TIME_LIMIT)) &&
           latency >= 0 && latency <= LATENCY_LIMIT && quality >= -1.0 && quality <= 1.0;
}

/* Arrival on the recording's own axis: it rises, whatever the clock that wrote the times did. */
static int64_t arrival_of(gw_recording_builder *builder, int64_t time) {
    gw_recording *recording = builder->recording;
    if (recording->count == 0) {
        recording->start = builder->newest = time;
        builder->shift = -time;
        return 0;
    }
    const int64_t before = recording->duration, ahead = time - builder->newest;
    if (ahead < -STEP_BACK || ahead > STEP_AHEAD || before + ahead > ARRIVAL_LIMIT) {
        recording->counters.clock_steps++;
        builder->newest = time;
        builder->shift = before - time;
        return before;
    }
    if (ahead < 0) {
        recording->counters.out_of_order++;
        return before;
    }
    builder->newest = time;
    return time + builder->shift;
}

static void count_event(gw_recording_counters *counters, gw_tracking_event_kind kind) {
    switch (kind) {
    case GW_EVENT_POSE:
        counters->poses++;
        break;
    case GW_EVENT_GAZE:
        counters->gazes++;
        break;
    case GW_EVENT_BUTTON:
        counters->buttons++;
        break;
    case GW_EVENT_ANALOG:
        counters->analogs++;
        break;
    case GW_EVENT_LINK:
        counters->links++;
        break;
    }
}

gw_code gw_builder_event(gw_recording_builder *builder, uint32_t sender, int64_t time,
                         const gw_tracking_event *event, gw_error *error) {
    gw_recording *recording = builder->recording;
    void *memory = recording->events;
    gw_code code = gw_grow(&memory, &builder->capacity, recording->count + 1, sizeof *recording->events,
                           "recorded events", error);
    recording->events = memory;
    if (code != GW_OK)
        return code;
    const int64_t arrival = arrival_of(builder, time);
    gw_recorded_event *to = &recording->events[recording->count++];
    *to = (gw_recorded_event){.sender = sender, .event = *event};
    to->event.arrival = recording->duration = arrival;
    count_event(&recording->counters, event->kind);
    return GW_OK;
}

gw_code gw_builder_note(gw_recording_builder *builder, const char *text, size_t size, gw_error *error) {
    gw_recording *recording = builder->recording;
    if (recording->note_count == GW_RECORDING_NOTES)
        return GW_OK; /* it is counted */
    void *memory = recording->notes;
    gw_code code = gw_grow(&memory, &builder->note_capacity, recording->note_count + 1,
                           sizeof *recording->notes, "notes", error);
    recording->notes = memory;
    if (code != GW_OK)
        return code;
    char *to = recording->notes[recording->note_count++];
    size_t length = strnlen(text, size < GW_NOTE_SIZE - 1 ? size : GW_NOTE_SIZE - 1);
    for (size_t i = 0; i < length; i++) /* it will be printed: no control characters */
        to[i] = (unsigned char)text[i] < ' ' || text[i] == 127 ? ' ' : text[i];
    to[length] = '\0';
    return GW_OK;
}

static gw_code read_stream(gw_byte_stream *stream, const char *name, gw_recording **out, gw_error *error) {
    gw_recording_builder builder = {.stream = stream};
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *builder.recording, "recording", error);
    if (code != GW_OK)
        return code;
    gw_recording *recording = builder.recording = memory;
    recording->name = gw_copy_text(name);
    recording->is_gzip = gw_byte_stream_is_gzip(stream);
    if (recording->name == NULL) {
        code = gw_fail(error, GW_MACHINE, "%s: out of memory for the recording's name", name);
    } else {
        const uint8_t *bytes;
        size_t there = gw_byte_stream_peek(stream, 6, &bytes);
        recording->is_csv = there > 0 && memcmp(bytes, "vrpn: ", there < 6 ? there : 6) != 0;
        code = recording->is_csv ? gw_recording_read_csv(&builder, error)
                                 : gw_recording_read_log(&builder, error);
    }
    recording->counters.bytes = gw_byte_stream_offset(stream);
    if (code == GW_OK)
        *out = recording;
    else
        gw_recording_destroy(&recording);
    return code;
}

gw_code gw_recording_load(const char *path, gw_recording **out, gw_error *error) {
    *out = NULL;
    gw_byte_stream *stream = NULL;
    gw_code code = gw_byte_stream_open(path, FILE_LIMIT, &stream, error);
    if (code == GW_OK)
        code = read_stream(stream, path, out, error);
    gw_byte_stream_close(&stream);
    return code;
}

gw_code gw_recording_parse(const void *data, size_t size, const char *name, gw_recording **out,
                           gw_error *error) {
    *out = NULL;
    gw_byte_stream *stream = NULL;
    gw_code code = gw_byte_stream_of(data, size, FILE_LIMIT, &stream, error);
    if (code == GW_OK)
        code = read_stream(stream, name, out, error);
    gw_byte_stream_close(&stream);
    return code;
}

void gw_recording_damage_text(const gw_recording *recording, char *text, size_t size) {
    const gw_recording_damage *damage = &recording->damage;
    if (size == 0)
        return;
    text[0] = '\0';
    if (damage->found)
        snprintf(text, size, "byte %llu, %s %llu: %s", (unsigned long long)damage->offset,
                 recording->is_csv ? "line" : "record", (unsigned long long)damage->record, damage->text);
}

void gw_recording_destroy(gw_recording **recording) {
    if (recording == NULL || *recording == NULL)
        return;
    free((*recording)->name);
    free((*recording)->events);
    free((*recording)->senders);
    free((*recording)->notes);
    free(*recording);
    *recording = NULL;
}
