/* What a fuzzer and the unit test do with the bytes of a gaze datagram: read it, check what came out, and
 * write it again. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_GAZE_DATAGRAM_ENTRY_H
#define GW_TESTS_FUZZ_GAZE_DATAGRAM_ENTRY_H

#include "tracking/gaze_datagram.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_gaze_datagram(const uint8_t *data, size_t size) {
    gw_tracking_event event, again;
    gw_gaze_extra extra, extra_again;
    uint8_t bytes[GW_GAZE_DATAGRAM];
    if (gw_gaze_datagram_read(data, size, &event, &extra) != GW_GAZE_READ)
        return;
    const double *d = event.of.gaze.direction;
    if (size < GW_GAZE_DATAGRAM || event.kind != GW_EVENT_GAZE || event.quality > 1 ||
        !(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-9) || !isfinite(event.of.gaze.origin[0]) ||
        !(event.of.gaze.openness >= 0 && event.of.gaze.openness <= 1) || !(extra.pupil >= 0))
        abort();
    gw_gaze_datagram_write(&event, &extra, 1, bytes);
    if (gw_gaze_datagram_read(bytes, sizeof bytes, &again, &extra_again) != GW_GAZE_READ ||
        again.sensor != event.sensor || again.device_time != event.device_time ||
        again.latency != event.latency || again.quality != event.quality ||
        extra_again.sequence != extra.sequence || again.of.gaze.frame != event.of.gaze.frame ||
        memcmp(again.of.gaze.origin, event.of.gaze.origin, sizeof again.of.gaze.origin) != 0)
        abort();
}

#endif
