/* Sources of datagrams, scripted paths and the mouse: what comes out of what goes in, and what is counted. */
#include "tests/support/loopback.h"

#include "base/file.h"
#include "tracking/gaze_datagram.h"
#include "tracking/quaternion.h"

#include <math.h>

static loopback_events kept;
static const int64_t SECOND = 1000000000;

/* A source that listens on a free port of 127.0.0.1, and a socket that sends to it. */
typedef struct pair {
    gw_source *source;
    int sender;
    gw_endpoint to;
} pair;

static void begin(pair *p, const char *protocol) {
    char spec[64];
    gw_endpoint at = {.address = "127.0.0.1"};
    gw_source_status status;
    kept.count = 0;
    snprintf(spec, sizeof spec, "%s:0", protocol);
    p->source = loopback_source(spec);
    gw_source_look(p->source, gw_now_ns(), &status);
    assert_int_equal(status.standing, GW_SOURCE_SILENT);
    p->to = at;
    p->to.port = (uint16_t)strtoul(strrchr(status.address, ':') + 1, NULL, 10);
    p->sender = gw_socket_datagrams(&at, NULL, NULL);
}

static void poll_source(pair *p) {
    gw_source_poll(p->source, gw_now_ns(), loopback_keep, &kept);
}

/* Sends, and waits until it was read. */
static void give(pair *p, const void *bytes, size_t size) {
    const uint64_t before = gw_source_count(p->source)->packets;
    gw_socket_send_to(p->sender, &p->to, bytes, size);
    loopback_until(poll_source(p), gw_source_count(p->source)->packets == before + 1);
}

static void give_text(pair *p, const char *text) {
    give(p, text, strlen(text));
}

static void end(pair *p) {
    gw_socket_close(&p->sender);
    gw_source_close(&p->source);
}

static const gw_tracking_event *last(void) {
    return &kept.events[kept.count - 1];
}

#define PLAIN "[1000 2000 3000][1 0 0 0 1 0 0 0 1]"

static void dtrack_bodies_and_flysticks(void **state) {
    (void)state;
    pair p;
    begin(&p, "dtrack");
    const gw_source_counters *c = gw_source_count(p.source);
    give_text(&p, "fr 10\r\nts2 1700000000 500000 4000\r\n6dcal 2\r\n6d 1 [1 1.0]" PLAIN
                  "\r\n6df2 1 1 [0 1.0 4 2]" PLAIN "[5 0.0 -1.0]\r\n");
    assert_int_equal(kept.count, 6); /* link, body 1, Flystick, two buttons, one axis */
    assert_true(kept.events[0].kind == GW_EVENT_LINK && kept.events[0].of.link.up);
    assert_true(kept.events[1].sensor == 1 && kept.events[1].of.pose.position[1] == 2000);
    assert_true(kept.events[1].device_time == INT64_C(1700000000500000000) &&
                kept.events[1].latency == 4000000);
    assert_true(kept.events[2].sensor == 2 && kept.events[2].kind == GW_EVENT_POSE);
    assert_true(kept.events[3].kind == GW_EVENT_BUTTON && kept.events[3].sensor == 0);
    assert_true(kept.events[4].sensor == 2 && kept.events[4].of.button.pressed);
    assert_true(kept.events[5].sensor == 1 && kept.events[5].of.analog.value == -1);
    /* The body is not listed, the Flystick not tracked; its buttons count all the same. */
    give_text(&p,
              "fr 11\r\n6dcal 2\r\n6d 0 \r\n6df2 1 1 [0 -1.0 4 2][0 0 0][0 0 0 0 0 0 0 0 0][4 0.0 -1.0]\r\n");
    assert_int_equal(kept.count, 9);
    assert_true(kept.events[6].sensor == 1 && kept.events[6].quality < 0);
    assert_true(kept.events[7].sensor == 2 && kept.events[7].quality < 0);
    assert_true(kept.events[8].kind == GW_EVENT_BUTTON && kept.events[8].sensor == 0 &&
                !kept.events[8].of.button.pressed);
    assert_int_equal(c->sensors[1].untracked, 1);
    /* Frames that are missing, come twice or late. */
    give_text(&p, "fr 15\r\n6d 1 [1 1.0]" PLAIN "\r\n");
    give_text(&p, "fr 15\r\n6d 1 [1 1.0]" PLAIN "\r\n");
    give_text(&p, "fr 13\r\n6d 1 [1 1.0]" PLAIN "\r\n");
    assert_int_equal(kept.count, 10);
    assert_int_equal(c->sensors[1].lost, 3);
    assert_int_equal(c->sensors[1].duplicated, 1);
    assert_int_equal(c->sensors[1].reordered, 1);
    give_text(&p, "fr 5000000\r\n6d 1 [1 1.0]" PLAIN "\r\n"); /* a gap that is no loss */
    give_text(&p, "fr 1\r\n6d 1 [1 1.0]" PLAIN "\r\n");       /* the controller began anew */
    assert_int_equal(kept.count, 12);
    assert_int_equal(c->sensors[1].lost, 3);
    assert_int_equal(c->malformed + c->unknown + c->not_finite, 0);
    give_text(&p, "hello\r\n");
    give_text(&p, "fr 2\r\n6d 1 [1 1,0]" PLAIN "\r\n");
    give_text(&p, "fr 3\r\n6d 1 [1 1.0][1 2 3][1 0 0 0 1 0 0 0 9]\r\n");
    assert_true(c->malformed == 2 && c->unknown == 1 && c->not_finite == 1);
    char *longest = calloc(1, 40000);
    assert_non_null(longest);
    memset(longest, '9', 40000);
    give(&p, longest, 40000);
    free(longest);
    assert_int_equal(c->malformed, 3);
    /* Silence is a loss; the next datagram finds it again. */
    gw_source_poll(p.source, gw_now_ns() + 3 * SECOND, loopback_keep, &kept);
    assert_true(last()->kind == GW_EVENT_LINK && !last()->of.link.up && c->losses == 1);
    give_text(&p, "fr 4\r\n6d 1 [1 1.0]" PLAIN "\r\n");
    assert_true(last()->kind == GW_EVENT_POSE && c->connections == 2);
    end(&p);
}

/* A rate that is divided is no loss: the smallest step of the counter is the usual one. */
static void dtrack_dividers(void **state) {
    (void)state;
    pair p;
    char text[128];
    begin(&p, "dtrack");
    for (int i = 0; i < 20; i++) {
        snprintf(text, sizeof text, "fr %d\r\n6d 1 [0 1.0][%d 0 0][1 0 0 0 1 0 0 0 1]\r\n", 100 + 3 * i, i);
        if (i != 10)
            give_text(&p, text);
    }
    assert_int_equal(gw_source_count(p.source)->sensors[0].lost, 1);
    /* A forged number, and the sender's own again, far behind it. */
    give_text(&p, "fr 900000\r\n6d 1 [0 1.0][1 0 0][1 0 0 0 1 0 0 0 1]\r\n");
    give_text(&p, "fr 160\r\n6d 1 [0 1.0][2 0 0][1 0 0 0 1 0 0 0 1]\r\n");
    assert_true(last()->kind == GW_EVENT_POSE && last()->of.pose.position[0] == 2);
    assert_int_equal(gw_source_count(p.source)->sensors[0].lost, 1);
    assert_int_equal(gw_source_count(p.source)->sensors[0].jumps, 2);
    end(&p);
}

static void dtrack_of_one_controller(void **state) {
    (void)state;
    char spec[64];
    gw_endpoint at = {.address = "127.0.0.1"}, other = {.address = "127.0.0.2"};
    const int own = gw_socket_datagrams(&at, NULL, &at.port); /* a free port */
    close(own);
    snprintf(spec, sizeof spec, "dtrack:127.0.0.1:%u", (unsigned)at.port);
    kept.count = 0;
    pair p = {.source = loopback_source(spec), .to = at, .sender = gw_socket_datagrams(&other, NULL, NULL)};
    const gw_endpoint controller = {.address = "127.0.0.1", .port = 50107};
    int opened = gw_socket_datagrams(&controller, NULL, NULL); /* unless somebody has it */
    give_text(&p, "fr 1\r\n6d 1 [0 1.0]" PLAIN "\r\n");
    assert_int_equal(gw_source_count(p.source)->unknown, 1);
    assert_int_equal(kept.count, 0);
    char text[32] = "";
    ssize_t size = 0;
    if (opened >= 0)
        loopback_until(poll_source(&p),
                       (size = gw_socket_receive(opened, text, sizeof text, 0, NULL, NULL)) > 0);
    if (opened >= 0)
        assert_true(size == 10 && strcmp(text, "fw4dtsdkc") == 0);
    gw_socket_close(&opened);
    end(&p);
}

/* A multicast group, where the machine lets one be joined. */
static void groups(void **state) {
    (void)state;
    const gw_source_options local = {.bind = "127.0.0.1"};
    gw_endpoint at = {.address = "127.0.0.1"};
    gw_error why = {0};
    char spec[64];
    int held = gw_socket_datagrams(&at, NULL, &at.port); /* a free port */
    gw_socket_close(&held);
    snprintf(spec, sizeof spec, "dtrack:239.255.77.1:%u", (unsigned)at.port);
    pair p = {.sender = gw_socket_datagrams(&(gw_endpoint){.address = "127.0.0.1"}, NULL, NULL),
              .to = {.address = "239.255.77.1", .port = at.port}};
    kept.count = 0;
    if (gw_source_open(spec, &local, &p.source, &why)) {
        print_message("# no groups here: %s\n", why.text);
        gw_socket_close(&p.sender);
        return;
    }
    static const char frame[] = "fr 1\r\n6d 1 [0 1.0]" PLAIN "\r\n";
    if (gw_socket_send_to(p.sender, &p.to, frame, sizeof frame - 1) <= 0)
        print_message("# no way to groups here\n");
    else
        loopback_until(poll_source(&p), loopback_kind(&kept, GW_EVENT_POSE) == 1);
    end(&p);
}

static void our_sender_and_our_listener(void **state) {
    (void)state;
    pair p;
    char spec[64];
    begin(&p, "dtrack");
    snprintf(spec, sizeof spec, "dtrack:127.0.0.1:%u", (unsigned)p.to.port);
    gw_server *server = loopback_server(spec);
    const double turn[4] = {0.1, -0.2, 0.3, 0.92736};
    gw_tracking_event event = {.kind = GW_EVENT_POSE, .sensor = 3, .quality = 1, .device_time = GW_NO_TIME};
    memcpy(event.of.pose.orientation, turn, sizeof turn);
    gw_turn_normalise(event.of.pose.orientation);
    for (int i = 0; i < 50; i++) {
        event.of.pose.position[0] = 0.001 * i;
        gw_server_send(server, &event);
        gw_server_poll(server, gw_now_ns());
        loopback_until(poll_source(&p), loopback_kind(&kept, GW_EVENT_POSE) == (size_t)i + 1);
        assert_true(last()->sensor == 3 && fabs(last()->of.pose.position[0] - i) < 1e-9); /* mm */
        for (int k = 0; k < 4; k++)
            assert_true(fabs(last()->of.pose.orientation[k] - event.of.pose.orientation[k]) < 1e-6);
        assert_true(llabs(last()->device_time - gw_unix_ns()) < 60 * SECOND);
    }
    assert_int_equal(gw_source_count(p.source)->sensors[3].lost, 0);
    gw_server_close(&server);
    end(&p);
}

/* A frame that takes long must not make what came meanwhile younger: the kernel's time counts. */
static void arrival_is_the_kernel_s(void **state) {
    (void)state;
    pair p;
    begin(&p, "dtrack");
    give_text(&p, "fr 1\r\n6d 1 [0 1.0]" PLAIN "\r\n");
    static const char second[] = "fr 2\r\n6d 1 [0 1.0]" PLAIN "\r\n";
    usleep(5000);
    const int64_t before = gw_now_ns();
    gw_socket_send_to(p.sender, &p.to, second, sizeof second - 1);
    const int64_t sent = gw_now_ns();
    usleep(80000);
    loopback_until(poll_source(&p), gw_source_count(p.source)->packets == 2);
    const int64_t slack = 1000000; /* between two clocks read one after the other */
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 2);
    assert_true(last()->arrival >= before - slack && last()->arrival <= sent + slack + SECOND / 100);
    end(&p);
    /* By TCP the same. */
    gw_server *server = loopback_server("vrpn:127.0.0.1:0");
    char spec[64];
    snprintf(spec, sizeof spec, "Tracker0@127.0.0.1:%u", (unsigned)gw_server_port(server));
    gw_source *source = loopback_source(spec);
    kept.count = 0;
    loopback_until(
        (gw_server_poll(server, gw_now_ns()), gw_source_poll(source, gw_now_ns(), loopback_keep, &kept)),
        gw_server_count(server)->pings > 0);
    for (int i = 0; i < 20; i++) { /* pongs and what else is on its way */
        gw_source_poll(source, gw_now_ns(), loopback_keep, &kept);
        usleep(1000);
    }
    const gw_tracking_event event = {
        .kind = GW_EVENT_POSE, .quality = 1, .device_time = SECOND, .of.pose = {.orientation = {0, 0, 0, 1}}};
    gw_server_send(server, &event);
    gw_server_poll(server, gw_now_ns());
    const int64_t left = gw_now_ns();
    usleep(80000);
    loopback_until(gw_source_poll(source, gw_now_ns(), loopback_keep, &kept),
                   loopback_kind(&kept, GW_EVENT_POSE) == 1);
    assert_true(last()->arrival <= left + slack + SECOND / 100);
    gw_source_close(&source);
    gw_server_close(&server);
}

static void gaze_sequences(void **state) {
    (void)state;
    pair p;
    begin(&p, "gaze");
    const gw_source_counters *c = gw_source_count(p.source);
    gw_tracking_event event = {.kind = GW_EVENT_GAZE, .device_time = GW_NO_TIME, .quality = 1};
    event.of.gaze.direction[2] = -1;
    uint8_t data[GW_GAZE_DATAGRAM];
    static const uint32_t sequences[] = {UINT32_MAX - 1, UINT32_MAX, 0, 0, 3, 2, 4, 70000, 5, 6};
    /* used: around zero, one twice, two missing, one late, a gap, begun anew */
    for (size_t i = 0; i < sizeof sequences / sizeof sequences[0]; i++) {
        const gw_gaze_extra extra = {.sequence = sequences[i]};
        gw_gaze_datagram_write(&event, &extra, 1, data);
        give(&p, data, sizeof data);
    }
    assert_int_equal(loopback_kind(&kept, GW_EVENT_GAZE), 8);
    assert_int_equal(c->sensors[0].duplicated, 1);
    assert_int_equal(c->sensors[0].reordered, 1);
    assert_int_equal(c->sensors[0].lost, 2); /* what a forged number claims is none */
    assert_int_equal(c->sensors[0].jumps, 2);
    const gw_gaze_extra extra = {.sequence = 1};
    event.sensor = 3; /* another viewer has a sequence of its own */
    event.quality = -1;
    gw_gaze_datagram_write(&event, &extra, 1, data);
    give(&p, data, sizeof data);
    assert_true(last()->sensor == 3 && last()->quality < 0 && c->sensors[3].untracked == 1);
    event.sensor = 64;
    gw_gaze_datagram_write(&event, &extra, 1, data);
    give(&p, data, sizeof data);
    data[4] = 9; /* version */
    give(&p, data, sizeof data);
    give(&p, "x", 1);
    data[4] = 1;
    data[28] = 0x7f;
    give(&p, data, sizeof data);
    assert_true(c->unknown == 2 && c->malformed == 1 && c->not_finite == 1);
    end(&p);
}

static gw_source *path_of(const char *text, char path[512]) {
    gw_source *source = NULL;
    gw_error why = {0};
    char spec[600];
    check_ok(gw_file_write(scratch_path(path, "path.yaml"), text, strlen(text), &error));
    snprintf(spec, sizeof spec, "path:%s", path);
    kept.count = 0;
    if (gw_source_open(spec, NULL, &source, &why))
        print_message("# %s\n", why.text);
    return source;
}

static void paths(void **state) {
    (void)state;
    char path[512];
    gw_source *source = path_of("version: 1\nrate: 100\nkeys:\n"
                                "  - {time: 0, position: [0, 0, 2000], look_at: [0, 0, 0]}\n"
                                "  - {time: 1, position: [1000, 0, 2000], look_at: [1000, 0, 4000]}\n",
                                path);
    assert_non_null(source);
    const int64_t start = 5 * SECOND;
    gw_source_poll(source, start, loopback_keep, &kept);
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 2);
    assert_true(gw_source_next(source) == start + SECOND / 100);
    gw_source_poll(source, start + 3 * SECOND / 2, loopback_keep, &kept);
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 2 * 151);
    for (size_t i = 1, n = 0; i < kept.count; i += 2, n++) {
        const gw_tracking_event *head = &kept.events[i], *gaze = head + 1;
        double ahead[3];
        assert_true(head->sensor == 0 && gaze->sensor == 1 && head->quality == 1);
        assert_true(head->arrival == start + (int64_t)n * SECOND / 100);
        assert_true(fabs(head->of.pose.position[0] - 0.01 * (double)(n % 100)) <
                    1e-9); /* m; begins anew at 1 s */
        gw_turn_vector(head->of.pose.orientation, (const double[]){0, 0, -1}, ahead);
        if (n % 100 == 50) /* there the path looks nowhere */
            assert_true(gaze->quality < 0);
        else
            assert_true(fabs(ahead[2] - (n % 100 < 50 ? -1 : 1)) < 1e-9);
    }
    gw_source_poll(source, start + 10000 * SECOND, loopback_keep, &kept); /* asleep for hours */
    assert_true(gw_source_count(source)->sensors[0].lost > 900000);
    gw_source_close(&source);
    static const char *const wrong[] = {
        "version: 2\nkeys:\n  - {time: 0, position: [0, 0, 0], look_at: [0, 0, 1]}\n",
        "version: 1\n",
        "version: 1\nkeys: []\n",
        "version: 1\nrate: 0\nkeys:\n  - {time: 0, position: [0, 0, 0], look_at: [0, 0, 1]}\n",
        "version: 1\nkeys:\n  - {time: 1, position: [0, 0, 0], look_at: [0, 0, 1]}\n",
        "version: 1\nkeys:\n  - {time: 0, position: [0, 0], look_at: [0, 0, 1]}\n",
        "version: 1\nkeys:\n  - {time: 0, position: [0, 0, 2e6], look_at: [0, 0, 1]}\n",
        "version: 1\nkeys:\n  - {time: 0, position: [0, 0, 0]}\n",
        "version: 1\nkeys:\n  - {time: 0, position: [0, 0, 0], look_at: [0, 0, 1]}\n"
        "  - {time: 0, position: [0, 0, 0], look_at: [0, 0, 1]}\n",
        "version: 1\nkees: []\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_null(path_of(wrong[i], path));
    unlink(path);
}

static void the_mouse(void **state) {
    (void)state;
    gw_source *source = loopback_source("mouse"), *nothing = loopback_source("null");
    gw_tracking_event event = {.kind = GW_EVENT_GAZE, .arrival = 7, .device_time = GW_NO_TIME, .quality = 1};
    event.of.gaze.direction[2] = -1;
    kept.count = 0;
    for (int i = 0; i < 256; i++)
        assert_true(gw_source_mouse_push(source, &event));
    assert_false(gw_source_mouse_push(source, &event)); /* full */
    gw_source_poll(source, 9, loopback_keep, &kept);
    assert_int_equal(kept.count, 256);
    assert_true(last()->arrival == 7);
    assert_true(gw_source_mouse_push(source, &event));
    assert_false(gw_source_mouse_push(nothing, &event));
    gw_source_poll(nothing, 9, loopback_keep, &kept);
    assert_int_equal(kept.count, 256);
    assert_true(gw_source_next(nothing) == INT64_MAX);
    gw_source_close(&source);
    gw_source_close(&nothing);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dtrack_bodies_and_flysticks),
        cmocka_unit_test(dtrack_dividers),
        cmocka_unit_test(dtrack_of_one_controller),
        cmocka_unit_test(our_sender_and_our_listener),
        cmocka_unit_test(arrival_is_the_kernel_s),
        cmocka_unit_test(groups),
        cmocka_unit_test(gaze_sequences),
        cmocka_unit_test(paths),
        cmocka_unit_test(the_mouse),
    };
    return cmocka_run_group_tests_name("sources", tests, NULL, NULL);
}
