/* VRPN logs of others: the wire's golden bytes, and files that lie about everything. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/fuzz/recording_entry.h"
#include "tracking/big_endian.h"
#include "tracking/recording_writer.h"
#include "tracking/track.h"

#include <math.h>
#include <unistd.h>

/* A log being put together by hand. */
typedef struct log_bytes {
    uint8_t data[8192];
    size_t size;
} log_bytes;

static void put_hex(log_bytes *log, const char *hex) {
    for (; *hex != '\0'; hex++) {
        unsigned value;
        if (*hex == ' ')
            continue;
        assert_int_equal(sscanf(hex, "%2x", &value), 1);
        log->data[log->size++] = (uint8_t)value;
        hex++;
    }
}

static void put_header(log_bytes *log, int32_t type, int32_t sender, int32_t seconds, int32_t microseconds,
                       int32_t length) {
    const int32_t fields[6] = {type, sender, seconds, microseconds, length, 0};
    for (int i = 0; i < 6; i++) {
        gw_put_int32(log->data + log->size, fields[i]);
        log->size += 4;
    }
}

static void put_name(log_bytes *log, int32_t kind, int32_t id, const char *name) {
    int32_t length = (int32_t)strlen(name) + 1;
    put_header(log, kind, id, 1000, 500000, 4 + length);
    gw_put_int32(log->data + log->size, length);
    memcpy(log->data + log->size + 4, name, (size_t)length);
    log->size += 4 + (size_t)length;
}

static void put_pose(log_bytes *log, int32_t type, int32_t sender, int32_t microseconds, int32_t sensor,
                     const double values[7]) {
    put_header(log, type, sender, 1000, microseconds, 64);
    uint8_t *to = gw_put_int32(gw_put_int32(log->data + log->size, sensor), -1);
    for (int i = 0; i < 7; i++)
        to = gw_put_double(to, values[i]);
    log->size += 64;
}

static void begin(log_bytes *log) {
    log->size = 0;
    put_hex(log, "7672706e 3a207665 722e2030 372e3338 20203000 00000000");
}

/* A log whose device "Tracker0" (id 0) may send poses (type 3). */
static void begin_described(log_bytes *log) {
    begin(log);
    put_name(log, -1, 0, "Tracker0");
    put_name(log, -2, 3, "vrpn_Tracker Pos_Quat");
}

static const double plain_pose[7] = {0.25, 1.5, -2.0, 0.0, 0.0, 0.0, 1.0};

static gw_code parse(const log_bytes *log, gw_recording **out, gw_error *error) {
    return gw_recording_parse(log->data, log->size, "test.vrpn", out, error);
}

/* The payloads of the protocol's golden messages, as the reference implementation sent them, in a log's
 * records. */
static void golden_bytes_are_understood(void **state) {
    (void)state;
    log_bytes log;
    begin(&log);
    put_header(&log, -1, 0, 1000, 500000, 13);
    put_hex(&log, "00000009 54726163 6b657230 00");
    put_header(&log, -2, 3, 1000, 500000, 26);
    put_hex(&log, "00000016 7672706e 5f547261 636b6572 20506f73 5f517561 7400");
    put_header(&log, 3, 0, 1000, 500000, 64);
    put_hex(&log, "00000000 00000000 3fd00000 00000000 3ff80000 00000000 c0000000 00000000 00000000 00000000"
                  "3fe6a09e 667f3bcd 00000000 00000000 3fe6a09e 667f3bcd");
    gw_recording *track;
    check_ok(parse(&log, &track, &error));
    assert_int_equal(track->count, 1);
    assert_string_equal(track->senders[0], "Tracker0");
    const gw_tracking_event *event = &track->events[0].event;
    const double *at = event->of.pose.position, *turn = event->of.pose.orientation;
    assert_int_equal(event->sensor, 0);
    assert_int_equal(track->start, (int64_t)1000500 * 1000000);
    assert_true(at[0] == 0.25 && at[1] == 1.5 && at[2] == -2.0);
    assert_true(turn[0] == 0.0 && turn[2] == 0.0);
    assert_true(fabs(turn[1] - sqrt(0.5)) < 1e-15);
    assert_true(fabs(turn[3] - sqrt(0.5)) < 1e-15);
    assert_int_equal(track->counters.records, 3);
    assert_int_equal(track->counters.descriptions, 2);
    assert_int_equal(track->counters.poses, 1);
    gw_recording_destroy(&track);
    assert_null(track);
}

/* The writer gives each type the id that it has in gw_log_type; a plain pose has no stamp. */
static void written_bytes_are_the_golden_ones(void **state) {
    (void)state;
    const int64_t start = (int64_t)1000500 * 1000000;
    const gw_tracking_event event = {.device_time = start,
                                     .quality = 1.0,
                                     .of.pose = {{0.25, 1.5, -2.0}, {0.0, sqrt(0.5), 0.0, sqrt(0.5)}}};
    char path[512];
    gw_recording_writer *writer;
    uint32_t sender;
    check_ok(gw_recording_writer_open(scratch_path(path, "golden.vrpn"), GW_RECORDING_BY_NAME, start, 1,
                                      &writer, &error));
    check_ok(gw_recording_writer_sender(writer, "Tracker0", &sender, &error));
    check_ok(gw_recording_writer_event(writer, sender, &event, &error));
    check_ok(gw_recording_writer_close(&writer, &error));
    gw_bytes bytes;
    check_ok(gw_file_read(path, 4096, &bytes, &error));
    unlink(path);

    log_bytes wanted;
    begin(&wanted);
    put_hex(&wanted, "ffffffff 00000000 000003e8 0007a120 0000000d 00000000 00000009 54726163 6b657230 00");
    put_hex(&wanted,
            "fffffffe 00000002 000003e8 0007a120 0000001a 00000000 00000016 7672706e 5f547261 636b6572"
            "20506f73 5f517561 7400");
    put_hex(&wanted,
            "00000002 00000000 000003e8 0007a120 00000040 00000000 00000000 00000000 3fd00000 00000000"
            "3ff80000 00000000 c0000000 00000000 00000000 00000000 3fe6a09e 667f3bcd 00000000 00000000"
            "3fe6a09e 667f3bcd");
    assert_int_equal(bytes.size, wanted.size);
    assert_memory_equal(bytes.data, wanted.data, wanted.size);
    gw_bytes_finish(&bytes);
}

static void times_that_do_not_fit_are_refused(void **state) {
    (void)state;
    char path[512];
    static const int64_t starts[] = {-1, ((int64_t)INT32_MAX + 1) * 1000000000};
    for (int i = 0; i < 2; i++) {
        const gw_tracking_event event = {.quality = 1.0, .of.pose = {{0}, {0, 0, 0, 1}}};
        gw_recording_writer *writer;
        check_ok(gw_recording_writer_open(scratch_path(path, "times.vrpn"), GW_RECORDING_BY_NAME, starts[i],
                                          1, &writer, &error));
        check_fails(gw_recording_writer_event(writer, 0, &event, &error), GW_BAD_INPUT,
                    "seconds 0 to 2147483647");
        check_ok(gw_recording_writer_close(&writer, &error));
        unlink(path);
    }
}

static void versions_four_to_seven_are_read(void **state) {
    (void)state;
    static const struct {
        const char *version;
        int read;
    } rows[] = {{"07.38", 1}, {"04.00", 1}, {"05.99", 1}, {"07.00", 1}, {"03.38", 0},
                {"08.00", 0}, {"17.38", 0}, {"00.00", 0}, {"7.38 ", 0}, {"xx.38", 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        log_bytes log;
        begin_described(&log);
        put_pose(&log, 3, 0, 0, 0, plain_pose);
        memcpy(log.data + 11, rows[i].version, 5);
        gw_recording *track = NULL;
        if (rows[i].read)
            check_ok(parse(&log, &track, &error));
        else
            check_fails(parse(&log, &track, &error), GW_BAD_INPUT, "test.vrpn: byte 0: not a VRPN log");
        assert_int_equal(track != NULL, rows[i].read);
        gw_recording_destroy(&track);
    }
}

static void hostile_lengths_are_damage(void **state) {
    (void)state;
    static const int32_t lengths[] = {-1, INT32_MIN, INT32_MAX, 64001, 65};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        log_bytes log;
        begin_described(&log);
        put_pose(&log, 3, 0, 0, 0, plain_pose);
        size_t at = log.size;
        put_pose(&log, 3, 0, 0, 0, plain_pose);
        gw_put_int32(log.data + at + 16, lengths[i]);
        gw_recording *track;
        check_ok(parse(&log, &track, &error));
        assert_int_equal(track->count, 1);
        assert_int_equal(track->damage.record, 4);
        assert_int_equal(track->damage.offset, at);
        assert_non_null(strstr(track->damage.text, "a payload of "));
        gw_recording_destroy(&track);
    }
}

/* Every reason to skip a record has its counter, and the counters add up. */
static void what_is_skipped_is_counted(void **state) {
    (void)state;
    log_bytes log;
    begin_described(&log);
    put_name(&log, -1, 5, "Wand");
    put_name(&log, -2, 7, "vrpn_Button Change");
    put_header(&log, -4, 0, 1000, 0, 0);
    put_header(&log, -5, 0, 1000, 0, 0);
    put_header(&log, -6, 0, 1000, 0, 0);        /* unknown_type */
    put_header(&log, 9, 0, 1000, 0, 0);         /* unknown_type: not described */
    put_header(&log, INT32_MAX, 0, 1000, 0, 0); /* unknown_type */
    put_name(&log, -2, 8, "vrpn_Tracker Velocity");
    put_header(&log, 8, 0, 1000, 0, 0);     /* other_type */
    put_header(&log, 7, 0, 1000, 0, 0);     /* bad_payload: no button */
    put_header(&log, 3, 0, 1000, 0, 0);     /* bad_payload: no 64 bytes */
    put_header(&log, -1, 2000, 1000, 0, 0); /* bad_payload: id out of range */
    put_header(&log, -1, -1, 1000, 0, 0);   /* bad_payload */
    put_header(&log, -2, 1, 1000, 0, 6);    /* bad_payload: length 1000 of 2 */
    put_hex(&log, "000003e8 4100");
    put_header(&log, -2, 1, 1000, 0, 6); /* bad_payload: no closing zero */
    put_hex(&log, "00000002 4142");
    put_header(&log, -2, 1, 1000, 0, 7); /* bad_payload: a zero inside */
    put_hex(&log, "00000003 410000");
    put_pose(&log, 3, 0, 10, 0, plain_pose); /* used */
    put_pose(&log, 3, 5, 20, 0, plain_pose); /* other_sender */
    put_pose(&log, 3, 6, 20, 0, plain_pose); /* unknown_sender */
    put_pose(&log, 3, INT32_MIN, 20, 0, plain_pose);
    put_pose(&log, 3, 0, 30, 8, plain_pose);  /* beyond the viewers */
    put_pose(&log, 3, 0, 30, -1, plain_pose); /* bad_sensor */
    const double bad[5][7] = {{NAN, 0, 0, 0, 0, 0, 1},
                              {INFINITY, 0, 0, 0, 0, 0, 1},
                              {0, 0, 0, 0, 0, 0, 0},
                              {0, 0, 0, 0, NAN, 0, 1},
                              {1e300, 0, 0, 0, 0, 0, 1}};
    for (int i = 0; i < 5; i++)
        put_pose(&log, 3, 0, 40, 0, bad[i]);
    put_pose(&log, 3, 0, 35, 1, plain_pose); /* used */
    put_pose(&log, 3, 0, 5, 1, plain_pose);  /* reordered */
    gw_recording *track;
    check_ok(parse(&log, &track, &error));
    const gw_recording_counters *c = &track->counters;
    assert_int_equal(c->poses, 5);
    assert_int_equal(c->used, 5);
    assert_int_equal(c->descriptions, 7);
    assert_int_equal(c->unknown_type, 3);
    assert_int_equal(c->other_type, 1);
    assert_int_equal(c->bad_payload, 7);
    assert_int_equal(c->unknown_sender, 2);
    assert_int_equal(c->bad_sensor, 1);
    assert_int_equal(c->not_finite, 5);
    assert_int_equal(c->out_of_order, 1);
    assert_int_equal(c->records, c->used + c->descriptions + c->unknown_type + c->other_type +
                                     c->bad_payload + c->unknown_sender + c->bad_sensor + c->not_finite);
    gw_recording_destroy(&track);
}

static void ids_belong_to_their_log(void **state) {
    (void)state;
    log_bytes log;
    begin(&log);
    put_name(&log, -1, 1999, "Far");
    put_name(&log, -1, 0, "Near");
    put_name(&log, -2, 1999, "vrpn_Tracker Pos_Quat");
    put_pose(&log, 1999, 1999, 0, 0, plain_pose);
    put_pose(&log, 1999, 0, 10, 0, plain_pose);
    put_pose(&log, 1999, 0, 20, 1, plain_pose);
    gw_recording *track;
    check_ok(parse(&log, &track, &error));
    assert_int_equal(track->count, 3);
    static const char *const wanted[] = {"Far", "Near", "Near"};
    for (int i = 0; i < 3; i++)
        assert_string_equal(track->senders[track->events[i].sender], wanted[i]);
    gw_recording_destroy(&track);
}

static void a_log_without_poses_has_no_viewer(void **state) {
    (void)state;
    log_bytes log;
    begin_described(&log);
    gw_recording *track;
    uint32_t sender;
    check_ok(parse(&log, &track, &error));
    check_fails(gw_track_sender(track, &sender, &error), GW_BAD_INPUT, "no usable pose of a head");
    gw_recording_destroy(&track);
    check_fails(gw_recording_load("/nonexistent.vrpn", &track, &error), GW_BAD_INPUT, "/nonexistent.vrpn");
}

/* The entry of the fuzzer on 20,000 mutations of a good log. */
static void mutated_logs_never_break_the_reader(void **state) {
    (void)state;
    log_bytes log;
    begin_described(&log);
    for (int i = 0; i < 6; i++)
        put_pose(&log, 3, 0, i * 10000, i % 2, plain_pose);
    uint64_t random = 20240611;
    const char *given = getenv("GW_TEST_SEED");
    if (given != NULL)
        random = strtoull(given, NULL, 10);
    print_message("# seed %llu (GW_TEST_SEED)\n", (unsigned long long)random);
    for (int round = 0; round < 20000; round++) {
        uint8_t bytes[sizeof log.data];
        memcpy(bytes, log.data, log.size);
        size_t size = log.size;
        for (int change = 0; change < 1 + round % 6; change++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            uint64_t value = random >> 24;
            size_t at = (size_t)(value >> 8) % log.size;
            switch (value % 4) {
            case 0:
                bytes[at] = (uint8_t)(value >> 32);
                break;
            case 1:
                bytes[at] ^= (uint8_t)(1u << (value >> 5) % 8);
                break;
            case 2:
                gw_put_int32(bytes + (at & ~(size_t)3), (value & 16) != 0 ? INT32_MAX : -1);
                break;
            default:
                size = size > at && (value & 48) == 0 ? at : size;
                break;
            }
        }
        uint8_t *exact = malloc(size > 0 ? size : 1);
        assert_non_null(exact);
        memcpy(exact, bytes, size);
        fuzz_recording(exact, size);
        free(exact);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_bytes_are_understood),
        cmocka_unit_test(written_bytes_are_the_golden_ones),
        cmocka_unit_test(times_that_do_not_fit_are_refused),
        cmocka_unit_test(versions_four_to_seven_are_read),
        cmocka_unit_test(hostile_lengths_are_damage),
        cmocka_unit_test(what_is_skipped_is_counted),
        cmocka_unit_test(ids_belong_to_their_log),
        cmocka_unit_test(a_log_without_poses_has_no_viewer),
        cmocka_unit_test(mutated_logs_never_break_the_reader),
    };
    return cmocka_run_group_tests_name("vrpn_log", tests, NULL, NULL);
}
