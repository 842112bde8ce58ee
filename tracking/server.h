/* Servers of tracking events: what gives our poses to other programs. A VRPN server answers any VRPN client;
 * a DTrack sender sends frames as a DTrack controller does; a gaze sender the datagrams of
 * docs/gaze-datagram.md.
 *
 * No server waits for anybody: a client that does not read is dropped, and what comes from clients is bounded
 * and counted. A server belongs to the thread that opened it. What was sent leaves at the next
 * gw_server_poll(): send what belongs to one moment, then poll. */
#ifndef GW_TRACKING_SERVER_H
#define GW_TRACKING_SERVER_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/event.h"

#include <stdint.h>

enum { GW_SERVER_SENSORS = 64 }; /* sensors, buttons and axes 0 to 63 are served */

typedef struct gw_server_options {
    const char *device; /* what a VRPN client asks for; NULL: "Tracker0" */
    double unit;        /* mm per unit of the events' positions; 0: 1000, metres */
    const gw_log *log;
} gw_server_options;

typedef struct gw_server_counters {
    uint64_t events;      /* given to gw_server_send */
    uint64_t unsendable;  /* of them: the protocol has no place for it, or the sensor is beyond the last */
    uint64_t messages;    /* that left, over all clients */
    uint64_t clients;     /* that ever came, with a proper greeting */
    uint64_t refused;     /* of another version or protocol, or one too many */
    uint64_t slow;        /* dropped because they did not read */
    uint64_t unreachable; /* asked to be called back, but did not answer */
    uint64_t pings;       /* answered */
    uint64_t ignored;     /* requests that change nothing here, as set_update_rate */
    uint64_t malformed;   /* messages or datagrams that break the protocol */
    uint32_t connected;   /* clients now */
} gw_server_counters;

typedef struct gw_server gw_server;

/* spec:
 *   vrpn[:[ADDRESS:]PORT]     listens on that port, 3883 by default, of one interface or all; port 0: any
 *   dtrack[:[ADDRESS:]PORT]   sends to that address, 127.0.0.1 port 5000 by default; may be multicast
 *   gaze:[ADDRESS:]PORT       the same with gazes alone, 127.0.0.1 by default
 * ADDRESS is numeric IPv4. GW_BAD_INPUT names a form that is wrong; GW_MACHINE what the network refused. */
gw_code gw_server_open(const char *spec, const gw_server_options *options, gw_server **out, gw_error *error);
void gw_server_close(gw_server **server);

/* Whether a spec is one, without opening anything. */
gw_code gw_server_check(const char *spec, gw_error *error);

/* To all clients. The message is stamped with device_time; without one (GW_NO_TIME) with the moment of
 * sending. VRPN: poses, buttons, axes; what is not tracked is silent, as with all VRPN servers. DTrack: poses
 * are bodies, buttons and axes those of Flystick 0. Both: a gaze in the device's frame is the pose of sensor
 * 2 * viewer + 1, whose -z axis looks along it. */
void gw_server_send(gw_server *server, const gw_tracking_event *event);
/* Takes connections, answers, sends what is waiting. Never waits; call it several times a second. */
void gw_server_poll(gw_server *server, int64_t now);
/* Descriptors to poll() for reading between calls of gw_server_poll (at most `room`; returns how many). */
int gw_server_descriptors(const gw_server *server, int *descriptors, int room);

const gw_server_counters *gw_server_count(const gw_server *server);
uint16_t gw_server_port(const gw_server *server);    /* as listened to, or sent to */
const char *gw_server_name(const gw_server *server); /* "vrpn Tracker0 on port 3883", for messages */

#endif
