/* Listens to gaze datagrams (docs/gaze-datagram.md), of as many viewers as send. */
#include "tracking/source_internal.h"

#include "tracking/gaze_datagram.h"

#include <stdio.h>

typedef struct gaze_source {
    gw_datagram_source base;
    int told_version;
} gaze_source;

static void take(gaze_source *s, const uint8_t *data, size_t size, int64_t arrival) {
    gw_source *source = &s->base.base;
    gw_tracking_event event;
    gw_gaze_extra extra;
    const gw_gaze_reading reading = gw_gaze_datagram_read(data, size, &event, &extra);
    if (reading == GW_GAZE_VERSION && !s->told_version) {
        s->told_version = 1;
        gw_log_write(source->log, GW_LOG_WARNING,
                     "tracker %s: gaze datagrams of version %d come; this program reads version 1",
                     source->spec, data[4]);
    }
    if (reading == GW_GAZE_NOT_FINITE)
        source->counters.not_finite++;
    else if (reading == GW_GAZE_VERSION || (reading == GW_GAZE_READ && event.sensor >= GW_SOURCE_SENSORS))
        source->counters.unknown++;
    else if (reading == GW_GAZE_MALFORMED)
        source->counters.malformed++;
    if (source->counters.connections == source->counters.losses) {
        if (reading == GW_GAZE_MALFORMED || reading == GW_GAZE_VERSION) {
            source->status.standing =
                reading == GW_GAZE_VERSION ? GW_SOURCE_OTHER_VERSION : GW_SOURCE_OTHER_PROTOCOL;
            snprintf(source->status.detail, sizeof source->status.detail, "%d",
                     reading == GW_GAZE_VERSION ? data[4] : 0);
        } else {
            gw_source_emit_link(source, 1, arrival);
            source->status.standing = GW_SOURCE_SILENT;
        }
    }
    if (reading != GW_GAZE_READ || event.sensor >= GW_SOURCE_SENSORS)
        return;
    s->base.last = arrival;
    event.arrival = arrival;
    if (gw_source_sequence(source, event.sensor, extra.sequence) == GW_ORDER_NEWER)
        gw_source_emit(source, &event);
}

static void poll_source(gw_source *source, int64_t now) {
    gaze_source *s = (gaze_source *)source;
    uint8_t data[GW_GAZE_DATAGRAM_LONGEST];
    int64_t arrival;
    for (int turn = 0; turn < 1024; turn++) {
        const ptrdiff_t got = gw_datagram_source_next(&s->base, data, sizeof data, now, &arrival);
        if (got < 0)
            break;
        take(s, data, (size_t)got, arrival);
    }
    gw_datagram_source_watch(&s->base, now);
}

gw_code gw_gaze_source_open(const gw_source *like, const char *where, gw_source **out, gw_error *error) {
    gw_datagram_source *made;
    gw_code code =
        gw_datagram_source_open(like, where, sizeof(gaze_source), "gaze listener", poll_source, &made, error);
    if (!code)
        *out = &made->base;
    return code;
}
