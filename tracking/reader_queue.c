#include "tracking/reader_queue.h"

#include <string.h>

static int is_superseded_by_newer(const gw_reader_event *event) {
    return event->event.kind == GW_EVENT_POSE || event->event.kind == GW_EVENT_GAZE;
}

static int same_sensor(const gw_reader_event *a, const gw_reader_event *b) {
    return a->source == b->source && a->event.kind == b->event.kind && a->event.sensor == b->event.sensor;
}

/* The place of what goes: the oldest pose of the new one's sensor; else the oldest pose of any; else the
 * oldest event. */
static size_t victim(const gw_reader_queue *queue, const gw_reader_event *event) {
    size_t oldest_pose = queue->count;
    for (size_t i = 0; i < queue->count; i++) {
        if (!is_superseded_by_newer(&queue->events[i]))
            continue;
        if (same_sensor(&queue->events[i], event))
            return i;
        if (oldest_pose == queue->count)
            oldest_pose = i;
    }
    return oldest_pose < queue->count ? oldest_pose : 0;
}

void gw_reader_queue_put(gw_reader_queue *queue, const gw_reader_event *event) {
    if (queue->count == GW_READER_QUEUE) {
        const size_t at = victim(queue, event);
        queue->dropped[queue->events[at].source]++;
        memmove(queue->events + at, queue->events + at + 1, (queue->count - at - 1) * sizeof *event);
        queue->count--;
    }
    queue->events[queue->count++] = *event;
}

size_t gw_reader_queue_take(gw_reader_queue *queue, gw_reader_event *out, size_t room) {
    const size_t count = queue->count < room ? queue->count : room;
    memcpy(out, queue->events, count * sizeof *out);
    memmove(queue->events, queue->events + count, (queue->count - count) * sizeof *out);
    queue->count -= count;
    return count;
}
