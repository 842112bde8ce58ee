/* VRPN's messages: the golden vectors of the reference implementation byte for byte, in both directions, and
 * bytes that lie about everything. */
#include "tests/support/check.h"

#include "tests/fuzz/vrpn_message_entry.h"
#include "tests/support/hex.h"
#include "tests/support/mangle.h"
#include "tracking/vrpn_message.h"

#include <math.h>

static const int64_t GOLDEN_TIME = INT64_C(1000500000000);
static const char cookie_hex[] = "7672706e 3a207665 722e2030 372e3338 20203000 00000000";
static const char sender_hex[] =
    "00000025 000003e8 0007a120 00000000 ffffffff 00000000 00000009 54726163 6b657230 00000000";
static const char type_hex[] = "00000032 000003e8 0007a120 00000003 fffffffe 00000000 00000016 7672706e "
                               "5f547261 636b6572 20506f73 5f517561 74000000 00000000";
static const char udp_hex[] =
    "00000025 000003e8 0007a120 0000c822 fffffffd 00000000 3139322e 3136382e 312e3130 00000000";
static const char pose_hex[] =
    "00000058 000003e8 0007a120 00000000 00000003 00000001 00000000 00000000 3fd00000 00000000 3ff80000 "
    "00000000 c0000000 00000000 00000000 00000000 3fe6a09e 667f3bcd 00000000 00000000 3fe6a09e 667f3bcd";

static void same_bytes(const uint8_t *bytes, size_t size, const char *hex) {
    uint8_t wanted[256];
    const size_t wanted_size = hex_bytes(hex, wanted, sizeof wanted);
    assert_int_equal(size, wanted_size);
    assert_memory_equal(bytes, wanted, size);
}

static gw_vrpn_message read_hex(const char *hex, uint8_t bytes[256]) {
    const size_t size = hex_bytes(hex, bytes, 256);
    gw_vrpn_message message;
    size_t offset = 0;
    assert_int_equal(gw_vrpn_message_read(bytes, size, &offset, &message), 1);
    assert_int_equal(offset, size);
    assert_true(message.time == GOLDEN_TIME);
    return message;
}

static void golden_bytes_are_written(void **state) {
    (void)state;
    uint8_t bytes[256], payload[GW_VRPN_POSE], address[16];
    gw_vrpn_cookie_write(bytes);
    same_bytes(bytes, GW_VRPN_COOKIE, cookie_hex);
    same_bytes(bytes, gw_vrpn_description_write(-1, 0, GOLDEN_TIME, "Tracker0", bytes, sizeof bytes),
               sender_hex);
    same_bytes(bytes, gw_vrpn_description_write(-2, 3, GOLDEN_TIME, GW_VRPN_TYPE_POSE, bytes, sizeof bytes),
               type_hex);
    gw_vrpn_message message = {.type = GW_VRPN_UDP_DESCRIPTION,
                               .sender = 51234,
                               .time = GOLDEN_TIME,
                               .payload = address,
                               .payload_size = gw_vrpn_address_write("192.168.1.10", address)};
    same_bytes(bytes, gw_vrpn_message_write(&message, bytes, sizeof bytes), udp_hex);
    const double half = 0.70710678118654752440;
    const gw_vrpn_pose pose = {.position = {0.25, 1.5, -2}, .orientation = {0, half, 0, half}};
    gw_vrpn_pose_write(&pose, payload);
    message = (gw_vrpn_message){
        .type = 3, .sequence = 1, .time = GOLDEN_TIME, .payload = payload, .payload_size = sizeof payload};
    same_bytes(bytes, gw_vrpn_message_write(&message, bytes, sizeof bytes), pose_hex);
}

static void golden_bytes_are_read(void **state) {
    (void)state;
    uint8_t bytes[256];
    char address[16];
    hex_bytes(cookie_hex, bytes, sizeof bytes);
    assert_int_equal(gw_vrpn_cookie_read(bytes), GW_VRPN_SPEAKS);
    gw_vrpn_message m = read_hex(sender_hex, bytes);
    assert_true(m.type == -1 && m.sender == 0);
    assert_string_equal(gw_vrpn_name_read(m.payload, m.payload_size), "Tracker0");
    m = read_hex(type_hex, bytes);
    assert_true(m.type == -2 && m.sender == 3);
    assert_string_equal(gw_vrpn_name_read(m.payload, m.payload_size), GW_VRPN_TYPE_POSE);
    m = read_hex(udp_hex, bytes);
    assert_true(m.type == -3 && m.sender == 51234 &&
                gw_vrpn_address_read(m.payload, m.payload_size, address));
    assert_string_equal(address, "192.168.1.10");
    m = read_hex(pose_hex, bytes);
    gw_vrpn_pose pose;
    assert_true(m.type == 3 && m.sender == 0 && m.sequence == 1);
    assert_true(gw_vrpn_pose_read(m.payload, m.payload_size, &pose));
    assert_true(pose.sensor == 0 && pose.position[0] == 0.25 && pose.position[1] == 1.5 &&
                pose.position[2] == -2);
    assert_true(pose.orientation[0] == 0 && fabs(pose.orientation[1] - sqrt(0.5)) < 1e-15 &&
                pose.orientation[2] == 0 && pose.orientation[3] == pose.orientation[1]);
}

static void versions_are_told_apart(void **state) {
    (void)state;
    static const struct {
        const char *text;
        gw_vrpn_greeting wanted;
    } rows[] = {{"vrpn: ver. 07.38  0", GW_VRPN_SPEAKS},
                {"vrpn: ver. 07.00  3", GW_VRPN_SPEAKS},
                {"vrpn: ver. 08.00  0", GW_VRPN_OTHER_VERSION},
                {"vrpn: ver. 17.38  0", GW_VRPN_OTHER_VERSION},
                {"vrpn: ver. 7.38   0", GW_VRPN_OTHER_VERSION},
                {"SSH-2.0-OpenSSH_9.2", GW_VRPN_OTHER_PROTOCOL},
                {"", GW_VRPN_OTHER_PROTOCOL}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t cookie[GW_VRPN_COOKIE] = {0};
        memcpy(cookie, rows[i].text, strlen(rows[i].text));
        assert_int_equal(gw_vrpn_cookie_read(cookie), rows[i].wanted);
    }
}

static void payloads_round_trip(void **state) {
    (void)state;
    uint8_t payload[8 + 8 * GW_VRPN_CHANNELS];
    int32_t button, pressed, states[GW_VRPN_CHANNELS] = {1, 0, -7};
    double values[GW_VRPN_CHANNELS] = {0.5, -1, 1e-300}, read[GW_VRPN_CHANNELS];
    gw_vrpn_button_write(7, 1, payload);
    assert_true(gw_vrpn_button_read(payload, 8, &button, &pressed) && button == 7 && pressed == 1);
    size_t size = gw_vrpn_buttons_write(states, 3, payload);
    assert_int_equal(size, 16);
    assert_int_equal(gw_vrpn_buttons_read(payload, size, states), 3);
    assert_int_equal(states[2], -7);
    size = gw_vrpn_analog_write(values, 3, payload);
    assert_int_equal(size, 32);
    assert_int_equal(gw_vrpn_analog_read(payload, size, read), 3);
    assert_memory_equal(values, read, 3 * sizeof read[0]);
    for (size_t less = 0; less < size; less++)
        assert_int_equal(gw_vrpn_analog_read(payload, less, read), -1);
    values[0] = NAN; /* a count that is none */
    memcpy(payload, &values[0], 8);
    assert_int_equal(gw_vrpn_analog_read(payload, size, read), -1);
}

static void call_backs(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int port; /* 0: refused */
    } rows[] = {{"127.0.0.1 1024", 1024},
                {"192.168.1.10 51234", 51234},
                {"127.0.0.1 1023", 0},
                {"127.0.0.1 65536", 0},
                {"127.0.0.1", 0},
                {"127.0.0.1 ", 0},
                {"lab-7.example.org 4000", 0},
                {"localhost 4000", 0},
                {"127.0.0.1 4000x", 0},
                {" 127.0.0.1 4000", 0},
                {"127.0.0.1  4000", 0},
                {"", 0},
                {"127.0.0.1 -4000", 0},
                {"127.0.0.1 4294968320", 0},
                {"1.2.3.4.5 4000", 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (int zero = 0; zero < 2; zero++) { /* with its zero byte and without */
            char address[16];
            uint16_t port = 0;
            const int read = gw_vrpn_callback_read((const uint8_t *)rows[i].text,
                                                   strlen(rows[i].text) + (size_t)zero, address, &port);
            assert_int_equal(read ? port : 0, rows[i].port);
        }
    uint8_t data[32];
    assert_int_equal(gw_vrpn_callback_write("192.168.1.10", 51234, data), 19);
    assert_string_equal((char *)data, "192.168.1.10 51234");
}

static void impossible_lengths_are_refused(void **state) {
    (void)state;
    static const int32_t lengths[] = {-1, 0, 23, INT32_MIN, INT32_MAX, 64025};
    uint8_t bytes[256];
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        gw_vrpn_message message;
        size_t offset = 0;
        hex_bytes(pose_hex, bytes, sizeof bytes);
        for (int k = 0; k < 4; k++)
            bytes[k] = (uint8_t)((uint32_t)lengths[i] >> (24 - 8 * k));
        assert_int_equal(gw_vrpn_message_read(bytes, 88, &offset, &message), -1);
        assert_int_equal(offset, 0);
    }
}

static void names_that_do_not_fit_are_not_written(void **state) {
    (void)state;
    uint8_t bytes[256];
    char name[GW_VRPN_NAME + 1];
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_int_equal(gw_vrpn_description_write(-1, 0, 0, name, bytes, sizeof bytes), 0);
    name[GW_VRPN_NAME - 1] = '\0';
    assert_int_equal(gw_vrpn_description_write(-1, 0, 0, name, bytes, sizeof bytes), 24 + 104);
    assert_int_equal(gw_vrpn_description_write(-1, 0, 0, name, bytes, 127), 0);
    assert_int_equal(gw_vrpn_description_write(-1, 0, 0, "", bytes, sizeof bytes), 0);
}

static void mangled_bytes_never_break_the_reader(void **state) {
    (void)state;
    uint8_t bytes[1024];
    size_t size = 0;
    const char *const parts[] = {sender_hex, type_hex, udp_hex, pose_hex};
    for (int i = 0; i < 4; i++)
        size += hex_bytes(parts[i], bytes + size, sizeof bytes - size);
    mangle(fuzz_vrpn_message, bytes, size, 5000);
    for (int i = 0; i < 4; i++) {
        size = hex_bytes(parts[i], bytes, sizeof bytes);
        mangle(fuzz_vrpn_payload, bytes + 24, size - 24, 500);
    }
    mangle(fuzz_vrpn_payload, (const uint8_t *)"192.168.1.10 51234", 19, 2000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_bytes_are_written),
        cmocka_unit_test(golden_bytes_are_read),
        cmocka_unit_test(versions_are_told_apart),
        cmocka_unit_test(payloads_round_trip),
        cmocka_unit_test(call_backs),
        cmocka_unit_test(impossible_lengths_are_refused),
        cmocka_unit_test(names_that_do_not_fit_are_not_written),
        cmocka_unit_test(mangled_bytes_never_break_the_reader),
    };
    return cmocka_run_group_tests_name("vrpn_message", tests, NULL, NULL);
}
