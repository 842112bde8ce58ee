/* The doctor's look at the site's trackers: recordings, or sources that are opened as a run would open them
 * (tracking/source.h) and listened to for some seconds. What is in the way has a message of its own. */
#include "wall/doctor.h"

#include "base/clock.h"
#include "base/file.h"
#include "tracking/source.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t SECOND = 1000000000;
enum {
    PATIENCE_S = 8, /* for a peer that gives no sign */
    SILENCE_S = 4,  /* for the first report of one that was reached, or of datagrams */
    LISTEN_S = 1,   /* from the first report on */
    DESCRIPTORS = 8
};

#define FIND(finding, code, ...) gw_doctor_find(d, finding, code, "tracker", __VA_ARGS__)

/* What was heard. */
typedef struct hearing {
    uint64_t reports;
    uint64_t sensors; /* a bit each */
    int64_t first;    /* ns, gw_now_ns clock; 0: none */
    int64_t offset;   /* ns: the least of arrival less device time, both since 1970 */
    int timed;
} hearing;

static void hear(void *context, const gw_tracking_event *event) {
    hearing *h = context;
    if (event->kind == GW_EVENT_LINK)
        return;
    h->reports++;
    h->first = h->first ? h->first : event->arrival;
    if ((event->kind == GW_EVENT_POSE || event->kind == GW_EVENT_GAZE) && event->sensor >= 0 &&
        event->sensor < 64)
        h->sensors |= UINT64_C(1) << event->sensor;
    if (event->device_time == GW_NO_TIME)
        return;
    const int64_t offset = gw_unix_ns() - (gw_now_ns() - event->arrival) - event->device_time;
    h->offset = h->timed && h->offset < offset ? h->offset : offset;
    h->timed = 1;
}

static void wait_for(const gw_source *source) {
    struct pollfd wait[DESCRIPTORS];
    int descriptors[DESCRIPTORS];
    const int count = gw_source_descriptors(source, descriptors, DESCRIPTORS);
    for (int i = 0; i < count; i++)
        wait[i] = (struct pollfd){.fd = descriptors[i], .events = POLLIN};
    poll(wait, (nfds_t)count, 20);
}

/* Listens until it is known how things stand. *status: what was in the way first, for a source tries again by
 * itself. */
static void listen_to(gw_source *source, hearing *h, gw_source_status *status) {
    const int64_t begin = gw_now_ns();
    for (int64_t now = begin; now - begin < PATIENCE_S * SECOND; now = gw_now_ns()) {
        gw_source_poll(source, now, hear, h);
        gw_source_look(source, now, status);
        if (h->first && now - h->first >= LISTEN_S * SECOND)
            return;
        const int64_t since = status->reached ? status->reached : begin;
        if (!h->first && status->standing == GW_SOURCE_SILENT && now - since >= SILENCE_S * SECOND)
            return;
        if (!h->first && status->standing > GW_SOURCE_SEEKS)
            return;
        wait_for(source);
    }
}

static void sensors_text(uint64_t sensors, char *text, size_t size) {
    size_t used = (size_t)snprintf(text, size, "%s", sensors ? "sensors" : "no sensor");
    for (int i = 0; i < 64 && used + 8 < size; i++)
        if (sensors >> i & 1)
            used += (size_t)snprintf(text + used, size - used, " %d", i);
}

static void tell_clock(gw_doctor *d, const char *name, const hearing *h) {
    const double offset = (double)h->offset * 1e-9, notable = 0.5;
    if (!h->timed)
        FIND(GW_FINDING_MIND, GW_OK, "%s: its reports have no time: their ages count from arrival", name);
    else if (fabs(offset) >= notable)
        FIND(
            GW_FINDING_MIND, GW_OK,
            "%s: its clock is %.3f s %s this machine's: ages are told all the same, but recordings will have "
            "its time; a time server on both mends it",
            name, fabs(offset), offset > 0 ? "behind" : "ahead of");
    else
        FIND(GW_FINDING_GOOD, GW_OK, "%s: its clock and the way differ from this machine's by %.1f ms", name,
             1e3 * offset);
}

static void tell_reports(gw_doctor *d, const char *name, const hearing *h, const gw_source_status *s) {
    char sensors[128], version[32] = "";
    const int64_t since = s->reached && s->reached < h->first ? h->first - s->reached : 0;
    sensors_text(h->sensors, sensors, sizeof sensors);
    if (s->version[0])
        snprintf(version, sizeof version, " speaks VRPN %s,", s->version);
    FIND(GW_FINDING_GOOD, GW_OK, "%s at %s%s reports %s: the first after %.0f ms, %llu in %d s", name,
         s->address[0] ? s->address : "this machine", version, sensors, (double)since * 1e-6,
         (unsigned long long)h->reports, LISTEN_S);
    tell_clock(d, name, h);
}

static int is_by_datagram(const char *name) {
    return !strncmp(name, "dtrack:", 7) || !strncmp(name, "gaze:", 5);
}

static void tell_silence(gw_doctor *d, const char *name, const gw_source_status *s) {
    if (is_by_datagram(name))
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "%s: no datagram in %d s at %s: is the measurement on, does it send to this machine and port, "
             "and "
             "does no firewall drop it?",
             name, SILENCE_S, s->address);
    else if (s->version[0])
        FIND(GW_FINDING_MIND, GW_OK,
             "%s: %s speaks VRPN %s and has the device, but reported nothing in %d s: is anything tracked?",
             name, s->address, s->version, SILENCE_S);
    else
        FIND(GW_FINDING_GOOD, GW_OK, "%s has no device to ask", name);
}

static void tell_trouble(gw_doctor *d, const char *name, const gw_source_status *s) {
    switch (s->standing) {
    case GW_SOURCE_UNRESOLVED:
        FIND(GW_FINDING_WRONG, GW_BAD_INPUT, "%s: the host's name does not resolve: %s", name, s->detail);
        break;
    case GW_SOURCE_REFUSED:
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "%s: the machine is there, but %s is closed: start the VRPN server", name, s->address);
        break;
    case GW_SOURCE_NO_GREETING:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s: %s is open, but gave no VRPN greeting: is it another server?",
             name, s->address);
        break;
    case GW_SOURCE_OTHER_PROTOCOL:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s: what comes at %s is another protocol%s", name, s->address,
             is_by_datagram(name) ? "" : ": another program listens there");
        break;
    case GW_SOURCE_OTHER_VERSION:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s: %s speaks version %s, not %s", name, s->address, s->detail,
             is_by_datagram(name) ? "1" : "07: use a VRPN server of version 7");
        break;
    case GW_SOURCE_NO_SENDER:
        FIND(GW_FINDING_WRONG, GW_BAD_INPUT, "%s: %s speaks VRPN %s, but has no such device; it has: %s",
             name, s->address, s->version, s->detail);
        break;
    case GW_SOURCE_NO_ROUTE:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s: no way to %s: %s", name, s->address, s->detail);
        break;
    case GW_SOURCE_CLOSED:
        FIND(GW_FINDING_WRONG, GW_MACHINE, "%s: %s ended the connection: %s", name, s->address, s->detail);
        break;
    default:
        FIND(GW_FINDING_WRONG, GW_MACHINE,
             "%s: no answer from %s: a firewall drops it, or the machine is off%s", name, s->address,
             strncmp(name, "vrpn+udp:", 9) ? ""
                                           : "; by TCP (vrpn: instead of vrpn+udp:) firewalls are kinder");
        break;
    }
}

static void examine_source(gw_doctor *d, const gw_tracker_source *what) {
    const gw_source_options options = {.bind = what->bind};
    const char *name = what->spec;
    gw_source *source = NULL;
    gw_error error = {0};
    hearing h = {0};
    gw_source_status status = {0};
    if (gw_file_exists(name)) {
        FIND(GW_FINDING_GOOD, GW_OK, "%s is a recording", name);
        return;
    }
    if (gw_source_open(name, &options, &source, &error)) {
        FIND(GW_FINDING_WRONG, error.code, "%s", error.text);
        return;
    }
    listen_to(source, &h, &status);
    gw_source_close(&source);
    if (h.first)
        tell_reports(d, name, &h, &status);
    else if (status.standing == GW_SOURCE_SILENT)
        tell_silence(d, name, &status);
    else
        tell_trouble(d, name, &status);
}

void gw_doctor_tracker(gw_doctor *d) {
    for (uint32_t i = 0; i < d->site->trackers.source_count; i++)
        examine_source(d, &d->site->trackers.sources[i]);
}
