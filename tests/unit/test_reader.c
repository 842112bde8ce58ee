/* The reader: events of several sources with their true times of arrival, the bounded queue, log lines on the
 * owner's thread, and nothing left when it is closed. */
#include "tests/support/loopback.h"

#include "tracking/reader.h"
#include "tracking/reader_queue.h"

#include <dirent.h>
#include <poll.h>
#include <pthread.h>

static const int64_t MILLISECOND = 1000000;

static int count_in(const char *folder) {
    DIR *open = opendir(folder);
    int count = 0;
    while (open && readdir(open))
        count++;
    if (open)
        closedir(open);
    return count;
}

static gw_reader *read_from(const char *const *specs, int count, const gw_log *log) {
    gw_reader_source sources[GW_READER_SOURCES] = {{0}};
    gw_reader *reader = NULL;
    for (int i = 0; i < count; i++)
        sources[i] = (gw_reader_source){.spec = specs[i], .bind = "127.0.0.1"};
    check_ok(gw_reader_open(sources, count, log, &reader, &error));
    return reader;
}

/* Takes until `wanted` poses have come. */
static size_t take_poses(gw_reader *reader, gw_server *server, gw_reader_event *out, size_t wanted) {
    gw_reader_event events[64];
    size_t poses = 0;
    const int64_t end = gw_now_ns() + LOOPBACK_DEADLINE;
    while (poses < wanted && gw_now_ns() < end) {
        if (server)
            gw_server_poll(server, gw_now_ns());
        const size_t got = gw_reader_take(reader, events, 64);
        for (size_t i = 0; i < got && poses < wanted; i++)
            if (events[i].event.kind == GW_EVENT_POSE)
                out[poses++] = events[i];
        usleep(got ? 0 : 200);
    }
    return poses;
}

static void arrival_is_when_it_came_not_when_it_was_taken(void **state) {
    (void)state;
    gw_server *server = loopback_server("vrpn:127.0.0.1:0");
    char spec[64];
    snprintf(spec, sizeof spec, "Tracker0@127.0.0.1:%u", (unsigned)gw_server_port(server));
    gw_reader *reader = read_from((const char *const[]){spec, "null"}, 2, NULL);
    gw_source_counters counters;
    loopback_until(gw_server_poll(server, gw_now_ns()),
                   (gw_reader_count(reader, 0, &counters, NULL), gw_server_count(server)->pings > 0));
    gw_reader_event got[20];
    int64_t sent[20];
    for (int i = 0; i < 20; i++) { /* nobody takes while they come */
        const gw_tracking_event event = {.kind = GW_EVENT_POSE,
                                         .sensor = 0,
                                         .device_time = (int64_t)(i + 1) * MILLISECOND,
                                         .quality = 1,
                                         .of.pose = {.orientation = {0, 0, 0, 1}}};
        sent[i] = gw_now_ns();
        gw_server_send(server, &event);
        gw_server_poll(server, gw_now_ns());
        usleep(5000);
    }
    const int64_t taken = gw_now_ns();
    assert_int_equal(take_poses(reader, server, got, 20), 20);
    for (int i = 0; i < 20; i++) {
        assert_true(got[i].source == 0 && got[i].event.device_time == (int64_t)(i + 1) * MILLISECOND);
        assert_true(got[i].event.arrival >= sent[i] - MILLISECOND);
    }
    /* 95 ms lie between the first and the last; taken at once they would all have the last one's time. */
    assert_true(got[0].event.arrival < got[19].event.arrival - 50 * MILLISECOND &&
                got[0].event.arrival < taken);
    gw_source_status status;
    loopback_until((void)0,
                   (gw_reader_count(reader, 0, &counters, &status), counters.sensors[0].events == 20));
    assert_int_equal(status.standing, GW_SOURCE_REPORTS);
    gw_reader_close(&reader);
    gw_server_close(&server);
}

static void put(gw_reader_queue *queue, gw_tracking_event_kind kind, int source, int32_t sensor,
                int64_t number) {
    const gw_reader_event event = {.source = source,
                                   .event = {.kind = kind, .sensor = sensor, .device_time = number}};
    gw_reader_queue_put(queue, &event);
}

/* Buttons stay while there are poses to drop, and of those first the oldest of the sensor that reports. */
static void a_full_queue_drops_old_poses_first(void **state) {
    (void)state;
    gw_reader_queue *queue = calloc(1, sizeof *queue);
    assert_non_null(queue);
    put(queue, GW_EVENT_BUTTON, 0, 5, -1);
    put(queue, GW_EVENT_POSE, 1, 1, -2);
    for (int i = 0; i < GW_READER_QUEUE - 2; i++)
        put(queue, GW_EVENT_POSE, 0, i % 2, i);
    assert_int_equal(queue->count, GW_READER_QUEUE);
    put(queue, GW_EVENT_POSE, 0, 1, 9000); /* so number 1, the oldest of that sensor, goes */
    assert_int_equal(queue->dropped[0], 1);
    assert_true(queue->events[2].event.device_time == 0 && queue->events[3].event.device_time == 2);
    put(queue, GW_EVENT_BUTTON, 0, 5, 9001); /* the oldest pose goes */
    assert_int_equal(queue->dropped[1], 1);
    assert_true(queue->events[0].event.kind == GW_EVENT_BUTTON && queue->events[1].event.device_time == 0);
    for (int i = 0; i < 3 * GW_READER_QUEUE; i++)
        put(queue, GW_EVENT_BUTTON, 0, 5, 10000 + i);
    assert_int_equal(queue->count, GW_READER_QUEUE);
    gw_reader_event out[10];
    assert_int_equal(gw_reader_queue_take(queue, out, 10), 10);
    assert_true(out[0].event.device_time == 10000 + 2 * GW_READER_QUEUE);
    assert_int_equal(queue->count, GW_READER_QUEUE - 10);
    free(queue);
}

static void events_wake_whoever_waits(void **state) {
    (void)state;
    gw_reader *reader = read_from((const char *const[]){"null", "mouse"}, 2, NULL);
    struct pollfd wait = {.fd = gw_reader_descriptor(reader), .events = POLLIN};
    const gw_tracking_event event = {.kind = GW_EVENT_BUTTON, .sensor = 1, .device_time = GW_NO_TIME};
    gw_reader_event got;
    assert_int_equal(poll(&wait, 1, 0), 0);
    assert_false(gw_reader_push(reader, 0, &event));
    assert_false(gw_reader_push(reader, 2, &event));
    assert_true(gw_reader_push(reader, 1, &event));
    assert_int_equal(poll(&wait, 1, 30000), 1);
    assert_int_equal(gw_reader_take(reader, &got, 1), 1);
    assert_true(got.source == 1 && got.event.kind == GW_EVENT_BUTTON);
    assert_int_equal(poll(&wait, 1, 0), 0);
    gw_reader_close(&reader);
}

typedef struct lines {
    pthread_t owner;
    int count, elsewhere;
    char text[400];
} lines;

static void keep_line(void *context, gw_log_level level, const char *text) {
    lines *l = context;
    (void)level;
    l->count++;
    l->elsewhere += !pthread_equal(l->owner, pthread_self());
    snprintf(l->text, sizeof l->text, "%s", text);
}

static void lines_come_out_on_the_owner_s_thread(void **state) {
    (void)state;
    lines l = {.owner = pthread_self()};
    const gw_log log = {.threshold = GW_LOG_INFO, .context = &l, .line = keep_line};
    gw_endpoint at = {.address = "127.0.0.1"};
    int closed = gw_socket_listen(&at, &at.port);
    char spec[64];
    gw_socket_close(&closed); /* a port that nobody listens to */
    snprintf(spec, sizeof spec, "Tracker0@127.0.0.1:%u", (unsigned)at.port);
    gw_reader *reader = read_from((const char *const[]){spec}, 1, &log);
    gw_reader_event got;
    loopback_until((void)0, (gw_reader_take(reader, &got, 1), l.count > 0));
    assert_int_equal(l.elsewhere, 0);
    assert_non_null(strstr(l.text, "the port is closed"));
    gw_reader_close(&reader);
}

static void nothing_is_left(void **state) {
    (void)state;
    const int descriptors = count_in("/proc/self/fd");
    for (int i = 0; i < 20; i++) {
        gw_reader *reader = read_from((const char *const[]){"Tracker0@127.0.0.1:9", "vrpn+udp:A@127.0.0.1:9",
                                                            "dtrack:0", "gaze:0", "mouse", "null"},
                                      6, NULL);
        gw_reader_close(&reader);
        assert_null(reader);
    }
    gw_reader *reader = NULL;
    const gw_reader_source wrong[] = {{.spec = "dtrack:0"}, {.spec = "nonsense"}};
    check_fails(gw_reader_open(wrong, 2, NULL, &reader, &error), GW_BAD_INPUT, "nonsense");
    assert_null(reader);
    assert_int_equal(count_in("/proc/self/fd"), descriptors);
#ifdef __SANITIZE_THREAD__
    enum { TASKS = 4 }; /* ".", "..", this one, the sanitizer's */
#else
    enum { TASKS = 3 };
#endif
    assert_int_equal(count_in("/proc/self/task"), TASKS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrival_is_when_it_came_not_when_it_was_taken),
        cmocka_unit_test(a_full_queue_drops_old_poses_first),
        cmocka_unit_test(events_wake_whoever_waits),
        cmocka_unit_test(lines_come_out_on_the_owner_s_thread),
        cmocka_unit_test(nothing_is_left),
    };
    return cmocka_run_group_tests_name("reader", tests, NULL, NULL);
}
