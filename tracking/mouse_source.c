/* The window's pointer as a source: events that another thread pushes wait here for the next poll. */
#include "tracking/source_internal.h"

#include "base/memory.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { WAITING = 256 };

typedef struct mouse_source {
    gw_source base;
    int wake; /* an event counter, readable while events wait */
    pthread_mutex_t access;
    int count;
    gw_tracking_event events[WAITING];
} mouse_source;

static void poll_mouse(gw_source *source, int64_t now) {
    mouse_source *m = (mouse_source *)source;
    gw_tracking_event events[WAITING];
    uint64_t woken;
    (void)now;
    pthread_mutex_lock(&m->access);
    const int count = m->count;
    memcpy(events, m->events, (size_t)count * sizeof events[0]);
    m->count = 0;
    (void)!read(m->wake, &woken, sizeof woken);
    pthread_mutex_unlock(&m->access);
    for (int i = 0; i < count; i++) {
        source->counters.packets++;
        if (events[i].kind == GW_EVENT_POSE)
            gw_source_emit_pose(source, &events[i]);
        else if (events[i].sensor < 0 || events[i].sensor >= GW_SOURCE_SENSORS)
            source->counters.unknown++;
        else
            gw_source_emit(source, &events[i]);
    }
}

int gw_source_mouse_push(gw_source *source, const gw_tracking_event *event) {
    const uint64_t one = 1;
    mouse_source *m = (mouse_source *)source;
    if (source->poll != poll_mouse)
        return 0;
    pthread_mutex_lock(&m->access);
    const int fits = m->count < WAITING;
    if (fits)
        m->events[m->count++] = *event;
    (void)!write(m->wake, &one, sizeof one);
    pthread_mutex_unlock(&m->access);
    return fits;
}

static int descriptors(const gw_source *source, int *out, int room) {
    if (room > 0)
        out[0] = ((const mouse_source *)source)->wake;
    return room > 0;
}

static void close_mouse(gw_source *source) {
    mouse_source *m = (mouse_source *)source;
    if (m->wake >= 0)
        close(m->wake);
    pthread_mutex_destroy(&m->access);
    free(m);
}

gw_code gw_mouse_source_open(const gw_source *like, gw_source **out, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(mouse_source), "mouse", error);
    if (code)
        return code;
    mouse_source *m = memory;
    m->base = *like;
    m->base.poll = poll_mouse;
    m->base.descriptors = descriptors;
    m->base.close = close_mouse;
    m->base.status.standing = GW_SOURCE_SILENT;
    pthread_mutex_init(&m->access, NULL);
    m->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (m->wake < 0) {
        code = gw_fail(error, GW_MACHINE, "mouse: no event counter: %s", strerror(errno));
        close_mouse(&m->base);
        return code;
    }
    *out = &m->base;
    return GW_OK;
}
