/* Sources of tracking events: a VRPN server, a DTrack controller, our own gaze datagrams, a recording, a
 * scripted path, the mouse, or nothing. They only report: what came is an event, what was wrong is counted.
 * No source waits, and none ends a run because of what a peer sent; a lost peer is sought again by itself.
 *
 * A source belongs to the thread that opened it; tracking/reader.h runs sources on a thread of their own, so
 * that arrival times do not depend on when frames are drawn. */
#ifndef GW_TRACKING_SOURCE_H
#define GW_TRACKING_SOURCE_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/event.h"

#include <stdint.h>

enum { GW_SOURCE_SENSORS = 64 }; /* sensors that are counted one by one */

/* Per sensor of poses (or viewer of gazes). */
typedef struct gw_sensor_counters {
    uint64_t events;
    uint64_t lost;       /* by sequence numbers or frame counters, where the protocol has them */
    uint64_t duplicated; /* with the time stamp and numbers of the one before; not passed on */
    uint64_t reordered;  /* older than the newest of that sensor; not passed on */
    uint64_t untracked;  /* passed on with a quality below 0 */
} gw_sensor_counters;

/* What was received and what became of it; nothing is dropped in silence. */
typedef struct gw_source_counters {
    uint64_t bytes, packets; /* a packet is a datagram, or a message of a stream */
    uint64_t events;
    uint64_t malformed;  /* packets, or parts of one, that break the protocol */
    uint64_t not_finite; /* numbers that are NaN, infinite or far beyond any room; zero quaternions */
    uint64_t unknown;    /* well-formed, but of a type, sender or sensor that is not known or not asked for */
    uint64_t connections, losses; /* how often the peer was reached, and lost again */
    gw_sensor_counters sensors[GW_SOURCE_SENSORS];
} gw_source_counters;

typedef struct gw_source_options {
    const char *bind; /* numeric address of the local interface; NULL or "": all */
    const gw_log *log;
} gw_source_options;

typedef struct gw_source gw_source;

/* spec names what is to be read; `gazewall doctor --help` and docs/tracks.md list the forms:
 *   NAME@HOST[:PORT], vrpn:NAME@HOST[:PORT]   VRPN over TCP; vrpn+udp:... asks for poses by UDP
 *   dtrack:[ADDRESS:]PORT                      DTrack datagrams; a multicast address is joined
 *   gaze:[ADDRESS:]PORT                        gaze datagrams (docs/gaze-datagram.md)
 *   path:FILE, mouse, null                     scripted path, the window's pointer, nothing
 * GW_BAD_INPUT names a form that is wrong; GW_MACHINE what the network refused (port in use). That a peer
 * cannot be reached now is no error: it is sought every second. */
gw_code gw_source_open(const char *spec, const gw_source_options *options, gw_source **out, gw_error *error);
void gw_source_close(gw_source **source);

/* Takes what has come by `now` (ns, gw_now_ns clock), calling the sink for each event in order of arrival.
 * Never waits. */
void gw_source_poll(gw_source *source, int64_t now, gw_event_sink sink, void *context);
/* Descriptors to poll() for reading (at most `room`; returns how many), and the time at which the source
 * wants gw_source_poll at the latest (ns; INT64_MAX: never by itself). */
int gw_source_descriptors(const gw_source *source, int *descriptors, int room);
int64_t gw_source_next(const gw_source *source);

const char *gw_source_name(const gw_source *source); /* the spec */
const gw_source_counters *gw_source_count(const gw_source *source);

#endif
