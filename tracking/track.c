#include "tracking/track.h"

#include "base/file.h"
#include "base/memory.h"
#include "tracking/big_endian.h"
#include "tracking/vrpn_log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    ID_LIMIT = 2000, /* VRPN allows this many senders and as many types on a connection */
    NAME_LIMIT = 96, /* with the closing zero; a longer description makes VRPN drop its connection */
    POSE_SIZE = 64
};
static const size_t FILE_LIMIT = (size_t)1 << 30;
static const double POSITION_LIMIT = 1e9; /* mm; beyond it a value is no place in a room */

/* What a described type or sender is to us. */
enum { KNOWN = 1, WANTED = 2 };

typedef struct reader {
    const char *name;
    double unit;
    const char *wanted_sender;          /* NULL: the first that reports a usable pose, then track->sender */
    uint8_t types[ID_LIMIT];            /* 0, KNOWN, or WANTED: a pose */
    char senders[ID_LIMIT][NAME_LIMIT]; /* "" when not described */
    size_t capacity;
    int64_t last_time;
    gw_track *track;
} reader;

/* The name in a description, or NULL when it is not one: int32 length with the closing zero, then the name.
 */
static const char *described_name(const gw_vrpn_record *record) {
    if (record->sender < 0 || record->sender >= ID_LIMIT || record->payload_size < 5)
        return NULL;
    int32_t length = gw_get_int32(record->payload);
    if (length < 2 || length > NAME_LIMIT || (size_t)length > record->payload_size - 4)
        return NULL;
    const char *name = (const char *)record->payload + 4;
    return strnlen(name, (size_t)length) == (size_t)length - 1 ? name : NULL;
}

static void read_system_record(reader *r, const gw_vrpn_record *record) {
    gw_track_counters *counters = &r->track->counters;
    if (record->type < -5) {
        counters->unknown_type++;
        return;
    }
    if (record->type >= -2) {
        const char *name = described_name(record);
        if (name == NULL) {
            counters->bad_payload++;
            return;
        }
        if (record->type == -1)
            strcpy(r->senders[record->sender], name); /* described_name proved that it fits */
        else
            r->types[record->sender] = strcmp(name, "vrpn_Tracker Pos_Quat") == 0 ? WANTED : KNOWN;
    }
    counters->descriptions++;
}

/* Unit quaternion in place; 0 when there is no direction in it. Scaled first so that squares stay in range.
 */
static int normalise(double q[4]) {
    double largest = 0.0;
    for (int i = 0; i < 4; i++) {
        if (!isfinite(q[i]))
            return 0;
        largest = fmax(largest, fabs(q[i]));
    }
    if (!(largest > 1e-6)) /* an honest unit quaternion has a component of at least 1/2 */
        return 0;
    double length = 0.0;
    for (int i = 0; i < 4; i++) {
        q[i] /= largest;
        length += q[i] * q[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
    return 1;
}

/* 1 when the payload is a pose that can be used; fills all of *out but the time. */
static int read_pose(const reader *r, const uint8_t *payload, gw_pose_report *out) {
    out->sensor = gw_get_int32(payload); /* the four bytes after it are padding */
    for (int i = 0; i < 3; i++) {
        out->position[i] = gw_get_double(payload + 8 + 8 * i) * r->unit;
        if (!(fabs(out->position[i]) <= POSITION_LIMIT))
            return 0;
    }
    for (int i = 0; i < 4; i++)
        out->orientation[i] = gw_get_double(payload + 32 + 8 * i);
    return normalise(out->orientation);
}

static int sender_is_wanted(const reader *r, int32_t sender) {
    if (r->wanted_sender != NULL)
        return strcmp(r->senders[sender], r->wanted_sender) == 0;
    return r->track->sender[0] == '\0' || strcmp(r->senders[sender], r->track->sender) == 0;
}

static gw_code read_report(reader *r, const gw_vrpn_record *record, gw_error *error) {
    gw_track *track = r->track;
    gw_track_counters *counters = &track->counters;
    gw_pose_report report = {0};
    if (record->sender < 0 || record->sender >= ID_LIMIT || r->senders[record->sender][0] == '\0') {
        counters->unknown_sender++;
    } else if (record->payload_size != POSE_SIZE) {
        counters->bad_payload++;
    } else if (!sender_is_wanted(r, record->sender)) {
        counters->other_sender++;
    } else if (gw_get_int32(record->payload) < 0 || gw_get_int32(record->payload) >= GW_TRACK_SENSORS) {
        counters->bad_sensor++;
    } else if (!read_pose(r, record->payload, &report)) {
        counters->not_finite++;
    } else {
        void *memory = track->reports;
        gw_code code =
            gw_grow(&memory, &r->capacity, track->report_count + 1, sizeof report, "pose reports", error);
        track->reports = memory;
        if (code != GW_OK)
            return code;
        report.time = record->time;
        if (track->report_count > 0 && record->time < r->last_time)
            counters->out_of_order++;
        r->last_time = record->time;
        if (track->sender[0] == '\0')
            strcpy(track->sender, r->senders[record->sender]);
        track->reports[track->report_count++] = report;
        counters->poses++;
    }
    return GW_OK;
}

static gw_code read_record(reader *r, const gw_vrpn_record *record, gw_error *error) {
    r->track->counters.records++;
    if (record->type < 0)
        read_system_record(r, record);
    else if (record->type >= ID_LIMIT || r->types[record->type] == 0)
        r->track->counters.unknown_type++;
    else if (r->types[record->type] == KNOWN)
        r->track->counters.other_type++;
    else
        return read_report(r, record, error);
    return GW_OK;
}

/* Merge sort by time: stable, so reports of one moment keep the file's order. */
static void sort_reports(gw_pose_report *reports, gw_pose_report *spare, size_t count) {
    if (count < 2)
        return;
    size_t half = count / 2;
    sort_reports(reports, spare, half);
    sort_reports(reports + half, spare, count - half);
    memcpy(spare, reports, half * sizeof *reports);
    size_t left = 0, right = half, to = 0;
    while (left < half && right < count)
        reports[to++] = spare[left].time <= reports[right].time ? spare[left++] : reports[right++];
    memcpy(reports + to, spare + left, (half - left) * sizeof *reports);
}

/* Sorts, makes times start at zero, and lists each sensor's reports. */
static gw_code arrange(gw_track *track, gw_error *error) {
    if (track->counters.out_of_order > 0) {
        void *spare = NULL;
        gw_code code =
            gw_allocate(&spare, track->report_count, sizeof *track->reports, "sorting a track", error);
        if (code != GW_OK)
            return code;
        sort_reports(track->reports, spare, track->report_count);
        free(spare);
    }
    int64_t start = track->reports[0].time;
    for (size_t i = 0; i < track->report_count; i++) {
        track->reports[i].time -= start;
        track->sensor_count[track->reports[i].sensor]++;
    }
    track->duration = track->reports[track->report_count - 1].time;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS; sensor++) {
        void *memory = NULL;
        gw_code code =
            gw_allocate(&memory, track->sensor_count[sensor], sizeof(size_t), "a sensor's reports", error);
        if (code != GW_OK)
            return code;
        track->sensor_reports[sensor] = memory;
        size_t *next = memory;
        for (size_t i = 0; i < track->report_count; i++)
            if (track->reports[i].sensor == sensor)
                *next++ = i;
    }
    return GW_OK;
}

/* The names of the senders in the file, for a message. */
static void list_senders(const reader *r, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < ID_LIMIT && used < size; i++)
        if (r->senders[i][0] != '\0')
            used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", r->senders[i]);
    if (used == 0)
        snprintf(text, size, "none");
}

static gw_code fail_empty(const reader *r, gw_error *error) {
    const gw_track_counters *c = &r->track->counters;
    char senders[256];
    list_senders(r, senders, sizeof senders);
    return gw_fail(error, GW_BAD_INPUT,
                   "%s: no usable pose of a head (sensor 0, 2, 4 or 6) or a gaze (sensor 1, 3, 5 or 7)%s%s "
                   "in %llu records "
                   "(%llu of sensors other than 0 to 7, %llu not finite, %llu of other senders, %llu of "
                   "other types; senders: %s); "
                   "record it again or name another sender",
                   r->name, r->wanted_sender != NULL ? " of sender " : "",
                   r->wanted_sender != NULL ? r->wanted_sender : "", (unsigned long long)c->records,
                   (unsigned long long)c->bad_sensor, (unsigned long long)c->not_finite,
                   (unsigned long long)(c->other_sender + c->unknown_sender),
                   (unsigned long long)(c->other_type + c->unknown_type), senders);
}

static gw_code read_all(reader *r, const uint8_t *data, size_t size, gw_error *error) {
    size_t offset = gw_vrpn_log_begin(data, size);
    if (offset == 0)
        return gw_fail(
            error, GW_BAD_INPUT,
            "%s: byte 0: not a VRPN log of major version 4 to 7 (it must begin with \"vrpn: ver. 07.38\" or "
            "alike)",
            r->name);
    for (;;) {
        gw_vrpn_record record;
        int got = gw_vrpn_log_next(data, size, &offset, &record);
        if (got == 0)
            break;
        if (got < 0)
            return gw_fail(
                error, GW_BAD_INPUT,
                "%s: byte %zu: the record is cut off or its length is not 0..64000; `head -c %zu` keeps what "
                "is good",
                r->name, offset, offset);
        gw_code code = read_record(r, &record, error);
        if (code != GW_OK)
            return gw_context(error, "%s", r->name);
    }
    if (r->track->report_count == 0)
        return fail_empty(r, error);
    return arrange(r->track, error);
}

gw_code gw_track_parse(const void *data, size_t size, const char *name, const gw_track_options *options,
                       gw_track **out, gw_error *error) {
    *out = NULL;
    double unit = options != NULL && options->unit != 0.0 ? options->unit : 1000.0;
    if (!(unit > 0.0 && isfinite(unit)))
        return gw_fail(error, GW_BAD_INPUT, "%s: the unit must be more than 0 mm, not %g", name, unit);
    void *memory = NULL;
    gw_track *track = NULL;
    reader *r = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *track, "track", error);
    if (code != GW_OK)
        goto done;
    track = memory;
    memory = NULL;
    code = gw_allocate(&memory, 1, sizeof *r, "track reader", error);
    if (code != GW_OK)
        goto done;
    r = memory;
    track->name = gw_copy_text(name);
    if (track->name == NULL) {
        code = gw_fail(error, GW_MACHINE, "%s: out of memory for the track's name", name);
        goto done;
    }
    *r = (reader){.name = name, .unit = unit, .track = track};
    r->wanted_sender = options != NULL ? options->sender : NULL;
    code = read_all(r, data, size, error);
    if (code == GW_OK) {
        const gw_track_counters *c = &track->counters;
        gw_log_write(options != NULL ? options->log : NULL, GW_LOG_INFO,
                     "track %s: %llu poses of %s in %.3f s, %llu of %llu records skipped", name,
                     (unsigned long long)c->poses, track->sender, (double)track->duration * 1e-9,
                     (unsigned long long)(c->records - c->poses - c->descriptions),
                     (unsigned long long)c->records);
        *out = track;
        track = NULL;
    }
done:
    free(r);
    gw_track_destroy(&track);
    return code;
}

gw_code gw_track_load(const char *path, const gw_track_options *options, gw_track **out, gw_error *error) {
    *out = NULL;
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, FILE_LIMIT, &bytes, error);
    if (code != GW_OK)
        return code;
    code = gw_track_parse(bytes.data, bytes.size, path, options, out, error);
    gw_bytes_finish(&bytes);
    return code;
}

void gw_track_destroy(gw_track **track) {
    if (track == NULL || *track == NULL)
        return;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS; sensor++)
        free((*track)->sensor_reports[sensor]);
    free((*track)->reports);
    free((*track)->name);
    free(*track);
    *track = NULL;
}
