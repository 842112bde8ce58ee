#include "wall/link.h"

#include "base/clock.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

_Static_assert(GW_MAXIMUM_TILES <= 64, "gw_link.lost has a bit for each tile");

enum { PROGRESS_INTERVAL_MS = 50, PATIENCE_S = 5, WELCOME_MS = 30000, LAST_BREATH_S = 3 };

/* --- sending
 * ---------------------------------------------------------------------------------------------- */

static void send_message(gw_link *link, gw_link_kind kind, int32_t value, double fraction, const char *text,
                         int wait) {
    if (link->line.socket < 0)
        return;
    pthread_mutex_lock(&link->access);
    /* A launcher that is gone needs no message; this process is about to be ended, too. */
    (void)gw_line_send(&link->line, kind, value, fraction, text, wait);
    pthread_mutex_unlock(&link->access);
}

void gw_link_send(gw_link *link, gw_link_kind kind, int32_t value, const char *text) {
    if (link->line.socket < 0 && kind == GW_LINK_PRINT)
        puts(text);
    if (link->line.socket < 0 && kind == GW_LINK_FAILED)
        fprintf(stderr, "gazewall rank: %s\n", text);
    send_message(link, kind, value, 0, text, 1);
}

void gw_link_promise(gw_link *link, double seconds) {
    send_message(link, GW_LINK_PROMISE, 0, seconds, "", 0);
}

static void send_line(void *context, gw_log_level level, const char *text) {
    gw_link *link = context;
    if (link->line.socket < 0)
        fprintf(stderr, "gazewall rank: %s: %s\n", gw_log_level_name(level), text);
    send_message(link, GW_LINK_LOG, (int32_t)level, 0, text, 0);
}

static void send_progress(void *context, const char *what, double fraction) {
    gw_link *link = context;
    int64_t now = gw_now_ns();
    if (now - link->last_progress < PROGRESS_INTERVAL_MS * INT64_C(1000000))
        return;
    link->last_progress = now;
    send_message(link, GW_LINK_PROGRESS, 0, fraction, what, 0);
}

/* --- listening
 * -------------------------------------------------------------------------------------------- */

static void note_death(gw_link *link, const gw_link_message *m) {
    if (m->value < 0 || m->value >= GW_MAXIMUM_TILES || !(m->fraction >= 0 && m->fraction <= UINT32_MAX))
        return;
    gw_death *death = &link->deaths[m->value];
    pthread_mutex_lock(&link->access);
    *death = (gw_death){.tile = (uint32_t)m->value, .start = (uint32_t)m->fraction};
    snprintf(death->how, sizeof death->how, "%.255s", m->text);
    pthread_mutex_unlock(&link->access);
    atomic_fetch_or(&link->lost, 1ull << m->value);
}

static void take(gw_link *link, const gw_link_message *m) {
    switch ((gw_link_kind)m->kind) {
    case GW_LINK_PING:
        send_message(link, GW_LINK_PONG, 0, 0, "", 0);
        break;
    case GW_LINK_LOST:
        note_death(link, m);
        break;
    case GW_LINK_STOP:
        atomic_store(&link->stop, m->value);
        break;
    case GW_LINK_ROOT_LOST:
        if (!atomic_load(&link->root_lost))
            snprintf(link->root_text, sizeof link->root_text, "%.255s", m->text);
        atomic_store(&link->root_lost, 1);
        break;
    default:
        break;
    }
}

static void *listen_to_launcher(void *context) {
    gw_link *link = context;
    for (;;) {
        struct pollfd wait = {.fd = link->line.socket, .events = POLLIN};
        if (poll(&wait, 1, -1) < 0)
            continue;
        gw_link_message message;
        int got;
        while ((got = gw_line_receive(&link->line, &message)) > 0)
            take(link, &message);
        if (got < 0)
            break;
    }
    /* Nobody is left who would end this process. The signal lets a file be finished that is being written. */
    kill(getpid(), SIGTERM);
    sleep(LAST_BREATH_S);
    kill(getpid(), SIGKILL);
    return NULL;
}

static gw_code start_reader(gw_link *link, gw_error *error) {
    sigset_t all, before;
    sigfillset(&all);
    /* Signals are the main thread's. */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&link->reader, NULL, listen_to_launcher, link);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed ? gw_fail(error, GW_MACHINE, "no thread to listen to the launcher: %s", strerror(failed))
                  : GW_OK;
}

int gw_link_poll_lost(gw_link *link, gw_death *out) {
    unsigned long long lost = atomic_load(&link->lost);
    if (!lost)
        return 0;
    const uint32_t tile = (uint32_t)__builtin_ctzll(lost);
    atomic_fetch_and(&link->lost, ~(1ull << tile));
    pthread_mutex_lock(&link->access);
    *out = link->deaths[tile];
    pthread_mutex_unlock(&link->access);
    return 1;
}

const char *gw_link_root_lost(gw_link *link) {
    return atomic_load(&link->root_lost) ? link->root_text : NULL;
}

int gw_link_stop(gw_link *link) {
    return atomic_load(&link->stop);
}

/* --- connecting
 * ------------------------------------------------------------------------------------------- */

static int connect_here(const char *name) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    size_t length = strnlen(name, sizeof address.sun_path - 1);
    memcpy(address.sun_path + 1, name, length);
    socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + length);
    int made = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (made < 0 || !connect(made, (struct sockaddr *)&address, size))
        return made;
    int failed = errno;
    close(made);
    errno = failed;
    return -1;
}

/* ADDRESS:PORT, both numeric; the address may have colons of its own. */
static int connect_network(const char *name) {
    char address[96];
    snprintf(address, sizeof address, "%s", name);
    char *port = strrchr(address, ':');
    const struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    errno = EINVAL;
    if (!port)
        return -1;
    *port++ = '\0';
    if (getaddrinfo(address, port, &hints, &found))
        return -1;
    int made = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, found->ai_protocol);
    if (made >= 0) {
        /* The time to send bounds the time to connect, too. */
        gw_line_prepare(made, 1, PATIENCE_S);
        if (connect(made, found->ai_addr, found->ai_addrlen)) {
            int failed = errno;
            close(made);
            made = -1;
            errno = failed;
        }
    }
    freeaddrinfo(found);
    return made;
}

static gw_code say_hello(gw_link *link, int rank, gw_error *error) {
    const char *job = getenv("OMPI_MCA_ess_base_jobid"), *secret = getenv(GW_LINK_SECRET);
    gw_hello hello = {.pid = getpid()};
    gw_code code = gw_program_hash(hello.program, error);
    if (code)
        return code;
    hello.job = job ? (uint32_t)strtoul(job, NULL, 10) : 0;
    snprintf(hello.secret, sizeof hello.secret, "%s", secret ? secret : "-");
    if (gethostname(hello.host, sizeof hello.host - 1) || !hello.host[0])
        snprintf(hello.host, sizeof hello.host, "unknown");
    char text[GW_LINK_TEXT];
    gw_hello_write(&hello, text);
    gw_line_send(&link->line, GW_LINK_HELLO, rank, 0, text, 1);
    const int64_t deadline = gw_now_ns() + WELCOME_MS * INT64_C(1000000);
    for (int64_t left; (left = (deadline - gw_now_ns()) / 1000000) > 0;) {
        struct pollfd wait = {.fd = link->line.socket, .events = POLLIN};
        if (poll(&wait, 1, (int)left) < 0 && errno != EINTR)
            break;
        gw_link_message message;
        int got = gw_line_receive(&link->line, &message);
        if (got < 0)
            break;
        if (got && message.kind == GW_LINK_WELCOME) {
            snprintf(link->door, sizeof link->door, "%.63s", message.text);
            return GW_OK;
        }
    }
    return gw_fail(error, GW_MACHINE, "the launcher did not welcome rank %d", rank);
}

gw_code gw_link_connect(const char *name, int rank, gw_link *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    out->line.socket = -1;
    out->log =
        (gw_log){.threshold = GW_LOG_WARNING, .context = out, .line = send_line, .progress = send_progress};
    pthread_mutex_init(&out->access, NULL);
    if (!name)
        return GW_OK;
    int network = !strncmp(name, "tcp:", 4);
    out->line.socket = network ? connect_network(name + 4) : connect_here(name);
    if (out->line.socket < 0)
        return gw_fail(error, GW_MACHINE, "the launcher cannot be reached at %s: %s%s", name, strerror(errno),
                       network ? "; does a firewall stand between?" : "");
    gw_line_prepare(out->line.socket, network, PATIENCE_S);
    gw_code code = say_hello(out, rank, error);
    return code ? code : start_reader(out, error);
}
