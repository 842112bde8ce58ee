/* Writing recordings: a VRPN log, or CSV when the name ends in .csv; gzipped when it ends in .gz. Events are
 * written as they come, so what was flushed is in the file whatever happens to the program; readers say where
 * the rest is missing.
 *
 * A record's time is the arrival, cut to microseconds: one clock for all devices, so other readers replay at
 * the pace at which it came. What that leaves out (nanoseconds, the device's clock, latency, quality) stands
 * in a stamp before the record (docs/tracks.md), unless there is nothing to add. One thread at a time. */
#ifndef GW_TRACKING_RECORDING_WRITER_H
#define GW_TRACKING_RECORDING_WRITER_H

#include "tracking/recording.h"

typedef struct gw_recording_writer gw_recording_writer;

typedef enum gw_recording_form {
    GW_RECORDING_BY_NAME, /* CSV for .csv and .csv.gz, else a VRPN log; gzipped for .gz */
    GW_RECORDING_AS_CSV   /* whatever the name; gzipped for .gz */
} gw_recording_form;

/* Whether such a file could be made now, as far as can be told: a user hears that before long work. */
gw_code gw_recording_writer_check(const char *path, int overwrite, gw_error *error);

/* start: ns since 1970 of arrival 0. GW_BAD_INPUT when a file is there and is not to be overwritten,
 * GW_NO_OUTPUT when it cannot be made. */
gw_code gw_recording_writer_open(const char *path, gw_recording_form form, int64_t start, int overwrite,
                                 gw_recording_writer **out, gw_error *error);
/* Closing marks the end of a log, and a reader that misses the mark says so: for what is written while it
 * happens, by a program that may be killed. After a sender, before events. CSV has no such mark. */
gw_code gw_recording_writer_mark_end(gw_recording_writer *writer, gw_error *error);
/* A device whose events follow; its number. At most GW_RECORDING_SENDERS; names are cut to what VRPN takes.
 */
gw_code gw_recording_writer_sender(gw_recording_writer *writer, const char *name, uint32_t *out,
                                   gw_error *error);
/* GW_BAD_INPUT for a time that a VRPN log cannot hold (before 1970 or after 2038). */
gw_code gw_recording_writer_event(gw_recording_writer *writer, uint32_t sender,
                                  const gw_tracking_event *event, gw_error *error);
/* A text for whoever reads the file, at the time of `arrival`; needs a sender. */
gw_code gw_recording_writer_note(gw_recording_writer *writer, int64_t arrival, const char *text,
                                 gw_error *error);
/* Hands everything to the operating system. GW_NO_OUTPUT when the disk is full or gone. */
gw_code gw_recording_writer_flush(gw_recording_writer *writer, gw_error *error);
/* The file ends as it should; the writer is gone in any case. A NULL *writer is fine. */
gw_code gw_recording_writer_close(gw_recording_writer **writer, gw_error *error);

/* A whole recording, notes included; those of `from` and later, before `to` (ns of arrival). */
gw_code gw_recording_write(const char *path, gw_recording_form form, const gw_recording *recording,
                           int64_t from, int64_t to, int overwrite, gw_error *error);

#endif
