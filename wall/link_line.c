/* Messages on a stream of bytes: a head of 24 bytes, then so many bytes of text as it says, at most 2047. */
#include "wall/link.h"

#include "base/file.h"
#include "base/hash.h"

#include <errno.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

static const uint32_t magic = 0x4c4e5747; /* "GWNL" */

typedef struct head {
    uint32_t magic;
    int32_t kind, value;
    uint32_t length; /* of the text, without a zero byte */
    double fraction;
} head;

_Static_assert(sizeof(head) == 24, "gw_line has room for a head and a text");

/* Fills line->bytes up to `wanted`: 1 done, 0 not yet, -1 gone. */
static int fill(gw_line *line, size_t wanted) {
    while (line->filled < wanted) {
        ssize_t size = recv(line->socket, line->bytes + line->filled, wanted - line->filled, MSG_DONTWAIT);
        if (size < 0 && errno == EINTR)
            continue;
        if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            return 0;
        if (size <= 0) {
            errno = size < 0 ? errno : 0;
            return -1;
        }
        line->filled += (size_t)size;
    }
    return 1;
}

int gw_line_receive(gw_line *line, gw_link_message *out) {
    head h;
    int got = fill(line, sizeof h);
    if (got <= 0)
        return got;
    memcpy(&h, line->bytes, sizeof h);
    if (h.magic != magic || h.kind < 0 || h.kind >= GW_LINK_KINDS || h.length >= sizeof out->text)
        return -2;
    got = fill(line, sizeof h + h.length);
    if (got <= 0)
        return got;
    line->filled = 0;
    out->kind = h.kind;
    out->value = h.value;
    out->fraction = h.fraction;
    memcpy(out->text, line->bytes + sizeof h, h.length);
    out->text[h.length] = '\0';
    return 1;
}

int gw_line_send(gw_line *line, gw_link_kind kind, int32_t value, double fraction, const char *text,
                 int wait) {
    uint8_t bytes[sizeof(head) + GW_LINK_TEXT];
    size_t length = strnlen(text, GW_LINK_TEXT - 1);
    const head h = {.magic = magic,
                    .kind = (int32_t)kind,
                    .value = value,
                    .length = (uint32_t)length,
                    .fraction = fraction};
    memcpy(bytes, &h, sizeof h);
    memcpy(bytes + sizeof h, text, length);
    size_t total = sizeof h + length;
    for (size_t sent = 0; sent < total;) {
        /* A message that has gone in part must go whole, or the line is of no more use. */
        int flags = MSG_NOSIGNAL | (wait || sent ? 0 : MSG_DONTWAIT);
        ssize_t size = send(line->socket, bytes + sent, total - sent, flags);
        if (size > 0)
            sent += (size_t)size;
        else if (errno == EINTR)
            continue;
        else if (!sent)
            return errno == EAGAIN || errno == EWOULDBLOCK ? -1 : 0;
        else {
            shutdown(line->socket, SHUT_RDWR);
            return 0;
        }
    }
    return 0;
}

void gw_line_prepare(int socket, int network, int patience) {
    const struct timeval sending = {.tv_sec = patience};
    setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &sending, sizeof sending);
    if (!network)
        return;
    /* A pulled cable would otherwise show after minutes: TCP asks after 3 s of silence, and gives up 10 s
     * after the last answer. */
    const int on = 1, idle = 3, interval = 2, probes = 4, given_up_ms = 10000;
    setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &idle, sizeof idle);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &interval, sizeof interval);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
    setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &given_up_ms, sizeof given_up_ms);
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

void gw_line_close(gw_line *line) {
    if (line->socket >= 0)
        close(line->socket);
    line->socket = -1;
    line->filled = 0;
}

/* --- hello
 * ---------------------------------------------------------------------------------------------- */

int gw_same_secret(const char *a, const char *b) {
    unsigned char difference = 0;
    for (int i = 0; i < GW_SECRET_DIGITS; i++)
        difference |= (unsigned char)(a[i] ^ b[i]);
    return !difference;
}

gw_code gw_program_hash(char text[33], gw_error *error) {
    gw_bytes file = {0};
    gw_code code = gw_file_read("/proc/self/exe", 1u << 30, &file, error);
    if (code)
        return gw_fail(error, GW_MACHINE, "the program cannot read itself, /proc/self/exe");
    gw_hash_text(gw_hash_bytes((gw_hash){0, 0}, file.data, file.size), text);
    gw_bytes_finish(&file);
    return GW_OK;
}

void gw_hello_write(const gw_hello *hello, char text[GW_LINK_TEXT]) {
    snprintf(text, GW_LINK_TEXT, "%s %s %" PRIu32 " %ld %s", hello->secret, hello->program, hello->job,
             (long)hello->pid, hello->host);
}

int gw_hello_read(const char *text, gw_hello *out) {
    long pid = 0;
    memset(out, 0, sizeof *out);
    int fields =
        sscanf(text, "%32s %32s %" SCNu32 " %ld %63s", out->secret, out->program, &out->job, &pid, out->host);
    out->pid = (pid_t)pid;
    return fields == 5 && pid > 0 && strlen(out->secret) == GW_SECRET_DIGITS && strlen(out->program) == 32;
}
