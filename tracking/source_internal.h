/* What a protocol gives to tracking/source.c and has from it. A protocol's own struct begins with gw_source.
 */
#ifndef GW_TRACKING_SOURCE_INTERNAL_H
#define GW_TRACKING_SOURCE_INTERNAL_H

#include "tracking/socket.h"
#include "tracking/source.h"

#include <stddef.h>

/* The newest of a sensor. */
typedef struct gw_sensor_newest {
    int known;
    int64_t time;      /* device time, GW_NO_TIME: the protocol has none */
    double numbers[7]; /* of a pose */
    int has_sequence;
    uint32_t sequence;
} gw_sensor_newest;

struct gw_source {
    char spec[256];
    char bind[16];
    const gw_log *log;
    gw_source_counters counters;
    gw_source_status status;
    gw_sensor_newest newest[GW_SOURCE_SENSORS];
    int64_t last_arrival; /* of what was sent on: arrivals of a source never fall */
    gw_event_sink sink;   /* while it is polled */
    void *sink_context;
    void (*poll)(gw_source *source, int64_t now);
    int (*descriptors)(const gw_source *source, int *descriptors, int room);   /* NULL: none */
    int64_t (*next)(const gw_source *source);                                  /* NULL: never */
    void (*look)(const gw_source *source, int64_t now, gw_source_status *out); /* NULL: status as it is */
    void (*close)(gw_source *source); /* frees it; copes with one that is not open yet */
};

/* --- making events; arrival is ns on the gw_now_ns clock */

/* Sends any event on. */
void gw_source_emit(gw_source *source, const gw_tracking_event *event);
/* A pose, if its numbers are some and it is newer than the sensor's last one; the orientation is normalised.
 * A quality below 0 says that the sensor is not tracked. */
void gw_source_emit_pose(gw_source *source, gw_tracking_event *event);
/* The peer was reached, or lost. */
void gw_source_emit_link(gw_source *source, int up, int64_t arrival);

typedef enum gw_source_order { GW_ORDER_NEWER, GW_ORDER_SAME, GW_ORDER_OLDER } gw_source_order;
/* Where a sequence number (of 32 bits, around zero) stands to the sensor's newest; counts what is missing
 * between. A jump back is a sender that began anew. */
gw_source_order gw_source_sequence(gw_source *source, int sensor, uint32_t sequence);

/* --- listeners of datagrams: a protocol's own struct begins with this */

typedef struct gw_datagram_source {
    gw_source base;
    int socket;
    gw_endpoint only; /* the one sender whose datagrams count; no address: any */
    int64_t last;     /* ns: the last datagram of the protocol, which says so itself */
} gw_datagram_source;

/* Allocates `size` bytes, all 0, and listens at [ADDRESS:]PORT: joins a group, or remembers the only sender.
 */
gw_code gw_datagram_source_open(const gw_source *like, const char *where, size_t size, const char *what,
                                void (*poll)(gw_source *source, int64_t now), gw_datagram_source **out,
                                gw_error *error);
/* The next datagram: its bytes, or -1. From others than the only sender are counted and passed over. */
ptrdiff_t gw_datagram_source_next(gw_datagram_source *source, uint8_t *bytes, size_t size, int64_t now,
                                  int64_t *arrival);
/* After all that came by `now`: a sender that was silent for 2 s is lost. */
void gw_datagram_source_watch(gw_datagram_source *source, int64_t now);
/* By when (ns) it must be polled to see that. */
int64_t gw_datagram_source_wakes(const gw_source *source);

/* --- the protocols: *out is allocated and filled; source.c sets spec, bind and log first in `like` */

gw_code gw_vrpn_client_open(const gw_source *like, const char *where, int datagrams, gw_source **out,
                            gw_error *error);
gw_code gw_dtrack_source_open(const gw_source *like, const char *where, gw_source **out, gw_error *error);
gw_code gw_gaze_source_open(const gw_source *like, const char *where, gw_source **out, gw_error *error);
gw_code gw_path_source_open(const gw_source *like, const char *path, gw_source **out, gw_error *error);
gw_code gw_mouse_source_open(const gw_source *like, gw_source **out, gw_error *error);

#endif
