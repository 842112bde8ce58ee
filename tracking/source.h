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

enum {
    GW_SOURCE_SENSORS = 64, /* sensors that are counted one by one */
    GW_SEQUENCE_JUMP = 1024 /* a second of the fastest trackers */
};

/* Per sensor of poses (or viewer of gazes). */
typedef struct gw_sensor_counters {
    uint64_t events;
    uint64_t lost;  /* by sequence numbers or frame counters, where the protocol has them */
    uint64_t jumps; /* of those numbers by GW_SEQUENCE_JUMP and more, either way: a sender that began anew,
                       a long silence, or a forged packet; how many were lost it cannot tell */
    uint64_t duplicated; /* with the time stamp and numbers of the one before; not passed on */
    uint64_t reordered;  /* older than the newest of that sensor by less than 1 s; not passed on. More is a
                            clock that was set, or a sender that began anew: it is followed. */
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

/* The counters of all sensors together. */
gw_sensor_counters gw_source_sum(const gw_source_counters *counters);

typedef struct gw_source_options {
    const char *bind; /* numeric address of the local interface; NULL or "": all */
    const gw_log *log;
} gw_source_options;

/* How a source stands with its peer, for messages: the first thing that is in the way. */
typedef enum gw_source_standing {
    GW_SOURCE_REPORTS,        /* events have come since it was reached */
    GW_SOURCE_SILENT,         /* it was reached, or listens, but nothing has come */
    GW_SOURCE_SEEKS,          /* on the way, nothing to tell yet */
    GW_SOURCE_UNRESOLVED,     /* the host's name; detail: why */
    GW_SOURCE_REFUSED,        /* the machine is there, its port is closed */
    GW_SOURCE_NO_ANSWER,      /* a firewall drops it, or the machine is off */
    GW_SOURCE_NO_ROUTE,       /* detail: why */
    GW_SOURCE_NO_GREETING,    /* connected, but it says nothing */
    GW_SOURCE_OTHER_PROTOCOL, /* what came is not this protocol */
    GW_SOURCE_OTHER_VERSION,  /* detail: which */
    GW_SOURCE_NO_SENDER,      /* connected, but it has no device of that name; detail: those that it has */
    GW_SOURCE_CLOSED          /* the peer ended the connection */
} gw_source_standing;

typedef struct gw_source_status {
    gw_source_standing standing;
    char detail[256];
    char address[24];    /* of the peer, numeric, with its port; "" while it is not known */
    char version[16];    /* of the peer's protocol, where it tells */
    int64_t reached;     /* ns, gw_now_ns clock: when the peer was last reached; 0: never */
    int64_t first_event; /* ns: the first event since then; 0: none */
} gw_source_status;

typedef struct gw_source gw_source;

/* spec names what is to be read; `gazewall doctor --help` and docs/tracks.md list the forms:
 *   NAME@HOST[:PORT], vrpn:NAME@HOST[:PORT]   VRPN over TCP, in metres; vrpn+udp:... has poses by UDP
 *   dtrack:[ADDRESS:]PORT                      DTrack datagrams, in mm; a multicast address is joined, of
 *                                              any other only that controller's datagrams are taken
 *   gaze:[ADDRESS:]PORT                        gaze datagrams (docs/gaze-datagram.md), in metres
 *   path:FILE, mouse, null                     scripted path, in metres; the window's pointer; nothing
 * GW_BAD_INPUT names a form that is wrong; GW_MACHINE what the network refused (port in use). That a peer
 * cannot be reached now is no error: it is sought every second. */
gw_code gw_source_open(const char *spec, const gw_source_options *options, gw_source **out, gw_error *error);
/* 1 when a spec has one of these forms, right or wrong in the rest. */
int gw_source_is(const char *spec);
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
void gw_source_look(const gw_source *source, int64_t now, gw_source_status *out);

/* The mouse: what the window's pointer means, as an event with its arrival, passed on at the next poll. From
 * any thread; 0 when the source is none, or when 256 events wait. */
int gw_source_mouse_push(gw_source *source, const gw_tracking_event *event);

#endif
