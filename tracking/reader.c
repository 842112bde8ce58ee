#include "tracking/reader.h"

#include "base/clock.h"
#include "base/memory.h"
#include "tracking/reader_queue.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { DESCRIPTORS = 64, LINES = 64, LINE = 400, LONGEST_WAIT_MS = 1000 };

/* A line of a source's log on its way to the thread that owns the log. */
typedef struct log_line {
    gw_log_level level;
    char text[LINE];
} log_line;

struct gw_reader {
    pthread_t thread;
    int started, count;
    int wake, waiting; /* event counters: the thread shall look up; events wait for the taker */
    gw_source *sources[GW_READER_SOURCES]; /* the thread's, once it is started */
    const gw_log *log;
    gw_log relay;           /* what the sources log to */
    int32_t polled;         /* the thread's: the source whose events come */
    pthread_mutex_t access; /* to all that follows */
    int ends;
    gw_reader_queue queue;
    gw_source_counters counters[GW_READER_SOURCES];
    gw_source_status status[GW_READER_SOURCES];
    int line_count;
    uint64_t lines_lost;
    log_line lines[LINES];
};

static void signal_counter(int descriptor) {
    const uint64_t one = 1;
    (void)!write(descriptor, &one, sizeof one);
}

static void clear_counter(int descriptor) {
    uint64_t value;
    (void)!read(descriptor, &value, sizeof value);
}

/* --- the thread */

static void relay_line(void *context, gw_log_level level, const char *text) {
    gw_reader *reader = context;
    pthread_mutex_lock(&reader->access);
    if (reader->line_count < LINES) {
        log_line *line = &reader->lines[reader->line_count++];
        line->level = level;
        snprintf(line->text, sizeof line->text, "%.*s", LINE - 1, text);
    } else
        reader->lines_lost++;
    pthread_mutex_unlock(&reader->access);
}

static void queue_event(void *context, const gw_tracking_event *event) {
    gw_reader *reader = context;
    const gw_reader_event item = {.source = reader->polled, .event = *event};
    pthread_mutex_lock(&reader->access);
    if (reader->queue.count == 0)
        signal_counter(reader->waiting);
    gw_reader_queue_put(&reader->queue, &item);
    pthread_mutex_unlock(&reader->access);
}

/* Returns whether it shall end. */
static int poll_sources(gw_reader *reader) {
    for (int i = 0; i < reader->count; i++) {
        gw_source *source = reader->sources[i];
        gw_source_status status;
        const int64_t now = gw_now_ns();
        reader->polled = i;
        gw_source_poll(source, now, queue_event, reader);
        gw_source_look(source, now, &status);
        pthread_mutex_lock(&reader->access);
        reader->counters[i] = *gw_source_count(source);
        reader->status[i] = status;
        pthread_mutex_unlock(&reader->access);
    }
    pthread_mutex_lock(&reader->access);
    const int ends = reader->ends;
    pthread_mutex_unlock(&reader->access);
    return ends;
}

static void wait_for_more(const gw_reader *reader) {
    struct pollfd wait[DESCRIPTORS] = {{.fd = reader->wake, .events = POLLIN}};
    int descriptors[DESCRIPTORS], used = 1;
    int64_t next = INT64_MAX;
    for (int i = 0; i < reader->count; i++) {
        const int count = gw_source_descriptors(reader->sources[i], descriptors, DESCRIPTORS - used);
        const int64_t wanted = gw_source_next(reader->sources[i]);
        next = wanted < next ? wanted : next;
        for (int k = 0; k < count; k++)
            wait[used++] = (struct pollfd){.fd = descriptors[k], .events = POLLIN};
    }
    const int64_t left = next == INT64_MAX ? LONGEST_WAIT_MS : (next - gw_now_ns() + 999999) / 1000000;
    poll(wait, (nfds_t)used, left < 0 ? 0 : left > LONGEST_WAIT_MS ? LONGEST_WAIT_MS : (int)left);
    if (wait[0].revents)
        clear_counter(reader->wake);
}

static void *read_sources(void *context) {
    gw_reader *reader = context;
    while (!poll_sources(reader))
        wait_for_more(reader);
    return NULL;
}

/* --- opening and closing */

static gw_code start(gw_reader *reader, gw_error *error) {
    sigset_t all, before;
    sigfillset(&all); /* signals are the main thread's */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&reader->thread, NULL, read_sources, reader);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    reader->started = !failed;
    return failed ? gw_fail(error, GW_MACHINE, "no thread to read trackers: %s", strerror(failed)) : GW_OK;
}

gw_code gw_reader_open(const gw_reader_source *sources, int count, const gw_log *log, gw_reader **out,
                       gw_error *error) {
    void *memory = NULL;
    *out = NULL;
    if (count < 0 || count > GW_READER_SOURCES)
        return gw_fail(error, GW_BAD_INPUT, "%d tracking sources; at most %d are read together", count,
                       GW_READER_SOURCES);
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_reader), "reader of trackers", error);
    if (code)
        return code;
    gw_reader *reader = memory;
    pthread_mutex_init(&reader->access, NULL);
    reader->log = log;
    reader->relay = (gw_log){
        .threshold = log ? log->threshold : GW_LOG_ERROR, .context = reader, .line = log ? relay_line : NULL};
    reader->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    reader->waiting = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (reader->wake < 0 || reader->waiting < 0)
        code = gw_fail(error, GW_MACHINE, "no event counter for trackers: %s", strerror(errno));
    for (int i = 0; i < count && !code; i++) {
        const gw_source_options options = {.bind = sources[i].bind, .log = &reader->relay};
        code = gw_source_open(sources[i].spec, &options, &reader->sources[i], error);
        reader->count += !code;
    }
    if (!code)
        code = start(reader, error);
    if (code)
        gw_reader_close(&reader);
    *out = reader;
    return code;
}

/* Under access. */
static void hand_over_lines(gw_reader *reader) {
    for (int i = 0; i < reader->line_count; i++)
        gw_log_write(reader->log, reader->lines[i].level, "%s", reader->lines[i].text);
    if (reader->lines_lost > 0)
        gw_log_write(reader->log, GW_LOG_WARNING, "%llu more lines about trackers",
                     (unsigned long long)reader->lines_lost);
    reader->line_count = 0;
    reader->lines_lost = 0;
}

void gw_reader_close(gw_reader **out) {
    gw_reader *reader = *out;
    *out = NULL;
    if (!reader)
        return;
    if (reader->started) {
        pthread_mutex_lock(&reader->access);
        reader->ends = 1;
        pthread_mutex_unlock(&reader->access);
        signal_counter(reader->wake);
        pthread_join(reader->thread, NULL);
    }
    for (int i = 0; i < reader->count; i++)
        gw_source_close(&reader->sources[i]);
    hand_over_lines(reader);
    if (reader->wake >= 0)
        close(reader->wake);
    if (reader->waiting >= 0)
        close(reader->waiting);
    pthread_mutex_destroy(&reader->access);
    free(reader);
}

/* --- taking */

size_t gw_reader_take(gw_reader *reader, gw_reader_event *out, size_t room) {
    pthread_mutex_lock(&reader->access);
    hand_over_lines(reader);
    const size_t count = gw_reader_queue_take(&reader->queue, out, room);
    if (reader->queue.count == 0)
        clear_counter(reader->waiting);
    pthread_mutex_unlock(&reader->access);
    return count;
}

int gw_reader_descriptor(const gw_reader *reader) {
    return reader->waiting;
}

void gw_reader_count(gw_reader *reader, int source, gw_source_counters *out, gw_source_status *status) {
    pthread_mutex_lock(&reader->access);
    if (out)
        *out = reader->counters[source];
    if (status)
        *status = reader->status[source];
    pthread_mutex_unlock(&reader->access);
}

uint64_t gw_reader_dropped(gw_reader *reader, int source) {
    pthread_mutex_lock(&reader->access);
    const uint64_t dropped = reader->queue.dropped[source];
    pthread_mutex_unlock(&reader->access);
    return dropped;
}

int gw_reader_push(gw_reader *reader, int source, const gw_tracking_event *event) {
    return source >= 0 && source < reader->count && gw_source_mouse_push(reader->sources[source], event);
}
