/* Servers, sources and peers of one test on 127.0.0.1: polled together by hand until something holds, under a
 * generous deadline. Header only. */
#ifndef GW_TESTS_SUPPORT_LOOPBACK_H
#define GW_TESTS_SUPPORT_LOOPBACK_H

#include "base/clock.h"
#include "tests/support/check.h"
#include "tracking/server.h"
#include "tracking/socket.h"
#include "tracking/source.h"

#include <unistd.h>

/* ns; the machine may be busy. */
#define LOOPBACK_DEADLINE INT64_C(30000000000)

/* Runs `step` until `condition` holds. */
#define loopback_until(step, condition)                                                                      \
    do {                                                                                                     \
        const int64_t loopback_end = gw_now_ns() + LOOPBACK_DEADLINE;                                        \
        for (;;) {                                                                                           \
            step;                                                                                            \
            if (condition)                                                                                   \
                break;                                                                                       \
            if (gw_now_ns() > loopback_end)                                                                  \
                fail_msg("never: %s", #condition);                                                           \
            usleep(200);                                                                                     \
        }                                                                                                    \
    } while (0)

/* The events of a source, in order. */
typedef struct loopback_events {
    size_t count;
    gw_tracking_event events[4096];
} loopback_events;

static inline void loopback_keep(void *context, const gw_tracking_event *event) {
    loopback_events *kept = context;
    if (kept->count < sizeof kept->events / sizeof kept->events[0])
        kept->events[kept->count++] = *event;
}

static inline size_t loopback_kind(const loopback_events *kept, gw_tracking_event_kind kind) {
    size_t count = 0;
    for (size_t i = 0; i < kept->count; i++)
        count += kept->events[i].kind == kind;
    return count;
}

static inline gw_source *loopback_source(const char *spec) {
    const gw_source_options options = {.bind = "127.0.0.1"};
    gw_source *source = NULL;
    check_ok(gw_source_open(spec, &options, &source, &error));
    return source;
}

static inline gw_server *loopback_server(const char *spec) {
    gw_server *server = NULL;
    check_ok(gw_server_open(spec, NULL, &server, &error));
    return server;
}

static inline gw_source_standing loopback_standing(const gw_source *source, int64_t now) {
    gw_source_status status;
    gw_source_look(source, now, &status);
    return status.standing;
}

#endif
