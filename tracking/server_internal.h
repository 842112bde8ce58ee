/* What a protocol gives to tracking/server.c. */
#ifndef GW_TRACKING_SERVER_INTERNAL_H
#define GW_TRACKING_SERVER_INTERNAL_H

#include "tracking/server.h"
#include "tracking/socket.h"

struct gw_server {
    gw_server_counters counters;
    const gw_log *log;
    double unit; /* mm per unit of an event's position */
    char device[96];
    char name[160];
    uint16_t port;
    int takes_gazes; /* else those in the device's frame come as poses */
    void (*send)(gw_server *server, const gw_tracking_event *event, int64_t time); /* ns since 1970 */
    void (*poll)(gw_server *server, int64_t now);
    int (*descriptors)(const gw_server *server, int *descriptors, int room);
    void (*close)(gw_server *server); /* frees it */
};

/* A server that sends datagrams to one address begins with this. */
typedef struct gw_datagram_sender {
    gw_server base;
    int socket;
    gw_endpoint to;
} gw_datagram_sender;

/* Allocates `size` bytes that begin with it, zeros behind; the caller sets send and poll. */
gw_code gw_datagram_sender_open(size_t size, const gw_endpoint *to, gw_server **out, gw_error *error);
/* One datagram, counted. */
void gw_datagram_sender_send(gw_datagram_sender *sender, const void *bytes, size_t size);

/* Each fills all but what is common; `at` is where to listen or send to. */
gw_code gw_vrpn_server_open(const gw_endpoint *at, gw_server **out, gw_error *error);
gw_code gw_dtrack_sender_open(const gw_endpoint *at, gw_server **out, gw_error *error);
gw_code gw_gaze_sender_open(const gw_endpoint *at, gw_server **out, gw_error *error);

#endif
