/* The bounded queue of tracking/reader.h: when it is full, what a newer event makes worthless goes first. No
 * lock of its own. */
#ifndef GW_TRACKING_READER_QUEUE_H
#define GW_TRACKING_READER_QUEUE_H

#include "tracking/reader.h"

typedef struct gw_reader_queue {
    size_t count;
    uint64_t dropped[GW_READER_SOURCES];
    gw_reader_event events[GW_READER_QUEUE]; /* by age, the oldest first */
} gw_reader_queue;

void gw_reader_queue_put(gw_reader_queue *queue, const gw_reader_event *event);
size_t gw_reader_queue_take(gw_reader_queue *queue, gw_reader_event *out, size_t room);

#endif
