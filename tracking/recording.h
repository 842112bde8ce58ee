/* Recordings of trackers: the events of one or several devices in order of arrival, read from a VRPN log
 * (anyone's, or our own with gaze and device clocks) or from CSV, plain or gzipped (docs/tracks.md). What a
 * file says is told apart by its content, not by its name.
 *
 * Reading is hostile-safe: lengths are bounded, what is not known is counted and skipped. A file that is cut
 * or damaged is read up to that place, which `damage` names; only one that cannot be read from its start is
 * an error. Positions are in the recording's own unit and axes, as the device said them (tracking/room.h).
 *
 * A recording is read-only once it is loaded; any thread may read it. */
#ifndef GW_TRACKING_RECORDING_H
#define GW_TRACKING_RECORDING_H

#include "base/status.h"
#include "tracking/event.h"

#include <stddef.h>
#include <stdint.h>

enum {
    GW_RECORDING_SENDERS = 256, /* devices in one file */
    GW_SENDER_NAME = 96,        /* bytes of a device's name with its zero, as in VRPN */
    GW_RECORDING_NOTES = 8,     /* texts that are kept; more are counted */
    GW_NOTE_SIZE = 256
};

typedef struct gw_recorded_event {
    uint32_t sender; /* index into gw_recording.senders */
    gw_tracking_event event;
} gw_recorded_event;

/* What was read and what became of it: records = of events + stamps + texts + descriptions + other_type + ...
 * + not_finite (of events: those whose record was used; one of several analogs is several events). */
typedef struct gw_recording_counters {
    uint64_t bytes;                                 /* read, after expansion */
    uint64_t records;                               /* whole ones; of CSV, rows */
    uint64_t used;                                  /* records that became events */
    uint64_t poses, gazes, buttons, analogs, links; /* events */
    uint64_t stamps;                                /* records that carry the clocks of the next one */
    uint64_t texts;                                 /* notes of whoever recorded */
    uint64_t descriptions;   /* of senders and types, connection records, the end mark */
    uint64_t other_type;     /* described, but nothing for us: pings, velocities, ... */
    uint64_t unknown_type;   /* a type that was not described before, or an unknown system record */
    uint64_t unknown_sender; /* of a sender that was not described before */
    uint64_t bad_payload;  /* not of its type's size; a description without a proper name or with an id out of
                              range; a stamp without its event */
    uint64_t bad_sensor;   /* a negative number of a sensor, button or axis */
    uint64_t not_finite;   /* NaN, infinite or far beyond any room; a zero quaternion or direction */
    uint64_t out_of_order; /* used, but with an earlier time than the record before; arrival stays */
    uint64_t clock_steps;  /* times more than 1 s back or 1 h ahead: arrival goes on without the step */
} gw_recording_counters;

/* Where the file stopped making sense; what is before it was read. */
typedef struct gw_recording_damage {
    int found;
    uint64_t offset; /* of the first byte that is not good, in the expanded file */
    uint64_t record; /* number of the record that it cut, from 1; of CSV, the line */
    char text[192];  /* what was expected and what is there */
} gw_recording_damage;

typedef struct gw_recording {
    char *name; /* of the file */
    int is_csv, is_gzip;
    size_t count;
    gw_recorded_event *events; /* by rising arrival; the first arrives at 0 */
    int64_t start;             /* ns since 1970 of the first arrival */
    int64_t duration;          /* ns, arrival of the last event */
    uint32_t sender_count;
    char (*senders)[GW_SENDER_NAME];
    uint32_t note_count;
    char (*notes)[GW_NOTE_SIZE];
    gw_recording_counters counters;
    gw_recording_damage damage;
} gw_recording;

/* GW_BAD_INPUT names the file and the byte or line. A recording without any event is not an error. */
gw_code gw_recording_load(const char *path, gw_recording **out, gw_error *error);
gw_code gw_recording_parse(const void *data, size_t size, const char *name, gw_recording **out,
                           gw_error *error);
void gw_recording_destroy(gw_recording **recording);

/* "byte 1234, record 17: ..." for messages; "" when nothing is damaged. */
void gw_recording_damage_text(const gw_recording *recording, char *text, size_t size);

/* Number of the sender of that name, or -1. */
int32_t gw_recording_sender(const gw_recording *recording, const char *name);

#endif
