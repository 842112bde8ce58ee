/* The gaze datagram: the golden vectors of docs/gaze-datagram.md, byte for byte and both ways. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/fuzz/gaze_datagram_entry.h"
#include "tests/support/hex.h"
#include "tests/support/mangle.h"

static const gw_tracking_event golden[] = {
    {.kind = GW_EVENT_GAZE,
     .sensor = 1,
     .device_time = INT64_C(1700000000500000000),
     .latency = 4000000,
     .quality = 0.75,
     .of.gaze = {.frame = GW_GAZE_IN_DEVICE,
                 .has_origin = 1,
                 .origin = {0.25, 1.5, 2.0},
                 .direction = {0, 0, -1},
                 .openness = 0.5}},
    {.kind = GW_EVENT_GAZE,
     .device_time = GW_NO_TIME,
     .quality = -1,
     .of.gaze = {.frame = GW_GAZE_IN_HEAD, .direction = {0, 0, -1}, .openness = 0}}};
static const gw_gaze_extra golden_extra[] = {{.sequence = 258, .pupil = 3.5}, {.sequence = UINT32_MAX}};
static const char *const golden_hex[] = {
    "4757475a 013e0040 00000102 00010000 17979cfe 53f76500 00000fa0 3f400000 3e800000 3fc00000 40000000 "
    "00000000 00000000 bf800000 3f000000 40600000",
    "4757475a 01090040 ffffffff 00000000 00000000 00000000 00000000 00000000 00000000 00000000 00000000 "
    "00000000 00000000 00000000 00000000 00000000"};

static void golden_bytes_are_written(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        uint8_t data[GW_GAZE_DATAGRAM], wanted[GW_GAZE_DATAGRAM];
        assert_int_equal(hex_bytes(golden_hex[i], wanted, sizeof wanted), GW_GAZE_DATAGRAM);
        gw_gaze_datagram_write(&golden[i], &golden_extra[i], 1, data);
        assert_memory_equal(data, wanted, sizeof wanted);
    }
}

static void golden_bytes_are_read(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        uint8_t data[GW_GAZE_DATAGRAM];
        gw_tracking_event event;
        gw_gaze_extra extra;
        hex_bytes(golden_hex[i], data, sizeof data);
        assert_int_equal(gw_gaze_datagram_read(data, sizeof data, &event, &extra), GW_GAZE_READ);
        assert_true(event.kind == golden[i].kind && event.sensor == golden[i].sensor);
        assert_true(event.device_time == golden[i].device_time && event.latency == golden[i].latency);
        assert_true(event.quality == golden[i].quality);
        assert_memory_equal(event.of.gaze.origin, golden[i].of.gaze.origin, sizeof event.of.gaze.origin);
        assert_memory_equal(event.of.gaze.direction, golden[i].of.gaze.direction,
                            sizeof event.of.gaze.direction);
        assert_true(event.of.gaze.openness == golden[i].of.gaze.openness);
        assert_int_equal(event.of.gaze.frame, golden[i].of.gaze.frame);
        assert_true(extra.sequence == golden_extra[i].sequence && extra.pupil == golden_extra[i].pupil);
    }
}

/* The page shows the same bytes. */
static void the_page_shows_them(void **state) {
    (void)state;
    gw_bytes page;
    check_ok(gw_file_read("docs/gaze-datagram.md", 1 << 20, &page, &error));
    const char *at = (const char *)page.data;
    for (int i = 0; i < 2; i++) {
        uint8_t wanted[GW_GAZE_DATAGRAM], shown[GW_GAZE_DATAGRAM];
        hex_bytes(golden_hex[i], wanted, sizeof wanted);
        at = strstr(at, "```\n4757475a");
        assert_non_null(at);
        at += 4;
        assert_int_equal(hex_bytes(at, shown, sizeof shown), sizeof shown);
        assert_memory_equal(shown, wanted, sizeof wanted);
    }
    gw_bytes_finish(&page);
}

static gw_gaze_reading read_with(size_t at, uint8_t value, size_t size) {
    uint8_t data[GW_GAZE_DATAGRAM + 64] = {0};
    gw_tracking_event event;
    gw_gaze_extra extra;
    hex_bytes(golden_hex[0], data, GW_GAZE_DATAGRAM);
    data[at] = value;
    return gw_gaze_datagram_read(data, size, &event, &extra);
}

static void what_is_wrong_is_told_apart(void **state) {
    (void)state;
    assert_int_equal(read_with(0, 'G', 64), GW_GAZE_READ);
    assert_int_equal(read_with(0, 'X', 64), GW_GAZE_MALFORMED);
    assert_int_equal(read_with(4, 2, 64), GW_GAZE_VERSION);
    assert_int_equal(read_with(0, 'G', 63), GW_GAZE_MALFORMED);    /* cut */
    assert_int_equal(read_with(7, 63, 63), GW_GAZE_MALFORMED);     /* too short for this version */
    assert_int_equal(read_with(7, 80, 80), GW_GAZE_READ);          /* with fields of a later revision */
    assert_int_equal(read_with(28, 0x40, 64), GW_GAZE_NOT_FINITE); /* a confidence of 3 */
    assert_int_equal(read_with(28, 0xbf, 64), GW_GAZE_NOT_FINITE); /* below 0 */
    assert_int_equal(read_with(32, 0x7f, 64), GW_GAZE_NOT_FINITE); /* an origin beyond any room */
    assert_int_equal(read_with(52, 0, 64), GW_GAZE_NOT_FINITE);    /* a direction of no length */
    assert_int_equal(read_with(56, 0x7f, 64), GW_GAZE_NOT_FINITE);
    assert_int_equal(read_with(60, 0xc0, 64), GW_GAZE_NOT_FINITE); /* a pupil below 0 */
    assert_int_equal(read_with(16, 0x97, 64), GW_GAZE_NOT_FINITE); /* before 1970 */
}

static void mangled_datagrams_never_break_the_reader(void **state) {
    (void)state;
    uint8_t data[GW_GAZE_DATAGRAM];
    for (int i = 0; i < 2; i++) {
        hex_bytes(golden_hex[i], data, sizeof data);
        mangle(fuzz_gaze_datagram, data, sizeof data, 5000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_bytes_are_written),
        cmocka_unit_test(golden_bytes_are_read),
        cmocka_unit_test(the_page_shows_them),
        cmocka_unit_test(what_is_wrong_is_told_apart),
        cmocka_unit_test(mangled_datagrams_never_break_the_reader),
    };
    return cmocka_run_group_tests_name("gaze_datagram", tests, NULL, NULL);
}
