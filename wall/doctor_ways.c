/* The doctor's look at the ways between hosts: the ranks of a wall speak to each other, not only to the
 * launcher, on ports that the system chooses, and what drops that silently makes the run hang while it
 * loads. */
#include "wall/doctor.h"

#include <inttypes.h>
#include <stdio.h>

enum { ANSWER_MS = 10000 };

#define FIND(finding, ...) gw_doctor_find(d, finding, GW_MACHINE, __VA_ARGS__)

static const char *address_of(const gw_doctor *d, uint32_t host) {
    const gw_host *h = &d->hosts->host[host];
    return h->here ? d->hosts->listen : h->address;
}

/* A port of the host that takes connections; 0: told, and left alone. */
static unsigned listen_there(gw_doctor *d, uint32_t host, gw_examiner *e) {
    char request[128];
    gw_error error = {0};
    json_t *answer;
    snprintf(request, sizeof request, "listen %s", address_of(d, host));
    if (gw_examiner_ask(e, request, ANSWER_MS, &answer, &error)) {
        FIND(
            GW_FINDING_WRONG, d->hosts->host[host].name,
            "it does not listen at %s: %s; the address by which this machine knows it must be one of its own",
            address_of(d, host), error.text);
        return 0;
    }
    const json_int_t port = json_integer_value(json_object_get(answer, "port"));
    json_decref(answer);
    return port > 0 && port < 65536 ? (unsigned)port : 0;
}

static int examine_way(gw_doctor *d, gw_examiner *from, uint32_t a, uint32_t b, unsigned port) {
    char request[128];
    gw_error error = {0};
    json_t *answer;
    const char *to = d->hosts->host[b].name;
    snprintf(request, sizeof request, "back %s %u", address_of(d, b), port);
    gw_code code = gw_examiner_ask(from, request, ANSWER_MS, &answer, &error);
    if (code)
        FIND(
            GW_FINDING_WRONG, d->hosts->host[a].name,
            "from there %s is not reached at %s port %u: %s; let ports 1024 to 65535 of this network through "
            "the firewalls of both",
            to, address_of(d, b), port, error.text);
    else
        json_decref(answer);
    return !code;
}

void gw_doctor_ways(gw_doctor *d, gw_examiner *const *hosts) {
    unsigned ports[GW_MAXIMUM_TILES] = {0};
    uint32_t ways = 0, good = 0;
    if (d->hosts->remote == 0)
        return;
    for (uint32_t i = 0; i < d->hosts->count; i++)
        ports[i] = hosts[i] ? listen_there(d, i, hosts[i]) : 0;
    for (uint32_t a = 0; a < d->hosts->count; a++)
        for (uint32_t b = 0; b < d->hosts->count; b++)
            if (a != b && hosts[a] && ports[b]) {
                ways++;
                good += (uint32_t)examine_way(d, hosts[a], a, b, ports[b]);
            }
    if (ways && good == ways)
        FIND(GW_FINDING_GOOD, "hosts", "each reaches each other (%" PRIu32 " ways)", ways);
}
