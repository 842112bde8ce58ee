/* What a tile that was started again comes back by: its hello, the wire over TCP, and rank 0's door, which
 * nobody who does not belong there passes or holds up. */
#include "tests/support/check.h"

#include "base/clock.h"
#include "tests/fuzz/rejoin_entry.h"
#include "wall/gate_door.h"
#include "wall/reach.h"
#include "wall/site.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

static const char secret[] = "0123456789abcdef0123456789abcdef",
                  program[] = "fedcba9876543210fedcba9876543210";

static gw_rejoin_hello good_hello(void) {
    gw_rejoin_hello hello = {.tile = 4, .start = 1, .process = 4711};
    strcpy(hello.secret, secret);
    strcpy(hello.program, program);
    return hello;
}

static void a_hello_is_whole_or_none(void **state) {
    (void)state;
    const gw_rejoin_hello hello = good_hello();
    gw_rejoin_hello got;
    uint8_t bytes[GW_REJOIN_HELLO];
    gw_rejoin_hello_write(&hello, bytes);
    assert_null(gw_rejoin_hello_read(bytes, sizeof bytes, &got));
    assert_memory_equal(&got, &hello, sizeof got);
    for (size_t size = 0; size < sizeof bytes; size++) {
        uint8_t *exact = malloc(size ? size : 1);
        memcpy(exact, bytes, size);
        assert_non_null(gw_rejoin_hello_read(exact, size, &got));
        fuzz_rejoin(exact, size);
        free(exact);
    }
    for (size_t bit = 0; bit < 8 * sizeof bytes; bit++) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        assert_non_null(gw_rejoin_hello_read(bytes, sizeof bytes, &got));
        fuzz_rejoin(bytes, sizeof bytes);
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    fuzz_rejoin(bytes, sizeof bytes);
    const gw_rejoin_hello wrong[] = {{.tile = 0, .start = 1, .process = 1},
                                     {.tile = GW_MAXIMUM_TILES, .start = 1, .process = 1},
                                     {.tile = 1, .start = 0, .process = 1},
                                     {.tile = 1, .start = 1, .site = 1, .process = 1},
                                     {.tile = 1, .start = 1, .process = 0}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        gw_rejoin_hello_write(&wrong[i], bytes);
        assert_non_null(gw_rejoin_hello_read(bytes, sizeof bytes, &got));
    }
}

static void places_are_read_whole(void **state) {
    (void)state;
    gw_rejoin_place place;
    assert_int_equal(gw_rejoin_place_read("12:3:10.0.0.1:40123", &place), 1);
    assert_true(place.tile == 12 && place.start == 3 && place.port == 40123);
    assert_string_equal(place.address, "10.0.0.1");
    assert_int_equal(gw_rejoin_place_read("1:1:fe80::1:7000", &place), 1);
    assert_string_equal(place.address, "fe80::1");
    static const char *const wrong[] = {"",
                                        "1",
                                        "1:1",
                                        "1:1:a",
                                        "1:1:a:",
                                        "1:1::7",
                                        "0:1:a:7",
                                        "1:0:a:7",
                                        "64:1:a:7",
                                        "1:1:a:0",
                                        "1:1:a:65536",
                                        "1:1:a:7x",
                                        "-1:1:a:7",
                                        "1: 1:a:7",
                                        "1:4294967296:a:7",
                                        "99999999999999999999:1:a:7"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        if (gw_rejoin_place_read(wrong[i], &place))
            fail_msg("'%s' was taken for a place", wrong[i]);
}

/* --- the wire
 * ------------------------------------------------------------------------------------------------- */

static void make_wires(gw_wire *ends[2]) {
    int sockets[2];
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, sockets), 0);
    for (int i = 0; i < 2; i++)
        check_ok(gw_wire_tcp(sockets[i], &ends[i], &error));
}

/* A stream of messages and blocks, whole and in order, though neither end ever waits. */
static void a_wire_carries_messages_and_blocks(void **state) {
    (void)state;
    enum { BLOCK = 3 << 20 };
    gw_wire *ends[2];
    uint8_t message[GW_WIRE_MESSAGE], got[GW_WIRE_MESSAGE], *block = malloc(BLOCK), *copy = calloc(1, BLOCK);
    size_t size = 0;
    make_wires(ends);
    for (size_t i = 0; i < BLOCK; i++)
        block[i] = (uint8_t)(i * 2654435761u >> 13);
    assert_int_equal(ends[1]->receive(ends[1], got, &size), GW_WIRE_NOT_YET);
    for (size_t length = 0; length <= GW_WIRE_MESSAGE; length += 512) {
        memset(message, (int)length / 512, length);
        assert_int_equal(ends[0]->send(ends[0], message, length), GW_WIRE_DONE);
        assert_int_equal(ends[1]->receive(ends[1], got, &size), GW_WIRE_DONE);
        assert_int_equal(size, length);
        assert_memory_equal(got, message, length);
    }
    int sent = 0, received = 0, turns = 0;
    for (; !sent || !received; turns++) {
        if (!sent)
            sent = ends[0]->send_block(ends[0], block, BLOCK) == GW_WIRE_DONE;
        if (!received)
            received = ends[1]->receive_block(ends[1], copy, BLOCK) == GW_WIRE_DONE;
        assert_true(turns < 1000);
    }
    assert_true(turns > 1); /* else nothing of this was tried */
    assert_memory_equal(block, copy, BLOCK);
    assert_int_equal(ends[0]->send(ends[0], "after", 5), GW_WIRE_DONE);
    assert_int_equal(ends[1]->receive(ends[1], got, &size), GW_WIRE_DONE);
    assert_memory_equal(got, "after", 5);
    assert_int_equal(ends[0]->is_sent(ends[0]), 1);
    ends[0]->close(ends[0]);
    assert_int_equal(ends[1]->receive(ends[1], got, &size), GW_WIRE_BROKEN);
    ends[1]->close(ends[1]);
    free(block);
    free(copy);
}

/* What one end sends and the other does not expect breaks the line instead of being taken for something else.
 */
static void a_wire_breaks_on_nonsense(void **state) {
    (void)state;
    uint8_t got[GW_WIRE_MESSAGE], block[64] = {0};
    static const char too_long[] = "GWM1\x01\x10\0\0", noise[] = "GET / HTTP/1.0\r\n\r\n";
    for (int kind = 0; kind < 4; kind++) {
        gw_wire *ends[2];
        size_t size = 0;
        make_wires(ends);
        if (kind == 0)
            ends[0]->send_block(ends[0], block, sizeof block); /* a message was due */
        if (kind == 1)
            assert_int_equal(send(ends[0]->descriptor, too_long, 8, 0), 8);
        if (kind == 2)
            assert_int_equal(send(ends[0]->descriptor, noise, sizeof noise - 1, 0), (int)sizeof noise - 1);
        if (kind == 3) {
            ends[0]->send_block(ends[0], block, sizeof block - 1); /* one byte more was due */
            assert_int_equal(ends[1]->receive_block(ends[1], block, sizeof block), GW_WIRE_BROKEN);
        } else
            assert_int_equal(ends[1]->receive(ends[1], got, &size), GW_WIRE_BROKEN);
        ends[0]->close(ends[0]);
        ends[1]->close(ends[1]);
    }
}

/* A reader that does not read costs the writer nothing but NOT_YET. */
static void a_wire_never_waits(void **state) {
    (void)state;
    gw_wire *ends[2];
    const uint8_t message[GW_WIRE_MESSAGE] = {0};
    make_wires(ends);
    int sent = 0;
    while (ends[0]->send(ends[0], message, sizeof message) == GW_WIRE_DONE && sent < 100000)
        sent++;
    assert_true(sent > 0 && sent < 100000);
    assert_int_equal(ends[0]->is_sent(ends[0]), 0);
    ends[0]->close(ends[0]);
    ends[1]->close(ends[1]);
}

/* --- the door
 * ------------------------------------------------------------------------------------------------- */

typedef struct wall {
    gw_door *door;
    gw_door_keeper keeper;
    const char *refusal; /* of the gate's */
    gw_log log;
    int lines;
    char last[512];
} wall;

static const char *refuse(void *context, uint32_t tile, uint32_t start) {
    (void)start;
    return tile == 4 ? ((wall *)context)->refusal : "the wall has no such tile";
}

static int is_here(void *context, uint32_t tile) {
    (void)context;
    return tile == 4;
}

static const char *name(void *context, uint32_t tile) {
    (void)context;
    (void)tile;
    return "c1r1";
}

static void keep_line(void *context, gw_log_level level, const char *text) {
    wall *w = context;
    w->lines += level == GW_LOG_WARNING;
    snprintf(w->last, sizeof w->last, "%.511s", text);
}

static void open_door(wall *w) {
    static gw_site site;
    memset(w, 0, sizeof *w);
    gw_site_defaults(&site);
    site.layout.tile_count = 6;
    w->log = (gw_log){.threshold = GW_LOG_INFO, .context = w, .line = keep_line};
    w->keeper = (gw_door_keeper){.context = w,
                                 .refuse = refuse,
                                 .is_here = is_here,
                                 .name = name,
                                 .site = &site,
                                 .site_epoch = 7,
                                 .number = 42};
    const gw_door_options options = {.address = "127.0.0.1",
                                     .secret = secret,
                                     .program = program,
                                     .keys = {.scene = {1, 2}, .octree = {3, 4}},
                                     .patience = 60 * INT64_C(1000000000),
                                     .log = &w->log};
    check_ok(gw_door_open(&options, &w->door, &error));
}

static int call(const wall *w) {
    int made = -1;
    const char *port = strrchr(gw_door_name(w->door), ':');
    assert_int_equal(gw_reach_tcp("127.0.0.1", (uint16_t)atoi(port + 1), 5000, &made), GW_REACHED);
    return made;
}

/* Until so many connections were dropped; 30 s are enough anywhere. */
static void attend_until_refused(wall *w, uint32_t count) {
    for (int turn = 0; turn < 5000 && gw_door_refused(w->door) < count; turn++) {
        gw_door_attend(w->door, &w->keeper);
        poll(NULL, 0, 6);
    }
    assert_int_equal(gw_door_refused(w->door), count);
}

static gw_wire *knock(const wall *w, const gw_rejoin_hello *hello) {
    gw_wire *wire = NULL;
    uint8_t bytes[GW_REJOIN_HELLO];
    check_ok(gw_wire_tcp(call(w), &wire, &error));
    gw_rejoin_hello_write(hello, bytes);
    assert_int_equal(wire->send(wire, bytes, sizeof bytes), GW_WIRE_DONE);
    return wire;
}

/* The next message at the tile's end while the door is attended. */
static size_t hear(wall *w, gw_wire *wire, void *message) {
    size_t size = 0;
    gw_wire_result result = GW_WIRE_NOT_YET;
    for (int turn = 0; turn < 5000 && result == GW_WIRE_NOT_YET; turn++) {
        gw_door_attend(w->door, &w->keeper);
        result = wire->receive(wire, message, &size);
        poll(NULL, 0, 1);
    }
    return result == GW_WIRE_DONE ? size : 0;
}

/* In from the street: garbage, silence in part, a wrong secret, a flood. None gets an answer, all are
 * counted, and a tile comes in all the same. */
static void strangers_stay_outside(void **state) {
    (void)state;
    enum { FLOOD = 60 };
    wall w;
    uint8_t message[GW_WIRE_MESSAGE];
    open_door(&w);
    int garbage = call(&w), silent[FLOOD];
    assert_int_equal(send(garbage, "GET / HTTP/1.0\r\n\r\n", 18, 0), 18);
    attend_until_refused(&w, 1);
    assert_non_null(
        strstr(w.last, "a connection from 127.0.0.1 was dropped at the gate: what it sent is no hello"));
    gw_rejoin_hello hello = good_hello();
    hello.secret[31] ^= 1;
    gw_wire *wrong = knock(&w, &hello);
    assert_int_equal(hear(&w, wrong, message), 0);
    assert_int_equal(gw_door_refused(w.door), 2);
    for (int i = 0; i < FLOOD; i++) { /* what fits into the kernel's queue, and more */
        silent[i] = call(&w);
        if (i % 3 == 0)
            assert_int_equal(send(silent[i], "GWM", 3, MSG_NOSIGNAL), 3);
        if (i % 12 == 11)
            gw_door_attend(w.door, &w.keeper), poll(NULL, 0, 120);
    }
    hello = good_hello();
    gw_wire *tile = knock(&w, &hello);
    assert_int_equal(hear(&w, tile, message), sizeof(gw_rejoin_welcome));
    assert_true(gw_door_refused(w.door) > 20);
    assert_true(w.lines < 20); /* not one line for each */
    close(garbage);
    for (int i = 0; i < FLOOD; i++)
        close(silent[i]);
    wrong->close(wrong);
    tile->close(tile);
    gw_door_close(&w.door);
}

static void tiles_are_refused_by_name(void **state) {
    (void)state;
    wall w;
    uint8_t message[GW_WIRE_MESSAGE];
    open_door(&w);
    gw_rejoin_welcome welcome;
    for (int kind = 0; kind < 3; kind++) {
        gw_rejoin_hello hello = good_hello();
        w.refusal = kind == 0 ? "its tile is still here" : NULL;
        hello.tile = kind == 1 ? 5 : 4;
        hello.program[3] = kind == 2 ? 'x' : hello.program[3];
        gw_wire *tile = knock(&w, &hello);
        assert_int_equal(hear(&w, tile, message), sizeof welcome);
        memcpy(&welcome, message, sizeof welcome);
        static const char *const why[] = {"its tile is still here", "no such tile", "another program"};
        assert_true(welcome.taken == 0 && strstr(welcome.text, why[kind]));
        assert_int_equal(gw_door_refused(w.door), kind + 1);
        tile->close(tile);
    }
    gw_door_close(&w.door);
}

/* From the hello to the gate: welcome, the site, ready. */
static void a_tile_comes_in(void **state) {
    (void)state;
    static gw_site site;
    wall w;
    uint8_t message[GW_WIRE_MESSAGE];
    gw_newcomer newcomer;
    gw_rejoin_welcome welcome;
    open_door(&w);
    gw_rejoin_hello hello = good_hello();
    gw_wire *old = knock(&w, &hello);
    assert_int_equal(hear(&w, old, message), sizeof welcome);
    gw_wire *same = knock(&w, &hello);
    assert_int_equal(hear(&w, same, message), sizeof welcome);
    memcpy(&welcome, message, sizeof welcome);
    assert_true(!welcome.taken && strstr(welcome.text, "another process"));
    hello.start = 2;
    gw_wire *tile = knock(&w, &hello);
    assert_int_equal(hear(&w, tile, message), sizeof welcome);
    memcpy(&welcome, message, sizeof welcome);
    assert_true(welcome.taken && welcome.here && welcome.site == 7 && welcome.number == 42);
    assert_true(welcome.keys.scene.low == 2 && welcome.keys.octree.high == 3);
    gw_wire_result result = GW_WIRE_NOT_YET;
    for (int turn = 0; turn < 5000 && result == GW_WIRE_NOT_YET; turn++) {
        gw_door_attend(w.door, &w.keeper);
        result = tile->receive_block(tile, &site, sizeof site);
        poll(NULL, 0, 1);
    }
    assert_int_equal(result, GW_WIRE_DONE);
    assert_int_equal(site.layout.tile_count, 6);
    assert_int_equal(gw_door_take(w.door, &newcomer), 0);
    const gw_rejoin_ready ready = {.scene = {1, 2}, .octree = {3, 4}};
    assert_int_equal(tile->send(tile, &ready, sizeof ready), GW_WIRE_DONE);
    int taken = 0;
    for (int turn = 0; turn < 5000 && !taken; turn++) {
        gw_door_attend(w.door, &w.keeper);
        taken = gw_door_take(w.door, &newcomer);
        poll(NULL, 0, 1);
    }
    assert_true(taken && newcomer.tile == 4 && newcomer.start == 2 && newcomer.site == 7 &&
                newcomer.process == 4711);
    assert_int_equal(newcomer.wire->send(newcomer.wire, "frame", 5), GW_WIRE_DONE);
    assert_int_equal(hear(&w, tile, message), 5);
    newcomer.wire->close(newcomer.wire);
    old->close(old);
    same->close(same);
    tile->close(tile);
    gw_door_close(&w.door);
}

/* One that has loaded something else is not let in. */
static void another_scene_stays_outside(void **state) {
    (void)state;
    static gw_site site;
    wall w;
    uint8_t message[GW_WIRE_MESSAGE];
    open_door(&w);
    const gw_rejoin_hello hello = good_hello();
    gw_wire *tile = knock(&w, &hello);
    assert_int_equal(hear(&w, tile, message), sizeof(gw_rejoin_welcome));
    while (tile->receive_block(tile, &site, sizeof site) == GW_WIRE_NOT_YET) {
        gw_door_attend(w.door, &w.keeper);
        poll(NULL, 0, 1);
    }
    const gw_rejoin_ready ready = {.scene = {1, 2}, .octree = {3, 5}};
    assert_int_equal(tile->send(tile, &ready, sizeof ready), GW_WIRE_DONE);
    attend_until_refused(&w, 1);
    assert_non_null(strstr(w.last, "another scene"));
    assert_int_equal(hear(&w, tile, message), 0);
    tile->close(tile);
    gw_door_close(&w.door);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hello_is_whole_or_none),
        cmocka_unit_test(places_are_read_whole),
        cmocka_unit_test(a_wire_carries_messages_and_blocks),
        cmocka_unit_test(a_wire_breaks_on_nonsense),
        cmocka_unit_test(a_wire_never_waits),
        cmocka_unit_test(strangers_stay_outside),
        cmocka_unit_test(tiles_are_refused_by_name),
        cmocka_unit_test(a_tile_comes_in),
        cmocka_unit_test(another_scene_stays_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
