#include "tracking/host_lookup.h"

#include "base/memory.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

struct gw_host_lookup {
    char host[256];
    struct addrinfo hints;
    struct gaicb request;
    struct gaicb *list[1];
};

gw_code gw_host_lookup_start(const char *host, gw_host_lookup **out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_host_lookup), "looking up a host", error);
    if (code)
        return code;
    gw_host_lookup *lookup = memory;
    snprintf(lookup->host, sizeof lookup->host, "%s", host);
    lookup->hints = (struct addrinfo){.ai_family = AF_INET, .ai_socktype = SOCK_STREAM};
    lookup->request = (struct gaicb){.ar_name = lookup->host, .ar_request = &lookup->hints};
    lookup->list[0] = &lookup->request;
    const int failed = getaddrinfo_a(GAI_NOWAIT, lookup->list, 1, NULL);
    if (failed) {
        free(lookup);
        return gw_fail(error, GW_MACHINE, "the name '%s' cannot be looked up: %s", host,
                       gai_strerror(failed));
    }
    *out = lookup;
    return GW_OK;
}

int gw_host_lookup_settled(gw_host_lookup *lookup, char address[16], const char **why) {
    const int state = gai_error(&lookup->request);
    if (state == EAI_INPROGRESS)
        return 0;
    const struct addrinfo *found = state ? NULL : lookup->request.ar_result;
    if (!found || found->ai_family != AF_INET) {
        *why = gai_strerror(state ? state : EAI_NODATA);
        return -1;
    }
    const struct sockaddr_in *at = (const struct sockaddr_in *)(const void *)found->ai_addr;
    inet_ntop(AF_INET, &at->sin_addr, address, 16);
    return 1;
}

void gw_host_lookup_end(gw_host_lookup **lookup) {
    gw_host_lookup *ended = *lookup;
    *lookup = NULL;
    if (!ended)
        return;
    if (gai_error(&ended->request) == EAI_INPROGRESS && gai_cancel(&ended->request) == EAI_NOTCANCELED)
        return; /* the library still writes into it */
    if (ended->request.ar_result)
        freeaddrinfo(ended->request.ar_result);
    free(ended);
}
