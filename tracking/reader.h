/* Reads tracking sources on a thread of its own, so that arrival times are true however long frames take, and
 * hands their events over in order. One thread opens, takes from and closes a reader; log lines of the
 * sources, too, come out on that thread, when it takes. */
#ifndef GW_TRACKING_READER_H
#define GW_TRACKING_READER_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/source.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_READER_SOURCES = 8, GW_READER_QUEUE = 4096 };

typedef struct gw_reader_source {
    const char *spec, *bind; /* as gw_source_open takes them; bind may be NULL */
} gw_reader_source;

typedef struct gw_reader_event {
    int32_t source; /* index of the source */
    gw_tracking_event event;
} gw_reader_event;

typedef struct gw_reader gw_reader;

/* Opens up to GW_READER_SOURCES sources; the first that cannot be opened is the error, and none stays open.
 * log may be NULL. */
gw_code gw_reader_open(const gw_reader_source *sources, int count, const gw_log *log, gw_reader **out,
                       gw_error *error);
/* Ends the thread and closes the sources. */
void gw_reader_close(gw_reader **reader);

/* Up to `room` of the events that came since, in order of arrival at the reader. Never waits. */
size_t gw_reader_take(gw_reader *reader, gw_reader_event *out, size_t room);
/* Readable while events wait. */
int gw_reader_descriptor(const gw_reader *reader);

/* What a source has counted so far, and how it stands. out or status may be NULL. */
void gw_reader_count(gw_reader *reader, int source, gw_source_counters *out, gw_source_status *status);
/* Events of a source that were dropped because nobody took them for long: the oldest pose or gaze of the
 * sensor that reports first, buttons and the rest last. */
uint64_t gw_reader_dropped(gw_reader *reader, int source);

/* For the source `mouse`: 0 when that source is none, or full. */
int gw_reader_push(gw_reader *reader, int source, const gw_tracking_event *event);

#endif
