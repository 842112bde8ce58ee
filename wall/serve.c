#include "wall/serve.h"

#include "base/clock.h"
#include "base/memory.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { POLL_MS = 100, DESCRIPTORS = 32 };

struct gw_serve {
    gw_server *server;
    pthread_mutex_t access; /* to the server */
    pthread_t thread;
    int wake; /* an event counter: readable when the thread shall look up */
    int ends; /* under access */
};

static void *answer(void *context) {
    gw_serve *serve = context;
    for (int ends = 0; !ends;) {
        struct pollfd wait[DESCRIPTORS + 1] = {{.fd = serve->wake, .events = POLLIN}};
        int descriptors[DESCRIPTORS];
        uint64_t woken;
        pthread_mutex_lock(&serve->access);
        gw_server_poll(serve->server, gw_now_ns());
        const int count = gw_server_descriptors(serve->server, descriptors, DESCRIPTORS);
        ends = serve->ends;
        pthread_mutex_unlock(&serve->access);
        for (int i = 0; i < count; i++)
            wait[1 + i] = (struct pollfd){.fd = descriptors[i], .events = POLLIN};
        if (!ends)
            poll(wait, (nfds_t)(1 + count), POLL_MS);
        (void)!read(serve->wake, &woken, sizeof woken);
    }
    return NULL;
}

static void wake(const gw_serve *serve) {
    const uint64_t one = 1;
    (void)!write(serve->wake, &one, sizeof one);
}

static void finish(gw_serve *serve) {
    gw_server_close(&serve->server);
    pthread_mutex_destroy(&serve->access);
    if (serve->wake >= 0)
        close(serve->wake);
    free(serve);
}

gw_code gw_serve_open(const char *spec, gw_serve **out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_serve), "serving poses", error);
    if (code)
        return code;
    gw_serve *serve = memory;
    pthread_mutex_init(&serve->access, NULL);
    serve->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    const gw_server_options options = {.unit = 1}; /* wall space is in mm */
    code = gw_server_open(spec, &options, &serve->server, error);
    if (!code && serve->wake < 0)
        code = gw_fail(error, GW_MACHINE, "no event counter for serving poses");
    sigset_t all, before;
    sigfillset(&all); /* signals are the main thread's */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (!code && pthread_create(&serve->thread, NULL, answer, serve))
        code = gw_fail(error, GW_MACHINE, "no thread for serving poses");
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (code)
        finish(serve);
    else
        *out = serve;
    return code;
}

static void send_eye(gw_serve *serve, int32_t sensor, const double eye[3]) {
    const gw_tracking_event event = {
        .kind = GW_EVENT_POSE,
        .sensor = sensor,
        .device_time = GW_NO_TIME,
        .quality = 1,
        .of.pose = {.position = {eye[0], eye[1], eye[2]}, .orientation = {0, 0, 0, 1}}};
    gw_server_send(serve->server, &event);
}

static void send_gaze(gw_serve *serve, int32_t viewer, const gw_gaze *gaze) {
    gw_tracking_event event = {.kind = GW_EVENT_GAZE,
                               .sensor = viewer,
                               .device_time = GW_NO_TIME,
                               .quality = (double)gaze->confidence,
                               .of.gaze = {.has_origin = 1, .openness = 1}};
    for (int k = 0; k < 3; k++) {
        event.of.gaze.origin[k] = (double)gaze->eye[k];
        event.of.gaze.direction[k] = (double)gaze->direction[k];
    }
    if (viewer > 0)
        send_eye(serve, 2 * viewer, event.of.gaze.origin);
    gw_server_send(serve->server, &event);
}

void gw_serve_frame(gw_serve *serve, const gw_frame_state *state) {
    pthread_mutex_lock(&serve->access);
    send_eye(serve, 0, state->eye);
    for (uint32_t i = 0; i < state->gaze_count; i++)
        send_gaze(serve, (int32_t)i, &state->gazes[i]);
    pthread_mutex_unlock(&serve->access);
    wake(serve);
}

gw_server_counters gw_serve_count(gw_serve *serve) {
    pthread_mutex_lock(&serve->access);
    const gw_server_counters counters = *gw_server_count(serve->server);
    pthread_mutex_unlock(&serve->access);
    return counters;
}

const char *gw_serve_name(const gw_serve *serve) {
    return gw_server_name(serve->server);
}

void gw_serve_close(gw_serve **serve) {
    if (!*serve)
        return;
    pthread_mutex_lock(&(*serve)->access);
    (*serve)->ends = 1;
    pthread_mutex_unlock(&(*serve)->access);
    wake(*serve);
    pthread_join((*serve)->thread, NULL);
    finish(*serve);
    *serve = NULL;
}
