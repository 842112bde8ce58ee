#include "tracking/recording_writer.h"

#include "base/file.h"
#include "base/memory.h"
#include "tracking/big_endian.h"
#include "tracking/recording_csv.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { BUFFER = 1 << 16 };

/* Analog channels of one device: VRPN sends all of them at a time. */
typedef struct channels {
    int32_t count, newest;
    double values[GW_ANALOG_LIMIT];
} channels;

struct gw_recording_writer {
    char *path;
    gzFile file; /* writes plainly when the name does not end in .gz */
    int is_csv;
    int64_t start;
    locale_t plain;
    uint32_t sender_count;
    char (*senders)[GW_SENDER_NAME];
    channels **analogs; /* [sender_count]; NULL: none yet */
    size_t sender_capacity, analog_capacity;
    int waiting; /* analogs of one moment are put together: `last` is the newest of them */
    gw_recorded_event last;
    uint8_t described[GW_LOG_TYPES];
};

static gw_code fail_write(gw_recording_writer *writer, gw_error *error) {
    int number = Z_OK;
    const char *text = gzerror(writer->file, &number);
    return gw_fail(error, GW_NO_OUTPUT, "%s: cannot be written: %s", writer->path,
                   number == Z_ERRNO ? strerror(errno) : text);
}

static gw_code put(gw_recording_writer *writer, const void *bytes, size_t size, gw_error *error) {
    return gzwrite(writer->file, bytes, (unsigned)size) == (int)size ? GW_OK : fail_write(writer, error);
}

static gw_code put_record(gw_recording_writer *writer, int32_t type, int32_t sender, int64_t time,
                          const uint8_t *payload, size_t size, gw_error *error) {
    const int64_t second = 1000000000;
    uint8_t header[GW_LOG_HEADER], *to = header;
    to = gw_put_int32(to, type);
    to = gw_put_int32(to, sender);
    to = gw_put_int32(to, (int32_t)(time / second));
    to = gw_put_int32(to, (int32_t)(time % second / 1000));
    to = gw_put_int32(to, (int32_t)size);
    gw_put_int32(to, 0);
    gw_code code = put(writer, header, sizeof header, error);
    return code != GW_OK || size == 0 ? code : put(writer, payload, size, error);
}

static gw_code put_description(gw_recording_writer *writer, int32_t kind, int32_t id, int64_t time,
                               const char *name, gw_error *error) {
    uint8_t payload[4 + GW_SENDER_NAME];
    const size_t length = strlen(name) + 1;
    gw_put_int32(payload, (int32_t)length);
    memcpy(payload + 4, name, length);
    return put_record(writer, kind, id, time, payload, 4 + length, error);
}

/* A type is described before its first record. */
static gw_code describe(gw_recording_writer *writer, gw_log_type type, int64_t time, gw_error *error) {
    if (writer->described[type])
        return GW_OK;
    writer->described[type] = 1;
    return put_description(writer, -2, (int32_t)type, time, gw_log_type_names[type], error);
}

static uint8_t *put_int64(uint8_t *to, int64_t value) {
    to = gw_put_int32(to, (int32_t)(value >> 32));
    return gw_put_int32(to, (int32_t)(uint32_t)value);
}

static uint8_t *put_doubles(uint8_t *to, const double *values, int count) {
    for (int i = 0; i < count; i++)
        to = gw_put_double(to, values[i]);
    return to;
}

/* The clocks, unless a reader would take them to be so without a stamp. */
static gw_code put_stamp(gw_recording_writer *writer, uint32_t sender, int64_t time,
                         const gw_tracking_event *event, gw_error *error) {
    if (time % 1000 == 0 && event->device_time == time && event->latency == 0 && event->quality == 1.0)
        return GW_OK;
    uint8_t payload[GW_STAMP_SIZE];
    gw_put_double(put_int64(put_int64(put_int64(payload, time), event->device_time), event->latency),
                  event->quality);
    gw_code code = describe(writer, GW_LOG_STAMP, time, error);
    return code != GW_OK
               ? code
               : put_record(writer, GW_LOG_STAMP, (int32_t)sender, time, payload, sizeof payload, error);
}

static gw_log_type fill_pose(const gw_tracking_event *event, uint8_t *to, size_t *size) {
    to = gw_put_int32(to, event->sensor);
    *size = GW_UNTRACKED_SIZE;
    if (event->quality < 0.0) /* other readers would take the numbers for a pose */
        return GW_LOG_UNTRACKED;
    to = put_doubles(gw_put_int32(to, 0), event->of.pose.position, 3);
    put_doubles(to, event->of.pose.orientation, 4);
    *size = GW_POSE_SIZE;
    return GW_LOG_POSE;
}

static gw_log_type fill_gaze(const gw_tracking_event *event, uint8_t *to, size_t *size) {
    const int head = event->of.gaze.frame == GW_GAZE_IN_HEAD;
    to = gw_put_int32(to, event->sensor);
    to = gw_put_int32(to,
                      (head ? GW_GAZE_FLAG_HEAD : 0) | (event->of.gaze.has_origin ? GW_GAZE_FLAG_ORIGIN : 0));
    to = put_doubles(put_doubles(to, event->of.gaze.origin, 3), event->of.gaze.direction, 3);
    gw_put_double(to, event->of.gaze.openness);
    *size = GW_GAZE_SIZE;
    return GW_LOG_GAZE;
}

static gw_code put_event(gw_recording_writer *writer, const gw_recorded_event *recorded, gw_error *error) {
    const gw_tracking_event *event = &recorded->event;
    const int64_t time = writer->start + event->arrival;
    uint8_t payload[8 + 8 * GW_ANALOG_LIMIT];
    size_t size = 0;
    gw_log_type type;
    if (event->kind == GW_EVENT_POSE) {
        type = fill_pose(event, payload, &size);
    } else if (event->kind == GW_EVENT_GAZE) {
        type = fill_gaze(event, payload, &size);
    } else if (event->kind == GW_EVENT_BUTTON) {
        gw_put_int32(gw_put_int32(payload, event->sensor), event->of.button.pressed);
        type = GW_LOG_BUTTON;
        size = GW_BUTTON_SIZE;
    } else if (event->kind == GW_EVENT_ANALOG) {
        const channels *all = writer->analogs[recorded->sender];
        put_doubles(gw_put_double(payload, all->count), all->values, all->count);
        type = GW_LOG_ANALOGS;
        size = 8 + 8 * (size_t)all->count;
    } else {
        gw_put_int32(payload, event->of.link.up);
        type = GW_LOG_LINK;
        size = GW_LINK_SIZE;
    }
    gw_code code = describe(writer, type, time, error); /* nothing may stand between a stamp and its event */
    if (code == GW_OK)
        code = put_stamp(writer, recorded->sender, time, event, error);
    return code != GW_OK
               ? code
               : put_record(writer, (int32_t)type, (int32_t)recorded->sender, time, payload, size, error);
}

/* Writes the analogs that were waiting for more of their moment. */
static gw_code put_waiting(gw_recording_writer *writer, gw_error *error) {
    if (!writer->waiting)
        return GW_OK;
    writer->waiting = 0;
    return put_event(writer, &writer->last, error);
}

/* 1 when the analog belongs to the message of the one that waits. */
static int joins(const gw_recording_writer *writer, uint32_t sender, const gw_tracking_event *event) {
    const gw_tracking_event *last = &writer->last.event;
    return writer->waiting && writer->last.sender == sender && last->arrival == event->arrival &&
           last->device_time == event->device_time && last->latency == event->latency &&
           last->quality == event->quality && event->sensor > last->sensor;
}

static gw_code take_analog(gw_recording_writer *writer, uint32_t sender, const gw_tracking_event *event,
                           gw_error *error) {
    if (event->sensor < 0 || event->sensor >= GW_ANALOG_LIMIT)
        return gw_fail(error, GW_BAD_INPUT, "%s: axis %ld of %s: VRPN has axes 0 to %d", writer->path,
                       (long)event->sensor, writer->senders[sender], GW_ANALOG_LIMIT - 1);
    gw_code code = joins(writer, sender, event) ? GW_OK : put_waiting(writer, error);
    if (code == GW_OK && writer->analogs[sender] == NULL) {
        void *memory = NULL;
        code = gw_allocate(&memory, 1, sizeof(channels), "axes of a device", error);
        writer->analogs[sender] = memory;
    }
    if (code != GW_OK)
        return code;
    channels *all = writer->analogs[sender];
    all->values[event->sensor] = event->of.analog.value;
    if (event->sensor >= all->count)
        all->count = event->sensor + 1;
    writer->waiting = 1;
    writer->last = (gw_recorded_event){.sender = sender, .event = *event};
    return GW_OK;
}

static gw_code put_row(gw_recording_writer *writer, uint32_t sender, const gw_tracking_event *event,
                       gw_error *error) {
    char row[GW_CSV_ROW];
    locale_t before = uselocale(writer->plain);
    size_t size = gw_csv_put_event(row, writer->senders[sender], writer->start + event->arrival, event);
    uselocale(before);
    return put(writer, row, size, error);
}

gw_code gw_recording_writer_event(gw_recording_writer *writer, uint32_t sender,
                                  const gw_tracking_event *event, gw_error *error) {
    const int64_t last = (int64_t)INT32_MAX * 1000000000; /* a log's seconds are signed 32-bit integers */
    const int64_t time = writer->start + event->arrival;
    if (time < 0 || time > last)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: an event is at %.3f s after 1970: the file holds seconds 0 to 2147483647",
                       writer->path, (double)time * 1e-9);
    if (writer->is_csv)
        return put_row(writer, sender, event, error);
    if (event->kind == GW_EVENT_ANALOG)
        return take_analog(writer, sender, event, error);
    gw_code code = put_waiting(writer, error);
    const gw_recorded_event recorded = {.sender = sender, .event = *event};
    return code != GW_OK ? code : put_event(writer, &recorded, error);
}

gw_code gw_recording_writer_sender(gw_recording_writer *writer, const char *name, uint32_t *out,
                                   gw_error *error) {
    if (writer->sender_count == GW_RECORDING_SENDERS)
        return gw_fail(error, GW_BAD_INPUT, "%s: more than %d senders", writer->path, GW_RECORDING_SENDERS);
    void *memory = writer->senders;
    gw_code code = gw_grow(&memory, &writer->sender_capacity, writer->sender_count + 1,
                           sizeof *writer->senders, "senders", error);
    writer->senders = memory;
    if (code != GW_OK)
        return code;
    memory = writer->analogs;
    code = gw_grow(&memory, &writer->analog_capacity, writer->sender_count + 1, sizeof *writer->analogs,
                   "senders", error);
    writer->analogs = memory;
    if (code != GW_OK)
        return code;
    char *to = writer->senders[writer->sender_count];
    snprintf(to, GW_SENDER_NAME, "%s", name[0] != '\0' ? name : "Tracker0");
    writer->analogs[writer->sender_count] = NULL;
    *out = writer->sender_count++;
    return writer->is_csv ? GW_OK : put_description(writer, -1, (int32_t)*out, writer->start, to, error);
}

gw_code gw_recording_writer_note(gw_recording_writer *writer, int64_t arrival, const char *text,
                                 gw_error *error) {
    uint8_t payload[GW_TEXT_SIZE] = {0};
    if (writer->is_csv) {
        char line[GW_NOTE_SIZE + 4];
        int size = snprintf(line, sizeof line, "# %.*s\n", GW_NOTE_SIZE, text);
        return put(writer, line, (size_t)size, error);
    }
    gw_code code = put_waiting(writer, error);
    snprintf((char *)payload + 8, GW_NOTE_SIZE, "%s", text);
    if (code == GW_OK)
        code = describe(writer, GW_LOG_TEXT, writer->start + arrival, error);
    return code != GW_OK
               ? code
               : put_record(writer, GW_LOG_TEXT, 0, writer->start + arrival, payload, sizeof payload, error);
}

gw_code gw_recording_writer_mark_end(gw_recording_writer *writer, gw_error *error) {
    return writer->is_csv ? GW_OK : describe(writer, GW_LOG_END, writer->start, error);
}

gw_code gw_recording_writer_flush(gw_recording_writer *writer, gw_error *error) {
    gw_code code = put_waiting(writer, error);
    return code != GW_OK || gzflush(writer->file, Z_SYNC_FLUSH) == Z_OK ? code : fail_write(writer, error);
}

gw_code gw_recording_writer_close(gw_recording_writer **at, gw_error *error) {
    gw_recording_writer *writer = *at;
    if (writer == NULL)
        return GW_OK;
    gw_code code = GW_OK;
    if (writer->file != NULL) {
        code = put_waiting(writer, error);
        if (code == GW_OK && writer->described[GW_LOG_END])
            code = put_record(writer, GW_LOG_END, 0, writer->start, NULL, 0, error);
        if (gzclose(writer->file) != Z_OK && code == GW_OK)
            code = gw_fail(error, GW_NO_OUTPUT, "%s: cannot be written: %s", writer->path, strerror(errno));
    }
    for (uint32_t i = 0; i < writer->sender_count; i++)
        free(writer->analogs[i]);
    if (writer->plain != (locale_t)0)
        freelocale(writer->plain);
    free(writer->analogs);
    free(writer->senders);
    free(writer->path);
    free(writer);
    *at = NULL;
    return code;
}

/* A file that is there stays, unless it is to be overwritten; devices and pipes are written to. */
static gw_code check_there(const char *path, int overwrite, int *there, gw_error *error) {
    struct stat about;
    *there = stat(path, &about) == 0;
    if (*there && S_ISREG(about.st_mode) && !overwrite)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: there is such a file already; --overwrite replaces it, another name keeps it",
                       path);
    return GW_OK;
}

gw_code gw_recording_writer_check(const char *path, int overwrite, gw_error *error) {
    int there;
    gw_code code = check_there(path, overwrite, &there, error);
    return code != GW_OK ? code : gw_file_writable(path, error);
}

static gw_code open_file(gw_recording_writer *writer, int overwrite, gw_error *error) {
    const char *path = writer->path;
    int there;
    gw_code code = check_there(path, overwrite, &there, error);
    if (code != GW_OK)
        return code;
    int descriptor =
        open(path, O_WRONLY | O_CREAT | O_CLOEXEC | (overwrite || there ? O_TRUNC : O_EXCL), 0666);
    if (descriptor < 0)
        return gw_fail(error, GW_NO_OUTPUT, "%s: cannot be written: %s", path, strerror(errno));
    writer->file = gzdopen(descriptor, gw_path_has_extension(path, ".gz") ? "wb9" : "wbT");
    if (writer->file == NULL || gzbuffer(writer->file, BUFFER) != 0) {
        if (writer->file == NULL)
            close(descriptor);
        return gw_fail(error, GW_MACHINE, "%s: out of memory for writing it", path);
    }
    return GW_OK;
}

gw_code gw_recording_writer_open(const char *path, gw_recording_form form, int64_t start, int overwrite,
                                 gw_recording_writer **out, gw_error *error) {
    void *memory = NULL;
    *out = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_recording_writer), "writer of a recording", error);
    if (code != GW_OK)
        return code;
    gw_recording_writer *writer = memory;
    writer->start = start;
    writer->is_csv = form == GW_RECORDING_AS_CSV || gw_path_has_extension(path, ".csv") ||
                     gw_path_has_extension(path, ".csv.gz");
    writer->path = gw_copy_text(path);
    writer->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (writer->path == NULL || writer->plain == (locale_t)0)
        code = gw_fail(error, GW_MACHINE, "%s: out of memory for writing it", path);
    else
        code = open_file(writer, overwrite, error);
    if (code == GW_OK && writer->is_csv) {
        char row[GW_CSV_ROW];
        code = put(writer, row, gw_csv_put_head(row), error);
    } else if (code == GW_OK) {
        static const char cookie[GW_LOG_COOKIE] = "vrpn: ver. 07.38  0"; /* and five zeros */
        code = put(writer, cookie, sizeof cookie, error);
    }
    if (code == GW_OK)
        *out = writer;
    else
        gw_recording_writer_close(&writer, NULL);
    return code;
}

gw_code gw_recording_write(const char *path, gw_recording_form form, const gw_recording *recording,
                           int64_t from, int64_t to, int overwrite, gw_error *error) {
    gw_recording_writer *writer = NULL;
    gw_code code = gw_recording_writer_open(path, form, recording->start, overwrite, &writer, error);
    uint32_t number;
    for (uint32_t i = 0; i < recording->sender_count && code == GW_OK; i++)
        code = gw_recording_writer_sender(writer, recording->senders[i], &number, error);
    for (uint32_t i = 0; i < recording->note_count && code == GW_OK && recording->sender_count > 0; i++)
        code = gw_recording_writer_note(writer, 0, recording->notes[i], error);
    for (size_t i = 0; i < recording->count && code == GW_OK; i++)
        if (recording->events[i].event.arrival >= from && recording->events[i].event.arrival < to)
            code = gw_recording_writer_event(writer, recording->events[i].sender, &recording->events[i].event,
                                             error);
    gw_code closed = gw_recording_writer_close(&writer, code == GW_OK ? error : NULL);
    return code != GW_OK ? code : closed;
}
