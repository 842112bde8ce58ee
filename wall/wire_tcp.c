#include "wall/wire_tcp.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

enum { HEAD = 8 };
static const char message_mark[4] = {'G', 'W', 'M', '1'}, block_mark[4] = {'G', 'W', 'B', '1'};

typedef struct tcp_wire {
    gw_wire wire;
    int socket;
    uint8_t outgoing[HEAD + GW_WIRE_MESSAGE], incoming[HEAD + GW_WIRE_MESSAGE];
    size_t out_size, out_done;         /* of outgoing, and sent of it */
    size_t in_done;                    /* bytes of incoming that have come */
    int sending, receiving;            /* a block, whose head has gone or come */
    size_t block_done, block_received; /* bytes of those blocks */
} tcp_wire;

static gw_wire_result verdict(ssize_t moved) {
    return moved < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) ? GW_WIRE_NOT_YET
                                                                                    : GW_WIRE_BROKEN;
}

static gw_wire_result push(int socket, const uint8_t *bytes, size_t size, size_t *done) {
    while (*done < size) {
        ssize_t moved = send(socket, bytes + *done, size - *done, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (moved <= 0)
            return verdict(moved);
        *done += (size_t)moved;
    }
    return GW_WIRE_DONE;
}

static gw_wire_result pull(int socket, uint8_t *bytes, size_t size, size_t *done) {
    while (*done < size) {
        ssize_t moved = recv(socket, bytes + *done, size - *done, MSG_DONTWAIT);
        if (moved <= 0)
            return verdict(moved);
        *done += (size_t)moved;
    }
    return GW_WIRE_DONE;
}

static gw_wire_result flush_out(tcp_wire *w) {
    return push(w->socket, w->outgoing, w->out_size, &w->out_done);
}

static void put_head(tcp_wire *w, const char mark[4], size_t size, size_t body) {
    memcpy(w->outgoing, mark, 4);
    for (int i = 0; i < 4; i++)
        w->outgoing[4 + i] = (uint8_t)(size >> (8 * i));
    w->out_size = HEAD + body;
    w->out_done = 0;
}

static gw_wire_result send_message(gw_wire *wire, const void *message, size_t size) {
    tcp_wire *w = (tcp_wire *)wire;
    gw_wire_result before = flush_out(w);
    if (before != GW_WIRE_DONE)
        return before;
    if (w->sending || size > GW_WIRE_MESSAGE)
        return GW_WIRE_BROKEN;
    put_head(w, message_mark, size, size);
    memcpy(w->outgoing + HEAD, message, size);
    return flush_out(w) == GW_WIRE_BROKEN ? GW_WIRE_BROKEN : GW_WIRE_DONE;
}

/* A whole head: its size. */
static gw_wire_result take_head(tcp_wire *w, const char mark[4], size_t *size) {
    gw_wire_result result =
        w->in_done < HEAD ? pull(w->socket, w->incoming, HEAD, &w->in_done) : GW_WIRE_DONE;
    *size = 0;
    if (result == GW_WIRE_DONE)
        for (int i = 0; i < 4; i++)
            *size |= (size_t)w->incoming[4 + i] << (8 * i);
    /* Nonsense shows in its first bytes. */
    const size_t known = w->in_done < 4 ? w->in_done : 4;
    return memcmp(w->incoming, mark, known) ? GW_WIRE_BROKEN : result;
}

static gw_wire_result receive_message(gw_wire *wire, void *message, size_t *size) {
    tcp_wire *w = (tcp_wire *)wire;
    /* What the kernel did not take before goes on its way now. */
    if (flush_out(w) == GW_WIRE_BROKEN || w->receiving)
        return GW_WIRE_BROKEN;
    gw_wire_result result = take_head(w, message_mark, size);
    if (result != GW_WIRE_DONE)
        return result;
    if (*size > GW_WIRE_MESSAGE)
        return GW_WIRE_BROKEN;
    result = pull(w->socket, w->incoming, HEAD + *size, &w->in_done);
    if (result != GW_WIRE_DONE)
        return result;
    memcpy(message, w->incoming + HEAD, *size);
    w->in_done = 0;
    return GW_WIRE_DONE;
}

static gw_wire_result send_block(gw_wire *wire, const void *block, size_t size) {
    tcp_wire *w = (tcp_wire *)wire;
    gw_wire_result result = flush_out(w);
    if (result == GW_WIRE_DONE && !w->sending) {
        if (size > UINT32_MAX)
            return GW_WIRE_BROKEN;
        put_head(w, block_mark, size, 0);
        w->sending = 1;
        w->block_done = 0;
        result = flush_out(w);
    }
    if (result == GW_WIRE_DONE)
        result = push(w->socket, block, size, &w->block_done);
    if (result == GW_WIRE_DONE)
        w->sending = 0;
    return result;
}

static gw_wire_result receive_block(gw_wire *wire, void *block, size_t size) {
    tcp_wire *w = (tcp_wire *)wire;
    size_t announced;
    if (!w->receiving) {
        gw_wire_result result = take_head(w, block_mark, &announced);
        if (result != GW_WIRE_DONE)
            return result;
        if (announced != size)
            return GW_WIRE_BROKEN;
        w->receiving = 1;
        w->block_received = 0;
    }
    gw_wire_result result = pull(w->socket, block, size, &w->block_received);
    if (result == GW_WIRE_DONE)
        w->receiving = 0, w->in_done = 0;
    return result;
}

static int is_sent(gw_wire *wire) {
    tcp_wire *w = (tcp_wire *)wire;
    int waiting = 0;
    gw_wire_result result = flush_out(w);
    /* What the other end's machine has not acknowledged is lost if this process ends with something unread.
     */
    if (result == GW_WIRE_DONE && !ioctl(w->socket, SIOCOUTQ, &waiting))
        return waiting == 0;
    return result != GW_WIRE_NOT_YET;
}

static void close_wire(gw_wire *wire) {
    tcp_wire *w = (tcp_wire *)wire;
    close(w->socket);
    free(w);
}

gw_code gw_wire_tcp(int socket, gw_wire **out, gw_error *error) {
    const int on = 1;
    tcp_wire *w = NULL;
    *out = NULL;
    gw_code code = gw_allocate((void **)&w, 1, sizeof *w, "line to a tile", error);
    if (code) {
        close(socket);
        return code;
    }
    fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    w->socket = socket;
    w->wire = (gw_wire){.send = send_message,
                        .receive = receive_message,
                        .send_block = send_block,
                        .receive_block = receive_block,
                        .is_sent = is_sent,
                        .close = close_wire,
                        .descriptor = socket};
    *out = &w->wire;
    return GW_OK;
}
