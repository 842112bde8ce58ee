/* What the files of the VRPN client share: tracking/vrpn_client.c connects and keeps the connection,
 * vrpn_client_messages.c makes events of what the server says. */
#ifndef GW_TRACKING_VRPN_CLIENT_INTERNAL_H
#define GW_TRACKING_VRPN_CLIENT_INTERNAL_H

#include "tracking/host_lookup.h"
#include "tracking/source_internal.h"
#include "tracking/vrpn_message.h"

enum { GW_VRPN_CLIENT_BUTTONS = 256 };

/* How far the connection is. */
typedef enum gw_vrpn_phase {
    GW_VRPN_WAITING,
    GW_VRPN_LOOKING_UP,
    GW_VRPN_CONNECTING,
    GW_VRPN_CALLING,
    GW_VRPN_GREETING,
    GW_VRPN_SERVED
} gw_vrpn_phase;

typedef struct gw_vrpn_client {
    gw_source base;
    int by_datagram;
    char device[GW_VRPN_NAME], host[256];
    gw_endpoint server;
    char peer[16]; /* where the connection leads, and datagrams come from */
    gw_host_lookup *lookup;
    gw_vrpn_phase phase;
    int64_t deadline; /* of the phase: when to try again, or to give up */
    int64_t again;    /* when to be polled at the latest */
    int stream, listening, datagrams;
    uint16_t listening_port, datagram_port;
    char own_address[16];
    size_t in_size;
    /* health */
    int64_t last_heard, last_ping, first_unanswered; /* ns; first_unanswered 0: no ping waits for its pong */
    int ponged, warned;
    /* of this connection */
    uint8_t is_ours[GW_VRPN_IDS], types[GW_VRPN_IDS]; /* types: what they are to us; 0: not described */
    int sender_known, senders_told;
    char senders[200]; /* the names of the server's devices */
    uint8_t pressed[GW_VRPN_CLIENT_BUTTONS];
    int axis_count;
    double axes[GW_VRPN_CHANNELS];
    uint8_t in[GW_VRPN_HEADER + GW_VRPN_PAYLOAD + 8];
} gw_vrpn_client;

/* One message of the server's, counted and made into events. */
void gw_vrpn_client_take(gw_vrpn_client *client, const gw_vrpn_message *message, int64_t arrival);

#endif
