/* The servers against peers written here by hand: both of VRPN's ways to connect, pongs, datagrams, and
 * clients that are of another version, silent, too slow or talk nonsense; DTrack and gaze senders. */
#include "tests/support/check.h"

#include "base/clock.h"
#include "tracking/big_endian.h"
#include "tracking/dtrack_message.h"
#include "tracking/gaze_datagram.h"
#include "tracking/server.h"
#include "tracking/socket.h"
#include "tracking/vrpn_message.h"

#include <errno.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

static const int64_t DEADLINE = INT64_C(20000000000); /* ns; generous: the machine may be busy */

/* Polls the server until the condition holds. */
#define until(server, condition)                                                                             \
    do {                                                                                                     \
        const int64_t end = gw_now_ns() + DEADLINE;                                                          \
        for (;;) {                                                                                           \
            gw_server_poll(server, gw_now_ns());                                                             \
            if (condition)                                                                                   \
                break;                                                                                       \
            if (gw_now_ns() > end)                                                                           \
                fail_msg("never: %s", #condition);                                                           \
            usleep(200);                                                                                     \
        }                                                                                                    \
    } while (0)

/* A client's connection, and what came by it. */
typedef struct peer {
    int socket;
    size_t size, taken;
    uint8_t bytes[1 << 16];
} peer;

static int more(peer *p) {
    const ssize_t got = recv(p->socket, p->bytes + p->size, sizeof p->bytes - p->size, MSG_DONTWAIT);
    if (got == 0 || (got < 0 && errno == ECONNRESET))
        return -1; /* closed */
    p->size += got > 0 ? (size_t)got : 0;
    return got > 0;
}

static int next(peer *p, gw_vrpn_message *m) {
    more(p);
    return gw_vrpn_message_read(p->bytes, p->size, &p->taken, m);
}

static void say(const peer *p, const void *bytes, size_t size) {
    assert_int_equal(send(p->socket, bytes, size, MSG_NOSIGNAL), size);
}

static void say_message(const peer *p, int32_t type, int32_t sender, const void *payload, size_t size) {
    uint8_t bytes[256];
    const gw_vrpn_message m = {.type = type, .sender = sender, .payload = payload, .payload_size = size};
    say(p, bytes, gw_vrpn_message_write(&m, bytes, sizeof bytes));
}

static void describe(const peer *p, int32_t kind, int32_t id, const char *name) {
    uint8_t bytes[256];
    say(p, bytes, gw_vrpn_description_write(kind, id, 0, name, bytes, sizeof bytes));
}

static gw_server *serve(const char *spec, const gw_server_options *options) {
    gw_server *server = NULL;
    check_ok(gw_server_open(spec, options, &server, &error));
    return server;
}

static void connect_to(gw_server *server, peer *p) {
    const gw_endpoint at = {.address = "127.0.0.1", .port = gw_server_port(server)};
    memset(p, 0, offsetof(peer, bytes));
    p->socket = gw_socket_connect(&at, NULL);
    assert_true(p->socket >= 0);
    until(server, gw_socket_settled(p->socket) == 1);
}

static void greet(gw_server *server, peer *p) {
    uint8_t cookie[GW_VRPN_COOKIE];
    const uint64_t before = gw_server_count(server)->clients;
    gw_vrpn_cookie_write(cookie);
    say(p, cookie, sizeof cookie);
    until(server, gw_server_count(server)->clients == before + 1);
    until(server, more(p) >= 0 && p->size >= GW_VRPN_COOKIE);
    assert_memory_equal(p->bytes, cookie, sizeof cookie);
    p->taken = GW_VRPN_COOKIE;
}

/* Reads the descriptions; returns the number of a type. */
static int32_t type_of(gw_server *server, peer *p, const char *name) {
    gw_vrpn_message m;
    int32_t type = -1;
    while (type < 0) {
        until(server, next(p, &m) == 1);
        const char *told = gw_vrpn_name_read(m.payload, m.payload_size);
        assert_true((m.type == -1 || m.type == -2) && told);
        if (m.type == -1)
            assert_true(m.sender == 0 && strcmp(told, "Tracker0") == 0);
        if (m.type == -2 && strcmp(told, name) == 0)
            type = m.sender;
    }
    return type;
}

static gw_tracking_event pose(int32_t sensor, double x) {
    return (gw_tracking_event){.kind = GW_EVENT_POSE,
                               .sensor = sensor,
                               .device_time = INT64_C(1000500000000),
                               .quality = 1,
                               .of.pose = {.position = {x, 1500, -2000}, .orientation = {0, 0, 0, 1}}};
}

static void clients_by_tcp(void **state) {
    (void)state;
    static peer p;
    const gw_server_options millimetres = {.unit = 1};
    gw_server *server = serve("vrpn:127.0.0.1:0", &millimetres);
    connect_to(server, &p);
    greet(server, &p);
    const int32_t type = type_of(server, &p, GW_VRPN_TYPE_POSE);
    for (int i = 0; i < 5; i++)
        type_of(server, &p,
                (const char *const[]){GW_VRPN_TYPE_BUTTON, GW_VRPN_TYPE_BUTTONS, GW_VRPN_TYPE_ANALOG,
                                      GW_VRPN_TYPE_PING, GW_VRPN_TYPE_PONG}[i]);
    gw_tracking_event event = pose(3, 250);
    gw_server_send(server, &event);
    event.quality = -1; /* not tracked: silence */
    gw_server_send(server, &event);
    event.sensor = GW_SERVER_SENSORS;
    gw_server_send(server, &event);
    gw_vrpn_message m;
    gw_vrpn_pose got;
    until(server, next(&p, &m) == 1);
    assert_true(m.type == type && m.time == event.device_time &&
                gw_vrpn_pose_read(m.payload, m.payload_size, &got));
    assert_true(got.sensor == 3 && got.position[0] == 0.25 && got.position[1] == 1.5 &&
                got.position[2] == -2);
    assert_int_equal(gw_server_count(server)->unsendable, 1);
    /* A ping of this device is answered, one of another and a wish for another rate are not. */
    const uint8_t rate[8] = {0x40};
    describe(&p, -1, 17, "Tracker0");
    describe(&p, -1, 3, "Wand");
    describe(&p, -2, 5, GW_VRPN_TYPE_PING);
    describe(&p, -2, 6, "vrpn_Tracker set_update_rate");
    say_message(&p, 5, 3, NULL, 0);
    say_message(&p, 6, 17, rate, sizeof rate);
    say_message(&p, 5, 17, NULL, 0);
    until(server, next(&p, &m) == 1);
    assert_true(m.payload_size == 0 && m.sender == 0 && m.type > type);
    assert_true(gw_server_count(server)->pings == 1 && gw_server_count(server)->ignored == 2);
    close(p.socket);
    until(server, gw_server_count(server)->connected == 0);
    gw_server_close(&server);
    assert_null(server);
}

static void clients_that_ask_to_be_called(void **state) {
    (void)state;
    static peer p;
    gw_endpoint here = {.address = "127.0.0.1"}, from, to = here;
    gw_server *server = serve("vrpn:127.0.0.1:0", NULL);
    to.port = gw_server_port(server);
    const int listening = gw_socket_listen(&here, &here.port), lob = gw_socket_datagrams(&here, NULL, NULL);
    uint8_t text[32];
    /* Nonsense first, then the wish twice, as clients repeat it. The address leads nowhere: the datagram's
     * own is tried. */
    gw_socket_send_to(lob, &to, "nobody", 7);
    for (int i = 0; i < 2; i++)
        gw_socket_send_to(lob, &to, text, gw_vrpn_callback_write("127.255.255.254", here.port, text));
    memset(&p, 0, offsetof(peer, bytes));
    until(server, (p.socket = gw_socket_accept(listening, &from)) >= 0);
    greet(server, &p);
    assert_int_equal(gw_server_count(server)->malformed, 1);
    /* Poses go to the port that it tells, several in a datagram. */
    gw_endpoint any = {.address = "127.0.0.1"};
    const int datagrams = gw_socket_datagrams(&any, NULL, &any.port);
    uint8_t address[16], data[GW_VRPN_DATAGRAM];
    say_message(&p, GW_VRPN_UDP_DESCRIPTION, any.port, address, gw_vrpn_address_write("127.0.0.1", address));
    describe(&p, -1, 0, "Tracker0");
    describe(&p, -2, 0, GW_VRPN_TYPE_PING);
    say_message(&p, 0, 0, NULL, 0);
    until(server, gw_server_count(server)->pings == 1); /* so all before it is read */
    for (int32_t i = 0; i < 20; i++) {
        const gw_tracking_event event = pose(i % 3, i);
        gw_server_send(server, &event);
    }
    size_t poses = 0;
    const int64_t end = gw_now_ns() + DEADLINE;
    while (poses < 20 && gw_now_ns() < end) {
        gw_server_poll(server, gw_now_ns());
        const ssize_t got = recv(datagrams, data, sizeof data, MSG_DONTWAIT);
        size_t offset = 0;
        gw_vrpn_message m;
        gw_vrpn_pose read;
        while (got > 0 && gw_vrpn_message_read(data, (size_t)got, &offset, &m) == 1) {
            assert_true(gw_vrpn_pose_read(m.payload, m.payload_size, &read) &&
                        read.position[0] == (double)poses);
            poses++;
        }
        assert_true(got <= 0 || offset == (size_t)got);
    }
    assert_int_equal(poses, 20);
    assert_int_equal(gw_server_count(server)->clients, 1);
    close(p.socket);
    close(listening);
    close(lob);
    close(datagrams);
    gw_server_close(&server);
}

static void wrong_clients_are_dropped(void **state) {
    (void)state;
    static peer p;
    gw_server *server = serve("vrpn:127.0.0.1:0", NULL);
    static const char *const greetings[] = {"vrpn: ver. 08.00  0\0\0\0\0",
                                            "GET / HTTP/1.1\r\nHost: x\r\n\r\n"};
    for (int i = 0; i < 2; i++) {
        connect_to(server, &p);
        say(&p, greetings[i], GW_VRPN_COOKIE);
        until(server, more(&p) < 0);
        close(p.socket);
    }
    assert_int_equal(gw_server_count(server)->refused, 2);
    static const int32_t lengths[] = {-1, 0, 23, INT32_MAX, 64025};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        uint8_t bytes[24] = {0};
        connect_to(server, &p);
        greet(server, &p);
        gw_put_int32(bytes, lengths[i]);
        say(&p, bytes, sizeof bytes);
        until(server, more(&p) < 0);
        close(p.socket);
    }
    assert_int_equal(gw_server_count(server)->malformed, 5);
    assert_int_equal(gw_server_count(server)->connected, 0);
    /* Ids beyond the tables, names without an end: counted, and the connection goes on. */
    connect_to(server, &p);
    greet(server, &p);
    describe(&p, -1, 2000, "Tracker0");
    describe(&p, -2, -1, GW_VRPN_TYPE_PING);
    say_message(&p, -1, 0, "\0\0\0\5abcde", 9);
    say_message(&p, INT32_MAX, 0, NULL, 0);
    say_message(&p, 0, INT32_MIN, NULL, 0);
    say_message(&p, -3, 70000, "127.0.0.1", 10);
    until(server, gw_server_count(server)->malformed == 11);
    assert_int_equal(gw_server_count(server)->connected, 1);
    close(p.socket);
    gw_server_close(&server);
}

static void a_client_that_does_not_read_is_dropped(void **state) {
    (void)state;
    static peer p, good;
    gw_server *server = serve("vrpn:127.0.0.1:0", NULL);
    connect_to(server, &p);
    greet(server, &p);
    connect_to(server, &good);
    greet(server, &good);
    const gw_tracking_event event = pose(0, 1);
    uint64_t taken = 0;
    gw_vrpn_message m;
    for (int i = 0; i < 1000000 && gw_server_count(server)->slow == 0; i++) {
        gw_server_send(server, &event);
        if (i % 64)
            continue;
        gw_server_poll(server, gw_now_ns());
        while (more(&good) > 0) {
            while (gw_vrpn_message_read(good.bytes, good.size, &good.taken, &m) == 1)
                taken++;
            memmove(good.bytes, good.bytes + good.taken, good.size - good.taken);
            good.size -= good.taken;
            good.taken = 0;
        }
    }
    assert_int_equal(gw_server_count(server)->slow, 1);
    assert_int_equal(gw_server_count(server)->connected, 1);
    assert_true(taken > 1000);
    close(p.socket);
    close(good.socket);
    gw_server_close(&server);
}

static void dtrack_frames(void **state) {
    (void)state;
    gw_endpoint here = {.address = "127.0.0.1"};
    const int listening = gw_socket_datagrams(&here, NULL, &here.port);
    char spec[64];
    uint8_t data[4096];
    static gw_dtrack_frame frame;
    snprintf(spec, sizeof spec, "dtrack:127.0.0.1:%u", (unsigned)here.port);
    gw_server *server = serve(spec, NULL); /* events in metres */
    gw_tracking_event event = pose(1, 0.25);
    gw_server_send(server, &event);
    event = (gw_tracking_event){.kind = GW_EVENT_BUTTON, .sensor = 2, .device_time = event.device_time};
    event.of.button.pressed = 1;
    gw_server_send(server, &event);
    event.sensor = 16; /* more buttons than readers take */
    gw_server_send(server, &event);
    assert_int_equal(gw_server_count(server)->unsendable, 1);
    event = (gw_tracking_event){
        .kind = GW_EVENT_GAZE, .sensor = 1, .device_time = event.device_time, .quality = 1};
    event.of.gaze.direction[0] = 1; /* to the right: a quarter turn about -y */
    gw_server_send(server, &event);
    gw_server_poll(server, gw_now_ns());
    const ssize_t size = recv(listening, data, sizeof data, 0);
    assert_true(size > 0 && gw_dtrack_read(data, (size_t)size, &frame));
    assert_true(frame.frame == 1 && frame.day_time == INT64_C(1000500000000) && frame.calibrated == 4);
    assert_true(!frame.bodies[0].listed && frame.bodies[1].tracked && frame.bodies[1].position[0] == 250);
    assert_true(frame.bodies[3].tracked && frame.bodies[3].orientation[1] < -0.707);
    assert_true(frame.flysticks[0].buttons == 4 && !frame.flysticks[0].pose.tracked);
    gw_server_poll(server, gw_now_ns()); /* nothing new: no frame */
    assert_int_equal(gw_server_count(server)->messages, 1);
    event = pose(0, 0);
    event.device_time += 200000000; /* the others have not been seen for 0.2 s */
    gw_server_send(server, &event);
    gw_server_poll(server, gw_now_ns());
    const ssize_t second = recv(listening, data, sizeof data, 0);
    assert_true(second > 0 && gw_dtrack_read(data, (size_t)second, &frame));
    assert_true(frame.frame == 2 && frame.bodies[0].tracked && !frame.bodies[1].tracked);
    /* A body that reports twice as often as another makes no frame that would repeat the other's pose. */
    const int64_t begin = event.device_time;
    for (int i = 1; i <= 12; i++) {
        event = pose(1, 0);
        event.device_time = begin + i * 8000000;
        gw_server_send(server, &event);
        if (i % 2 == 0) {
            event.sensor = 0;
            gw_server_send(server, &event);
        }
        gw_server_poll(server, gw_now_ns());
    }
    assert_int_equal(gw_server_count(server)->messages, 2 + 6);
    close(listening);
    gw_server_close(&server);
}

static void gaze_datagrams(void **state) {
    (void)state;
    gw_endpoint here = {.address = "127.0.0.1"};
    const int listening = gw_socket_datagrams(&here, NULL, &here.port);
    const gw_server_options millimetres = {.unit = 1};
    char spec[64];
    uint8_t data[128];
    snprintf(spec, sizeof spec, "gaze:%u", (unsigned)here.port);
    gw_server *server = serve(spec, &millimetres);
    gw_tracking_event event = {.kind = GW_EVENT_GAZE, .sensor = 2, .device_time = 5, .quality = 0.5}, got;
    gw_gaze_extra extra;
    event.of.gaze.has_origin = 1;
    event.of.gaze.origin[0] = 250;
    event.of.gaze.direction[2] = -1;
    for (uint32_t i = 0; i < 3; i++) {
        gw_server_send(server, &event);
        const ssize_t size = recv(listening, data, sizeof data, 0);
        assert_int_equal(gw_gaze_datagram_read(data, (size_t)size, &got, &extra), GW_GAZE_READ);
        assert_true(extra.sequence == i && got.sensor == 2 && got.of.gaze.origin[0] == 0.25 &&
                    got.device_time == 5);
    }
    event = pose(0, 1);
    gw_server_send(server, &event);
    assert_int_equal(gw_server_count(server)->unsendable, 1);
    close(listening);
    gw_server_close(&server);
}

static void wrong_specs_are_named(void **state) {
    (void)state;
    static const struct {
        const char *spec, *wanted;
    } rows[] = {{"", "is no server"},
                {"vrpnx:1", "is no server"},
                {"opentrack", "is no server"},
                {"vrpn:70000", "is no port"},
                {"vrpn:x", "is no port"},
                {"vrpn:host:3883", "no numeric IPv4 address"},
                {"vrpn:1.2.3.4.5.6.7.8.9:3883", "no numeric IPv4 address"},
                {"dtrack:0", "name the port"},
                {"gaze", "name the port"}};
    gw_server *server = NULL;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_fails(gw_server_open(rows[i].spec, NULL, &server, &error), GW_BAD_INPUT, rows[i].wanted);
        check_fails(gw_server_check(rows[i].spec, &error), GW_BAD_INPUT, rows[i].wanted);
    }
    gw_server *first = serve("vrpn:127.0.0.1:0", NULL);
    char spec[64];
    snprintf(spec, sizeof spec, "vrpn:127.0.0.1:%u", (unsigned)gw_server_port(first));
    check_fails(gw_server_open(spec, NULL, &server, &error), GW_MACHINE, "take another port");
    gw_server_close(&first);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clients_by_tcp),
        cmocka_unit_test(clients_that_ask_to_be_called),
        cmocka_unit_test(wrong_clients_are_dropped),
        cmocka_unit_test(a_client_that_does_not_read_is_dropped),
        cmocka_unit_test(dtrack_frames),
        cmocka_unit_test(gaze_datagrams),
        cmocka_unit_test(wrong_specs_are_named),
    };
    return cmocka_run_group_tests_name("server", tests, NULL, NULL);
}
