#include "wall/link.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

enum { PROGRESS_INTERVAL_MS = 50 };

/* The abstract name: a zero byte, then the name. */
static socklen_t make_address(const char *name, struct sockaddr_un *out) {
    memset(out, 0, sizeof *out);
    out->sun_family = AF_UNIX;
    size_t length = strlen(name);
    if (length > sizeof out->sun_path - 1)
        length = sizeof out->sun_path - 1;
    memcpy(out->sun_path + 1, name, length);
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + length);
}

gw_code gw_link_listen(char name[64], int *listener, gw_error *error) {
    uint64_t nonce = 0;
    if (getrandom(&nonce, sizeof nonce, 0) != (ssize_t)sizeof nonce)
        return gw_fail(error, GW_MACHINE, "the kernel gives no random numbers: %s", strerror(errno));
    snprintf(name, 64, "gazewall-%ld-%016llx", (long)getpid(), (unsigned long long)nonce);
    struct sockaddr_un address;
    socklen_t length = make_address(name, &address);
    int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (made < 0 || bind(made, (struct sockaddr *)&address, length) || listen(made, 128)) {
        gw_fail(error, GW_MACHINE, "the line to the ranks could not be opened: %s", strerror(errno));
        if (made >= 0)
            close(made);
        return GW_MACHINE;
    }
    *listener = made;
    return GW_OK;
}

int gw_link_accept(int listener, pid_t *pid) {
    for (;;) {
        int taken = accept4(listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (taken < 0)
            return -1;
        struct ucred who;
        socklen_t size = sizeof who;
        if (!getsockopt(taken, SOL_SOCKET, SO_PEERCRED, &who, &size) && who.uid == geteuid()) {
            *pid = who.pid;
            return taken;
        }
        close(taken);
    }
}

int gw_link_receive(int socket, gw_link_message *out) {
    ssize_t size = recv(socket, out, sizeof *out, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR))
        return 0;
    size_t head = offsetof(gw_link_message, text);
    if (size < (ssize_t)head)
        return -1;
    size_t text = (size_t)size - head;
    out->text[text < sizeof out->text ? text : sizeof out->text - 1] = '\0';
    return 1;
}

static void send_message(const gw_link *line, gw_link_message *message, const char *text, int flags) {
    size_t length = strlen(text);
    if (length > sizeof message->text - 1)
        length = sizeof message->text - 1;
    memcpy(message->text, text, length);
    /* A launcher that is gone needs no message; this process is about to be ended, too. */
    (void)!send(line->socket, message, offsetof(gw_link_message, text) + length, flags | MSG_NOSIGNAL);
}

void gw_link_send(gw_link *line, gw_link_kind kind, int32_t value, const char *text) {
    gw_link_message message = {.kind = (int32_t)kind, .value = value};
    send_message(line, &message, text, 0);
}

void gw_link_promise(gw_link *line, double seconds) {
    gw_link_message message = {.kind = GW_LINK_PROMISE, .fraction = seconds};
    send_message(line, &message, "", MSG_DONTWAIT);
}

static void send_line(void *context, gw_log_level level, const char *text) {
    gw_link_message message = {.kind = GW_LINK_LOG, .value = (int32_t)level};
    send_message(context, &message, text, MSG_DONTWAIT);
}

static void send_progress(void *context, const char *what, double fraction) {
    gw_link *line = context;
    int64_t now = gw_now_ns();
    if (now - line->last_progress < PROGRESS_INTERVAL_MS * INT64_C(1000000))
        return;
    line->last_progress = now;
    gw_link_message message = {.kind = GW_LINK_PROGRESS, .fraction = fraction};
    send_message(line, &message, what, MSG_DONTWAIT);
}

gw_code gw_link_connect(const char *name, int rank, gw_log_level threshold, gw_link *out, gw_error *error) {
    struct sockaddr_un address;
    socklen_t length = make_address(name, &address);
    memset(out, 0, sizeof *out);
    out->socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    if (out->socket < 0 || connect(out->socket, (struct sockaddr *)&address, length)) {
        gw_fail(error, GW_MACHINE,
                "the launcher cannot be reached (%s); a rank is started by gazewall sim only",
                strerror(errno));
        if (out->socket >= 0)
            close(out->socket);
        return GW_MACHINE;
    }
    struct timeval patience = {.tv_sec = 5};
    setsockopt(out->socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    out->log = (gw_log){.threshold = threshold, .context = out, .line = send_line, .progress = send_progress};
    const char *job = getenv("OMPI_MCA_ess_base_jobid");
    gw_link_send(out, GW_LINK_HELLO, rank, job ? job : "");
    return GW_OK;
}
