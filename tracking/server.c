#include "tracking/server.h"

#include "base/clock.h"
#include "tracking/quaternion.h"
#include "tracking/server_internal.h"
#include "tracking/vrpn_message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VRPN, DTRACK, GAZE, PROTOCOLS };

static const struct {
    const char *name;
    gw_endpoint usual;
} protocols[PROTOCOLS] = {
    {"vrpn", {"", GW_VRPN_PORT}}, {"dtrack", {"127.0.0.1", 5000}}, {"gaze", {"127.0.0.1", 0}}};

static gw_code parse(const char *spec, int *protocol, gw_endpoint *at, gw_error *error) {
    for (*protocol = 0; *protocol < PROTOCOLS; ++*protocol) {
        const size_t length = strlen(protocols[*protocol].name);
        if (strncmp(spec, protocols[*protocol].name, length) != 0)
            continue;
        if (spec[length] != '\0' && spec[length] != ':')
            continue;
        *at = protocols[*protocol].usual;
        gw_code code = gw_endpoint_parse(spec + length + (spec[length] == ':'), spec, at, error);
        if (!code && *protocol != VRPN && at->port == 0)
            code = gw_fail(error, GW_BAD_INPUT, "%s: name the port to send to, as %s:7000", spec,
                           protocols[*protocol].name);
        return code;
    }
    return gw_fail(error, GW_BAD_INPUT,
                   "'%s' is no server; it is vrpn[:PORT], dtrack[:[ADDRESS:]PORT] or gaze:[ADDRESS:]PORT",
                   spec);
}

gw_code gw_server_check(const char *spec, gw_error *error) {
    int protocol;
    gw_endpoint at;
    return parse(spec, &protocol, &at, error);
}

gw_code gw_server_open(const char *spec, const gw_server_options *options, gw_server **out, gw_error *error) {
    const gw_server_options usual = {0};
    int protocol;
    gw_endpoint at;
    *out = NULL;
    if (!options)
        options = &usual;
    gw_code code = parse(spec, &protocol, &at, error);
    if (!code && options->device && (!options->device[0] || strlen(options->device) >= GW_VRPN_NAME))
        code = gw_fail(error, GW_BAD_INPUT, "'%s' is no device name: it has 1 to %d characters",
                       options->device, GW_VRPN_NAME - 1);
    if (!code && !(options->unit >= 0 && isfinite(options->unit)))
        code = gw_fail(error, GW_BAD_INPUT, "%g mm is no unit of positions", options->unit);
    if (code)
        return code;
    code = protocol == VRPN     ? gw_vrpn_server_open(&at, out, error)
           : protocol == DTRACK ? gw_dtrack_sender_open(&at, out, error)
                                : gw_gaze_sender_open(&at, out, error);
    if (code)
        return gw_context(error, "%s", spec);
    gw_server *server = *out;
    server->log = options->log;
    server->unit = options->unit > 0 ? options->unit : 1000;
    snprintf(server->device, sizeof server->device, "%s", options->device ? options->device : "Tracker0");
    if (protocol == VRPN)
        snprintf(server->name, sizeof server->name, "VRPN device %s on port %u", server->device,
                 (unsigned)server->port);
    else
        snprintf(server->name, sizeof server->name, "%s to %s port %u",
                 protocol == DTRACK ? "DTrack frames" : "gaze datagrams", at.address, (unsigned)at.port);
    return GW_OK;
}

void gw_server_close(gw_server **server) {
    if (*server)
        (*server)->close(*server);
    *server = NULL;
}

/* The pose of a gaze sensor, as docs/tracks.md has it. */
static void pose_of_gaze(const gw_tracking_event *gaze, gw_tracking_event *pose) {
    *pose = *gaze;
    pose->kind = GW_EVENT_POSE;
    pose->sensor = 2 * gaze->sensor + 1;
    pose->quality = gaze->quality > 0 ? 1 : -1;
    memcpy(pose->of.pose.position, gaze->of.gaze.origin, sizeof pose->of.pose.position);
    gw_turn_onto(gaze->of.gaze.direction, pose->of.pose.orientation);
}

void gw_server_send(gw_server *server, const gw_tracking_event *event) {
    gw_tracking_event pose;
    server->counters.events++;
    if (event->sensor < 0 || event->sensor >= GW_SERVER_SENSORS) {
        server->counters.unsendable++;
        return;
    }
    if (event->kind == GW_EVENT_GAZE && !server->takes_gazes && event->of.gaze.frame == GW_GAZE_IN_DEVICE &&
        event->sensor < GW_SERVER_SENSORS / 2) {
        pose_of_gaze(event, &pose);
        event = &pose;
    }
    server->send(server, event, event->device_time == GW_NO_TIME ? gw_unix_ns() : event->device_time);
}

void gw_server_poll(gw_server *server, int64_t now) {
    server->poll(server, now);
}

int gw_server_descriptors(const gw_server *server, int *descriptors, int room) {
    return server->descriptors ? server->descriptors(server, descriptors, room) : 0;
}

const gw_server_counters *gw_server_count(const gw_server *server) {
    return &server->counters;
}

uint16_t gw_server_port(const gw_server *server) {
    return server->port;
}

const char *gw_server_name(const gw_server *server) {
    return server->name;
}
