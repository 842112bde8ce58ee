/* Gazewall's own gaze datagram: what an eye tracker that speaks neither VRPN nor DTrack is bridged with.
 * docs/gaze-datagram.md describes it byte by byte; this is version 1, 64 bytes, big-endian. Pure functions;
 * any thread. */
#ifndef GW_TRACKING_GAZE_DATAGRAM_H
#define GW_TRACKING_GAZE_DATAGRAM_H

#include "tracking/event.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_GAZE_DATAGRAM = 64, GW_GAZE_DATAGRAM_LONGEST = 1024 };

typedef enum gw_gaze_reading {
    GW_GAZE_READ,
    GW_GAZE_MALFORMED, /* too short, of another size than it says, or not ours at all */
    GW_GAZE_VERSION,   /* ours, but of a version this program does not know */
    GW_GAZE_NOT_FINITE /* numbers that are none, or a direction of no length */
} gw_gaze_reading;

/* What of it is no part of an event. */
typedef struct gw_gaze_extra {
    uint32_t sequence;
    double pupil; /* mm, or 0: not told */
} gw_gaze_extra;

/* Fills an event of kind GW_EVENT_GAZE but for its arrival; the quality of one without a direction is -1. */
gw_gaze_reading gw_gaze_datagram_read(const uint8_t *data, size_t size, gw_tracking_event *out,
                                      gw_gaze_extra *extra);
/* An event of kind GW_EVENT_GAZE of viewer 0 to 65535; `unit` is the metres of its unit of length. */
void gw_gaze_datagram_write(const gw_tracking_event *event, const gw_gaze_extra *extra, double unit,
                            uint8_t data[GW_GAZE_DATAGRAM]);

#endif
