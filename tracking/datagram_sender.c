/* What all servers have in common that send datagrams to one address. */
#include "tracking/server_internal.h"

#include "base/memory.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static void close_sender(gw_server *server) {
    gw_datagram_sender *sender = (gw_datagram_sender *)server;
    gw_socket_close(&sender->socket);
    free(sender);
}

gw_code gw_datagram_sender_open(size_t size, const gw_endpoint *to, gw_server **out, gw_error *error) {
    const gw_endpoint anywhere = {.port = 0};
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, size, "sender of datagrams", error);
    if (code)
        return code;
    gw_datagram_sender *sender = memory;
    sender->to = *to;
    sender->base.port = to->port;
    sender->base.close = close_sender;
    sender->socket = gw_socket_datagrams(&anywhere, NULL, NULL);
    if (sender->socket < 0) {
        code = gw_fail(error, GW_MACHINE, "no socket for datagrams: %s", strerror(errno));
        free(sender);
        return code;
    }
    *out = &sender->base;
    return GW_OK;
}

void gw_datagram_sender_send(gw_datagram_sender *sender, const void *bytes, size_t size) {
    if (gw_socket_send_to(sender->socket, &sender->to, bytes, size) > 0)
        sender->base.counters.messages++;
    else
        sender->base.counters.unreachable++;
}
