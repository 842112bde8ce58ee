#include "wall/tracked_live.h"

#include "base/clock.h"
#include "base/memory.h"
#include "tracking/reader.h"

#include <stdlib.h>
#include <string.h>

/* So many events may wait for their time: 8 sensors of 1000 Hz over the longest added_latency. */
enum { MOST_WAITING = 65536, AT_ONCE = 256 };

struct gw_tracked_live {
    gw_reader *reader;
    gw_tracker_setup setup;
    int64_t delay;
    gw_reader_event *waiting; /* a ring of MOST_WAITING */
    uint32_t first, count;
    uint64_t dropped; /* the oldest, when the ring was full */
};

gw_code gw_tracked_live_open(const gw_tracker_setup *setup, int64_t delay, const gw_log *log,
                             gw_tracked_live **out, gw_error *error) {
    void *memory = NULL, *waiting = NULL;
    gw_reader_source sources[GW_TRACKER_SOURCES];
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_tracked_live), "tracking sources", error);
    if (!code)
        code = gw_allocate(&waiting, MOST_WAITING, sizeof(gw_reader_event), "tracking events", error);
    *out = memory;
    if (code) {
        gw_tracked_live_close(out);
        return code;
    }
    gw_tracked_live *live = *out;
    live->setup = *setup;
    live->delay = delay;
    live->waiting = waiting;
    for (uint32_t i = 0; i < setup->source_count; i++)
        sources[i] = (gw_reader_source){live->setup.sources[i].spec, live->setup.sources[i].bind};
    code = gw_reader_open(sources, (int)setup->source_count, log, &live->reader, error);
    if (code)
        gw_tracked_live_close(out);
    return code;
}

void gw_tracked_live_close(gw_tracked_live **live) {
    if (!*live)
        return;
    if ((*live)->reader)
        gw_reader_close(&(*live)->reader);
    free((*live)->waiting);
    free(*live);
    *live = NULL;
}

static void keep(gw_tracked_live *live, const gw_reader_event *event) {
    if (live->count == MOST_WAITING) {
        live->first = (live->first + 1) % MOST_WAITING;
        live->count--;
        live->dropped++;
    }
    live->waiting[(live->first + live->count++) % MOST_WAITING] = *event;
}

int64_t gw_tracked_live_feed(gw_tracked_live *live, gw_tracker *tracker) {
    gw_reader_event events[AT_ONCE];
    const int64_t now = gw_now_ns();
    size_t taken;
    do {
        taken = gw_reader_take(live->reader, events, AT_ONCE);
        for (size_t i = 0; i < taken; i++)
            keep(live, &events[i]);
    } while (taken == AT_ONCE);
    for (; live->count > 0; live->count--) {
        gw_reader_event *event = &live->waiting[live->first];
        if (event->event.arrival + live->delay > now)
            break;
        event->event.arrival += live->delay;
        event->event.latency += live->delay;
        gw_tracker_take(tracker, event->source, &event->event);
        live->first = (live->first + 1) % MOST_WAITING;
    }
    return now;
}

static json_t *count(uint64_t value) {
    return json_integer((json_int_t)value);
}

json_t *gw_tracked_live_json(gw_tracked_live *live) {
    json_t *list = json_array();
    gw_source_counters *c = calloc(1, sizeof *c);
    for (uint32_t i = 0; c && i < live->setup.source_count; i++) {
        gw_reader_count(live->reader, (int)i, c, NULL);
        const gw_sensor_counters sum = gw_source_sum(c);
        json_array_append_new(
            list, json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
                            "source", live->setup.sources[i].spec, "bytes", count(c->bytes), "packets",
                            count(c->packets), "events", count(c->events), "malformed", count(c->malformed),
                            "not_finite", count(c->not_finite), "unknown", count(c->unknown), "connections",
                            count(c->connections), "losses", count(c->losses), "lost", count(sum.lost),
                            "jumps", count(sum.jumps), "duplicated", count(sum.duplicated), "reordered",
                            count(sum.reordered), "dropped",
                            count(gw_reader_dropped(live->reader, (int)i) + (i ? 0 : live->dropped))));
    }
    free(c);
    return list;
}
