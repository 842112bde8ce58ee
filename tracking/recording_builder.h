/* How readers of recordings put one together: senders, events, notes. Internal to tracking/recording*.c. */
#ifndef GW_TRACKING_RECORDING_BUILDER_H
#define GW_TRACKING_RECORDING_BUILDER_H

#include "tracking/byte_stream.h"
#include "tracking/recording.h"

typedef struct gw_recording_builder {
    gw_recording *recording; /* owned until it is handed out */
    gw_byte_stream *stream;
    size_t capacity, sender_capacity, note_capacity;
    int64_t newest; /* ns since 1970, the newest time of this stretch of the clock */
    int64_t shift;  /* arrival - time */
} gw_recording_builder;

/* Number of a sender, new or known: -1 when there are too many of them, -2 with the error when memory is out.
 */
int32_t gw_builder_sender(gw_recording_builder *builder, const char *name, gw_error *error);

/* 1 when the event's numbers can be used; makes quaternion and direction unit vectors. */
int gw_event_settle(gw_tracking_event *event);

/* Appends a settled event that arrived at `time`, ns since 1970 in the recorder's clock. */
gw_code gw_builder_event(gw_recording_builder *builder, uint32_t sender, int64_t time,
                         const gw_tracking_event *event, gw_error *error);
gw_code gw_builder_note(gw_recording_builder *builder, const char *text, size_t size, gw_error *error);

/* The clocks that a stamp or row may give; beyond them they are no times. */
int gw_clocks_are_good(int64_t device_time, int64_t latency, double quality);

/* Both read the stream to its end or to the damage. */
gw_code gw_recording_read_log(gw_recording_builder *builder, gw_error *error);
gw_code gw_recording_read_csv(gw_recording_builder *builder, gw_error *error);

#endif
