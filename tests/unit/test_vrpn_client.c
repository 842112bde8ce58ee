/* The VRPN client against our server, in both of VRPN's ways, and against servers written here by hand that
 * are late, lost, of another version, or talk nonsense. Times of the client are given by the test. */
#include "tests/support/loopback.h"

#include "tests/support/hex.h"
#include "tracking/big_endian.h"
#include "tracking/vrpn_message.h"

#include <math.h>
#include <sys/socket.h>

static loopback_events kept;
static const int64_t SECOND = 1000000000;

static gw_source *client_of(const char *prefix, const char *device, uint16_t port) {
    char spec[128];
    snprintf(spec, sizeof spec, "%s%s@127.0.0.1:%u", prefix, device, (unsigned)port);
    kept.count = 0;
    return loopback_source(spec);
}

static gw_tracking_event pose(int32_t sensor, double x, int64_t time) {
    return (gw_tracking_event){.kind = GW_EVENT_POSE,
                               .sensor = sensor,
                               .device_time = time,
                               .quality = 1,
                               .of.pose = {.position = {x, 1.5, -2}, .orientation = {0, 0.6, 0, 0.8}}};
}

static void poll_both(gw_server *server, gw_source *source) {
    gw_server_poll(server, gw_now_ns());
    gw_source_poll(source, gw_now_ns(), loopback_keep, &kept);
}

/* Everything that a server can say arrives as it was said. */
static void both_ways(void **state) {
    (void)state;
    static const char *const prefixes[] = {"", "vrpn+udp:"};
    for (int way = 0; way < 2; way++) {
        gw_server *server = loopback_server("vrpn:127.0.0.1:0");
        gw_source *source = client_of(prefixes[way], "Tracker0", gw_server_port(server));
        const gw_source_counters *c = gw_source_count(source);
        assert_int_equal(loopback_standing(source, gw_now_ns()), GW_SOURCE_SEEKS);
        loopback_until(poll_both(server, source), gw_server_count(server)->pings > 0 && c->connections == 1);
        const int64_t start = INT64_C(1700000000) * SECOND, before = gw_now_ns();
        for (int i = 0; i < 100; i++) {
            const gw_tracking_event event = pose(i % 4, i, start + i * 1000000);
            gw_server_send(server, &event);
        }
        gw_tracking_event event = {.kind = GW_EVENT_BUTTON, .sensor = 3, .device_time = start};
        event.of.button.pressed = 1;
        gw_server_send(server, &event);
        event = (gw_tracking_event){.kind = GW_EVENT_ANALOG, .sensor = 1, .device_time = start};
        event.of.analog.value = -0.5;
        gw_server_send(server, &event);
        loopback_until(poll_both(server, source), loopback_kind(&kept, GW_EVENT_POSE) == 100 &&
                                                      loopback_kind(&kept, GW_EVENT_BUTTON) == 1 &&
                                                      loopback_kind(&kept, GW_EVENT_ANALOG) == 2);
        assert_true(kept.events[0].kind == GW_EVENT_LINK && kept.events[0].of.link.up);
        for (size_t i = 0, n = 0; i < kept.count; i++) {
            const gw_tracking_event *e = &kept.events[i];
            if (e->kind == GW_EVENT_BUTTON)
                assert_true(e->sensor == 3 && e->of.button.pressed);
            if (e->kind == GW_EVENT_ANALOG)
                assert_true(e->of.analog.value == (e->sensor == 1 ? -0.5 : 0));
            if (e->kind != GW_EVENT_POSE)
                continue;
            assert_true(e->sensor == (int32_t)n % 4 && e->of.pose.position[0] == (double)n);
            assert_true(e->device_time == start + (int64_t)n * 1000000 && e->quality == 1);
            assert_true(e->arrival >= before && e->arrival <= gw_now_ns());
            assert_true(fabs(e->of.pose.orientation[1] - 0.6) < 1e-15);
            n++;
        }
        assert_int_equal(c->malformed + c->unknown + c->not_finite, 0);
        assert_int_equal(c->sensors[2].events, 25);
        assert_int_equal(loopback_standing(source, gw_now_ns()), GW_SOURCE_REPORTS);
        /* The server goes and comes again on the same port: sought each second, found, told anew. */
        const uint16_t port = gw_server_port(server);
        char spec[64];
        gw_server_close(&server);
        loopback_until(gw_source_poll(source, gw_now_ns(), loopback_keep, &kept), c->losses == 1);
        assert_true(kept.events[kept.count - 1].kind == GW_EVENT_LINK &&
                    !kept.events[kept.count - 1].of.link.up);
        snprintf(spec, sizeof spec, "vrpn:127.0.0.1:%u", (unsigned)port);
        server = loopback_server(spec);
        loopback_until((gw_server_poll(server, gw_now_ns()), /* a second has passed */
                        gw_source_poll(source, gw_now_ns() + 2 * SECOND, loopback_keep, &kept)),
                       c->connections == 2 && gw_server_count(server)->pings > 0);
        event = pose(0, 7, start + SECOND);
        gw_server_send(server, &event);
        loopback_until(poll_both(server, source), loopback_kind(&kept, GW_EVENT_POSE) == 101);
        gw_source_close(&source);
        gw_server_close(&server);
    }
}

static void a_device_that_is_not_there(void **state) {
    (void)state;
    gw_server *server = loopback_server("vrpn:127.0.0.1:0");
    gw_source *source = client_of("vrpn:", "Wand", gw_server_port(server));
    loopback_until(poll_both(server, source), gw_source_count(source)->connections == 1);
    const gw_tracking_event event = pose(0, 1, SECOND);
    loopback_until(gw_server_send(server, &event);
                   poll_both(server, source), gw_source_count(source)->unknown > 0);
    gw_source_status status;
    gw_source_look(source, gw_now_ns() + 3 * SECOND, &status);
    assert_int_equal(status.standing, GW_SOURCE_NO_SENDER);
    assert_string_equal(status.detail, "Tracker0");
    assert_string_equal(status.version, "07.38");
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 0);
    gw_source_close(&source);
    gw_server_close(&server);
}

/* --- servers by hand */

typedef struct hand {
    int listening, socket;
    gw_endpoint at;
    gw_source *source;
} hand;

static int more(hand *h, int64_t now) {
    gw_endpoint from;
    gw_source_poll(h->source, now, loopback_keep, &kept);
    if (h->socket < 0)
        h->socket = gw_socket_accept(h->listening, &from);
    return h->socket >= 0;
}

static void begin(hand *h) {
    *h = (hand){.socket = -1, .at = {.address = "127.0.0.1"}};
    h->listening = gw_socket_listen(&h->at, &h->at.port);
    h->source = client_of("", "Tracker0", h->at.port);
    loopback_until((void)0, more(h, gw_now_ns()));
}

static void end(hand *h) {
    gw_source_close(&h->source);
    gw_socket_close(&h->socket);
    gw_socket_close(&h->listening);
}

static void say(const hand *h, const void *bytes, size_t size) {
    assert_int_equal(send(h->socket, bytes, size, MSG_NOSIGNAL), size);
}

static void greet(hand *h) {
    uint8_t bytes[256];
    gw_vrpn_cookie_write(bytes);
    say(h, bytes, GW_VRPN_COOKIE);
    say(h, bytes, gw_vrpn_description_write(-1, 7, 0, "Tracker0", bytes, sizeof bytes));
    say(h, bytes, gw_vrpn_description_write(-1, 8, 0, "Other", bytes, sizeof bytes));
    static const char *const types[] = {GW_VRPN_TYPE_POSE,   GW_VRPN_TYPE_BUTTON, GW_VRPN_TYPE_BUTTONS,
                                        GW_VRPN_TYPE_ANALOG, GW_VRPN_TYPE_PONG,   "vrpn_Tracker Velocity"};
    for (int i = 0; i < 6; i++)
        say(h, bytes, gw_vrpn_description_write(-2, 10 + i, 0, types[i], bytes, sizeof bytes));
    loopback_until(more(h, gw_now_ns()), gw_source_count(h->source)->packets >= 8);
}

static void say_payload(const hand *h, int32_t type, int32_t sender, int64_t time, const void *payload,
                        size_t size) {
    uint8_t bytes[256];
    const gw_vrpn_message m = {
        .type = type, .sender = sender, .time = time, .payload = payload, .payload_size = size};
    const size_t whole = gw_vrpn_message_write(&m, bytes, sizeof bytes);
    say(h, bytes, whole);
}

static void say_pose(const hand *h, int64_t milliseconds, int32_t sensor, double x, double w) {
    const gw_vrpn_pose p = {.sensor = sensor, .position = {x}, .orientation = {0, 0, 0, w}};
    uint8_t payload[GW_VRPN_POSE];
    gw_vrpn_pose_write(&p, payload);
    say_payload(h, 10, 7, 1000 * SECOND + milliseconds * 1000000, payload, sizeof payload);
}

/* Every reason to pass something over has its counter, and what follows it is still understood. */
static void what_is_wrong_is_counted(void **state) {
    (void)state;
    hand h;
    begin(&h);
    greet(&h);
    uint8_t bytes[256] = {0};
    say_pose(&h, 0, 0, 1, 2);     /* not of length 1: normalised */
    say_pose(&h, 0, 0, 1, 2);     /* duplicated */
    say_pose(&h, 0, 0, 2, 1);     /* the same time, other numbers: used */
    say_pose(&h, 20, 0, 3, 1);    /* used */
    say_pose(&h, 10, 0, 4, 1);    /* reordered */
    say_pose(&h, 10, 1, 4, 1);    /* another sensor: used */
    say_pose(&h, -5000, 0, 5, 1); /* a clock that was set: used */
    say_pose(&h, -4990, 0, 6, 1); /* used */
    say_pose(&h, 30, -1, 1, 1);   /* unknown sensors */
    say_pose(&h, 30, 64, 1, 1);
    say_pose(&h, 30, INT32_MIN, 1, 1);
    say_pose(&h, 40, 0, NAN, 1); /* not finite */
    say_pose(&h, 40, 0, INFINITY, 1);
    say_pose(&h, 40, 0, 1e300, 1);
    say_pose(&h, 40, 0, 1, 0);
    say_pose(&h, 40, 0, 1, NAN);
    say_payload(&h, 10, 7, 0, bytes, 63); /* malformed: no 64 bytes */
    say_payload(&h, 10, 7, 0, bytes, 0);
    say_payload(&h, 11, 7, 0, bytes, 12);       /* a button of 12 bytes */
    say_payload(&h, 12, 7, 0, "\177\0\0\0", 4); /* so many states */
    say_payload(&h, 13, 7, 0, bytes, 7);
    say_payload(&h, -1, 9, 0, bytes, 3); /* a description without a name */
    say_payload(&h, -1, -9, 0, "\0\0\0\2A", 6);
    say_payload(&h, 2000, 7, 0, bytes, 8);   /* a type beyond the table */
    say_payload(&h, 10, 2000, 0, bytes, 64); /* a sender beyond it */
    say_payload(&h, -6, 0, 0, bytes, 8);     /* no such system message */
    say_payload(&h, 10, 8, 0, bytes, 64);    /* unknown: another device, type not described, velocity */
    say_payload(&h, 99, 7, 0, bytes, 64);
    say_payload(&h, 15, 7, 0, bytes, 72);
    say_payload(&h, -3, 4000, 0, "1.2.3.4", 8); /* nothing to us */
    say_payload(&h, -4, 0, 0, bytes, 8);
    say_pose(&h, -4980, 0, 7, 1);
    loopback_until(more(&h, gw_now_ns()),
                   kept.count > 0 && kept.events[kept.count - 1].of.pose.position[0] == 7);
    const gw_source_counters *c = gw_source_count(h.source);
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 7);
    assert_true(kept.events[1].of.pose.orientation[3] == 1);
    assert_int_equal(c->sensors[0].events, 6);
    assert_int_equal(c->sensors[1].events, 1);
    assert_int_equal(c->sensors[0].duplicated, 1);
    assert_int_equal(c->sensors[0].reordered, 1);
    assert_int_equal(c->not_finite, 5);
    assert_int_equal(c->malformed, 10);
    assert_int_equal(c->unknown, 6);
    assert_int_equal(c->losses, 0);
    end(&h);
}

/* Buttons of a whole panel and axes: what differs is an event. */
static void panels(void **state) {
    (void)state;
    hand h;
    begin(&h);
    greet(&h);
    const size_t before = kept.count;
    uint8_t payload[8 + 8 * GW_VRPN_CHANNELS];
    int32_t states[4] = {0, 1, 0, 1};
    double values[2] = {0, 0.25};
    say_payload(&h, 12, 7, 0, payload, gw_vrpn_buttons_write(states, 4, payload));
    say_payload(&h, 12, 7, 0, payload, gw_vrpn_buttons_write(states, 4, payload));
    gw_vrpn_button_write(1, 0, payload);
    say_payload(&h, 11, 7, 0, payload, 8);
    gw_vrpn_button_write(-1, 1, payload);
    say_payload(&h, 11, 7, 0, payload, 8);
    say_payload(&h, 13, 7, 0, payload, gw_vrpn_analog_write(values, 2, payload));
    values[1] = 1;
    say_payload(&h, 13, 7, 0, payload, gw_vrpn_analog_write(values, 2, payload));
    loopback_until(more(&h, gw_now_ns()), loopback_kind(&kept, GW_EVENT_ANALOG) == 3);
    static const int32_t wanted[][2] = {{1, 1}, {3, 1}, {1, 0}};
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(kept.events[before + i].sensor, wanted[i][0]);
        assert_int_equal(kept.events[before + i].of.button.pressed, wanted[i][1]);
        assert_true(kept.events[before + i].device_time == GW_NO_TIME);
    }
    assert_true(kept.events[before + 5].sensor == 1 && kept.events[before + 5].of.analog.value == 1);
    end(&h);
}

/* Of another version, no VRPN at all, silent, closed: each has a name, and the client tries again. */
static void wrong_servers_have_names(void **state) {
    (void)state;
    static const struct {
        const char *greeting;
        gw_source_standing standing;
        const char *detail;
    } rows[] = {{"vrpn: ver. 08.00  0\0\0\0\0\0", GW_SOURCE_OTHER_VERSION, "08.00"},
                {"SSH-2.0-OpenSSH_9.2p1 D\n", GW_SOURCE_OTHER_PROTOCOL, ""},
                {NULL, GW_SOURCE_NO_GREETING, ""}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        hand h;
        gw_source_status status;
        begin(&h);
        if (rows[i].greeting)
            say(&h, rows[i].greeting, GW_VRPN_COOKIE);
        const int64_t ahead = rows[i].greeting ? 0 : 6 * SECOND; /* its patience is over */
        loopback_until((more(&h, gw_now_ns() + ahead), gw_source_look(h.source, gw_now_ns(), &status)),
                       status.standing == rows[i].standing);
        assert_string_equal(status.detail, rows[i].detail);
        assert_int_equal(gw_source_count(h.source)->connections, 0);
        gw_socket_close(&h.socket);
        loopback_until((void)0, more(&h, gw_now_ns() + 10 * SECOND)); /* it came again */
        greet(&h);
        assert_int_equal(gw_source_count(h.source)->connections, 1);
        end(&h);
    }
    hand h;
    begin(&h);
    gw_socket_close(&h.socket);
    gw_socket_close(&h.listening);
    gw_source_status status;
    loopback_until((gw_source_poll(h.source, gw_now_ns() + 10 * SECOND, loopback_keep, &kept),
                    gw_source_look(h.source, gw_now_ns(), &status)),
                   status.standing == GW_SOURCE_REFUSED);
    end(&h);
}

/* A server that ends in the middle of a message, and one whose lengths are impossible. */
static void broken_streams(void **state) {
    (void)state;
    static const int32_t lengths[] = {0, -1, 23, INT32_MAX, 64025};
    uint8_t bytes[88] = {0};
    hand h;
    begin(&h);
    greet(&h);
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        gw_put_int32(bytes, lengths[i]);
        say(&h, bytes, sizeof bytes);
        loopback_until(gw_source_poll(h.source, gw_now_ns(), loopback_keep, &kept),
                       gw_source_count(h.source)->losses == i + 1);
        assert_int_equal(gw_source_count(h.source)->malformed, i + 1);
        gw_socket_close(&h.socket);
        loopback_until((void)0, more(&h, gw_now_ns() + 2 * SECOND));
        gw_vrpn_cookie_write(bytes);
        say(&h, bytes, GW_VRPN_COOKIE);
        loopback_until(more(&h, gw_now_ns()), gw_source_count(h.source)->connections == i + 2);
    }
    gw_put_int32(bytes, 88); /* half a pose, then nothing */
    say(&h, bytes, 44);
    gw_socket_close(&h.socket);
    loopback_until(gw_source_poll(h.source, gw_now_ns(), loopback_keep, &kept),
                   gw_source_count(h.source)->losses == 6);
    loopback_until((void)0, more(&h, gw_now_ns() + 2 * SECOND));
    /* What was described before is forgotten. */
    gw_vrpn_cookie_write(bytes);
    say(&h, bytes, GW_VRPN_COOKIE);
    say_pose(&h, 0, 0, 1, 1);
    loopback_until(more(&h, gw_now_ns()), gw_source_count(h.source)->unknown == 1);
    assert_int_equal(loopback_kind(&kept, GW_EVENT_POSE), 0);
    end(&h);
}

/* Pings each second until a pong; a server that answered once and then falls silent for good is lost. */
static void silent_servers(void **state) {
    (void)state;
    hand h;
    uint8_t bytes[4096];
    size_t size = 0, offset = GW_VRPN_COOKIE, pings = 0;
    begin(&h);
    greet(&h);
    const int64_t now = gw_now_ns();
    for (int i = 1; i <= 12; i++)
        gw_source_poll(h.source, now + i * SECOND, loopback_keep, &kept);
    assert_int_equal(gw_source_count(h.source)->losses, 0); /* it never answered: such servers there are */
    say_payload(&h, 14, 7, 0, NULL, 0);
    loopback_until(more(&h, now + 12 * SECOND), gw_source_count(h.source)->packets == 9);
    for (int i = 13; i <= 40 && gw_source_count(h.source)->losses == 0; i++)
        gw_source_poll(h.source, now + i * SECOND, loopback_keep, &kept);
    assert_int_equal(gw_source_count(h.source)->losses, 1);
    for (ssize_t got; (got = recv(h.socket, bytes + size, sizeof bytes - size, 0)) > 0;)
        size += (size_t)got;
    gw_vrpn_message m;
    while (gw_vrpn_message_read(bytes, size, &offset, &m) == 1)
        pings += m.type == 0;
    assert_true(pings >= 12 + 9);
    end(&h);
}

/* Datagrams of mode B: cut ones, ones that lie, and ones of somebody else. */
static void datagrams_of_all_kinds(void **state) {
    (void)state;
    gw_endpoint at = {.address = "127.0.0.1"}, from, back = at;
    const int lob = gw_socket_datagrams(&at, NULL, &at.port);
    gw_source *source = client_of("vrpn+udp:", "Tracker0", at.port);
    uint8_t data[2048], bytes[256];
    ssize_t got;
    loopback_until(gw_source_poll(source, gw_now_ns(), loopback_keep, &kept),
                   (got = gw_socket_receive(lob, data, sizeof data, 0, NULL, &from)) > 0);
    assert_true(gw_vrpn_callback_read(data, (size_t)got, back.address, &back.port));
    assert_string_equal(back.address, "127.0.0.1");
    /* It asks again. */
    loopback_until(gw_source_poll(source, gw_now_ns() + 3 * SECOND, loopback_keep, &kept),
                   gw_socket_receive(lob, data, sizeof data, 0, NULL, &from) > 0);
    hand h = {.listening = -1, .source = source, .socket = gw_socket_connect(&back, NULL)};
    assert_true(h.socket >= 0);
    loopback_until(gw_source_poll(source, gw_now_ns(), loopback_keep, &kept),
                   gw_socket_settled(h.socket) == 1);
    greet(&h);
    size_t size = 0, offset = GW_VRPN_COOKIE;
    gw_vrpn_message m = {0};
    while ((got = recv(h.socket, data + size, sizeof data - size, MSG_DONTWAIT)) > 0)
        size += (size_t)got;
    assert_int_equal(gw_vrpn_message_read(data, size, &offset, &m), 1); /* first of all, its port */
    assert_true(m.type == GW_VRPN_UDP_DESCRIPTION && m.sender > 0);
    gw_endpoint to = {.address = "127.0.0.1", .port = (uint16_t)m.sender}, other = {.address = "127.0.0.2"};
    const gw_vrpn_pose p = {.orientation = {0, 0, 0, 1}};
    uint8_t payload[GW_VRPN_POSE];
    gw_vrpn_pose_write(&p, payload);
    m = (gw_vrpn_message){
        .type = 10, .sender = 7, .time = 5000 * SECOND, .payload = payload, .payload_size = 64};
    const size_t whole = gw_vrpn_message_write(&m, bytes, sizeof bytes);
    for (size_t cut = 1; cut < whole; cut++)
        gw_socket_send_to(lob, &to, bytes, cut);
    const int stranger = gw_socket_datagrams(&other, NULL, NULL);
    gw_socket_send_to(stranger, &to, bytes, whole);
    m.time -= 10000000; /* late by 10 ms */
    gw_vrpn_message_write(&m, bytes + whole, sizeof bytes - whole);
    gw_socket_send_to(lob, &to, bytes, 2 * whole);
    const gw_source_counters *c = gw_source_count(source);
    loopback_until(gw_source_poll(source, gw_now_ns(), loopback_keep, &kept), c->sensors[0].reordered == 1);
    assert_int_equal(c->malformed, whole - 1);
    assert_int_equal(c->unknown, 1);
    assert_int_equal(c->sensors[0].events, 1);
    close(lob);
    close(stranger);
    end(&h);
}

static void wrong_specs_are_named(void **state) {
    (void)state;
    static const struct {
        const char *spec, *wanted;
    } rows[] = {{"", "nor a tracking source"},
                {"somewhere", "nor a tracking source"},
                {"dtrak:5000", "did you mean 'dtrack:'"},
                {"@host", "NAME@HOST"},
                {"vrpn:host", "NAME@HOST"},
                {"Tracker0@", "no host"},
                {"Tracker0@:3883", "no host"},
                {"Tracker0@host:0", "is no port"},
                {"Tracker0@host:65536", "is no port"},
                {"Tracker0@host:38x", "is no port"},
                {"dtrack:", "name the port"},
                {"dtrack:x", "is no port"},
                {"gaze:somewhere:4000", "no numeric IPv4"},
                {"path:/nowhere.yaml", "/nowhere.yaml"}};
    gw_source *source = NULL;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_fails(gw_source_open(rows[i].spec, NULL, &source, &error), GW_BAD_INPUT, rows[i].wanted);
        assert_null(source);
    }
    const gw_source_options bound = {.bind = "eth0"};
    check_fails(gw_source_open("null", &bound, &source, &error), GW_BAD_INPUT, "eth0");
    const gw_source_options elsewhere = {.bind = "192.0.2.1"};
    check_fails(gw_source_open("dtrack:0", &elsewhere, &source, &error), GW_MACHINE,
                "no address of this machine");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_ways),
        cmocka_unit_test(a_device_that_is_not_there),
        cmocka_unit_test(what_is_wrong_is_counted),
        cmocka_unit_test(panels),
        cmocka_unit_test(wrong_servers_have_names),
        cmocka_unit_test(broken_streams),
        cmocka_unit_test(silent_servers),
        cmocka_unit_test(datagrams_of_all_kinds),
        cmocka_unit_test(wrong_specs_are_named),
    };
    return cmocka_run_group_tests_name("vrpn_client", tests, NULL, NULL);
}
