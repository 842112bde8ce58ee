/* Playing a recording to other programs: at its own pace or another, over and over, or step by step. */
#include "wall/replay.h"

#include "base/clock.h"
#include "tracking/server.h"
#include "wall/interrupt.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { DESCRIPTORS = 64, LONGEST_WAIT_MS = 50 };
static const int64_t STEP = 2000000; /* ns: events that are no further apart belong to one step */

typedef struct player {
    const gw_recording *recording;
    const gw_replay_pace *pace;
    const gw_log *log;
    gw_server *server;
    int64_t begun, begun_unix; /* ns: when this lap began, monotonic and since 1970 */
} player;

static int64_t unix_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Serves clients until `until` (ns), or until something is typed where `typed` is not NULL, or a signal. */
static void serve_until(player *p, int64_t until, int *typed) {
    for (;;) {
        struct pollfd wait[DESCRIPTORS + 1] = {{.fd = STDIN_FILENO, .events = POLLIN}};
        int descriptors[DESCRIPTORS];
        int64_t now = gw_now_ns();
        gw_server_poll(p->server, now);
        if (now >= until || gw_interrupt_pending())
            return;
        const int first = typed == NULL;
        const int count = gw_server_descriptors(p->server, descriptors, DESCRIPTORS);
        for (int i = 0; i < count; i++)
            wait[1 + i] = (struct pollfd){.fd = descriptors[i], .events = POLLIN};
        /* To the microsecond: a track's samples may be 1 ms apart. */
        const int64_t rest = until - now, most = (int64_t)LONGEST_WAIT_MS * 1000000;
        const struct timespec pause = {.tv_nsec = (long)(rest < most ? rest : most)};
        if (ppoll(wait + first, (nfds_t)(1 + count - first), &pause, NULL) > 0 && typed != NULL &&
            wait[0].revents != 0) {
            *typed = 1;
            return;
        }
    }
}

/* The device's clock moves along with ours: what it said at the recording's start, it says now. */
static void send_event(player *p, const gw_tracking_event *recorded) {
    gw_tracking_event event = *recorded;
    if (p->pace->speed > 0.0 && event.device_time != GW_NO_TIME)
        event.device_time = p->begun_unix + (int64_t)((double)(event.device_time - p->recording->start -
                                                               p->recording->events[0].event.arrival) /
                                                      p->pace->speed);
    else
        event.device_time = GW_NO_TIME;
    gw_server_send(p->server, &event);
}

static void play_once(player *p) {
    const gw_recorded_event *events = p->recording->events;
    const int64_t start = events[0].event.arrival;
    p->begun = gw_now_ns();
    p->begun_unix = unix_now();
    for (size_t i = 0; i < p->recording->count && !gw_interrupt_pending();) {
        const double passed = (double)(events[i].event.arrival - start) / p->pace->speed;
        serve_until(p, p->begun + (int64_t)passed, NULL);
        const int64_t moment = events[i].event.arrival;
        for (; i < p->recording->count && events[i].event.arrival == moment; i++)
            send_event(p, &events[i].event);
        gw_server_poll(p->server, gw_now_ns());
        gw_log_progress(p->log, "playing", (double)i / (double)p->recording->count);
    }
}

/* One line of standard input: the end of it is the end. Half a line may wait for ever, so signals end that.
 */
static int read_line(void) {
    char c = 0;
    ssize_t got;
    gw_interrupt_release();
    while ((got = read(STDIN_FILENO, &c, 1)) == 1 && c != '\n')
        ;
    gw_interrupt_hold();
    return got == 1;
}

static void play_steps(player *p) {
    const gw_recorded_event *events = p->recording->events;
    size_t i = 0;
    for (int typed = 0; i < p->recording->count; typed = 0) {
        while (!typed && !gw_interrupt_pending())
            serve_until(p, gw_now_ns() + 1000000000, &typed);
        if (!typed || !read_line())
            return;
        const int64_t moment = events[i].event.arrival;
        size_t first = i;
        for (; i < p->recording->count && events[i].event.arrival <= moment + STEP; i++)
            send_event(p, &events[i].event);
        gw_server_poll(p->server, gw_now_ns());
        printf("%.6f s, %zu events, %zu to come\n", (double)moment * 1e-9, i - first,
               p->recording->count - i);
        fflush(stdout);
        if (i == p->recording->count && p->pace->loop)
            i = 0;
    }
}

static void tell(const player *p, int quiet) {
    const gw_server_counters *c = gw_server_count(p->server);
    if (!quiet)
        printf("served       %s: %" PRIu64 " events, %" PRIu64 " unsendable, %" PRIu64 " clients, %" PRIu64
               " messages, %" PRIu64 " slow, %" PRIu64 " malformed\n",
               gw_server_name(p->server), c->events, c->unsendable, c->clients, c->messages, c->slow,
               c->malformed);
}

gw_code gw_replay_play(const gw_recording *recording, const gw_replay_pace *pace, const gw_log *log,
                       int quiet, int *interrupted, gw_error *error) {
    player p = {.recording = recording, .pace = pace, .log = log};
    const gw_server_options options = {.device = recording->senders[recording->events[0].sender], .log = log};
    gw_code code = gw_server_open(pace->serve, &options, &p.server, error);
    if (code != GW_OK)
        return code;
    if (!quiet) {
        printf("serving      %s\n", gw_server_name(p.server));
        fflush(stdout);
    }
    gw_interrupt_hold(); /* a signal ends it in good order */
    /* A track that nobody hears is played for nothing: the first client starts it. */
    while (pace->serve[0] == 'v' && gw_server_count(p.server)->connected == 0 && !gw_interrupt_pending())
        serve_until(&p, gw_now_ns() + 20000000, NULL);
    do {
        if (pace->speed > 0.0)
            play_once(&p);
        else
            play_steps(&p);
    } while (pace->loop && pace->speed > 0.0 && !gw_interrupt_pending());
    *interrupted = gw_interrupt_pending();
    tell(&p, quiet);
    gw_server_close(&p.server);
    return GW_OK;
}
