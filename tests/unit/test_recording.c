/* Recordings: what is written is read back, in each form; cut and damaged files are read up to the damage. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/fuzz/recording_entry.h"
#include "tracking/big_endian.h"
#include "tracking/byte_stream.h"
#include "tracking/recording_writer.h"

#include <errno.h>
#include <math.h>
#include <unistd.h>
#include <zlib.h>

static const int64_t start_time = (int64_t)1700000000 * 1000000000;

/* Two devices, every kind of event, clocks that differ, a sensor that is lost. */
static const gw_recorded_event all_kinds[] = {
    {0, {.kind = GW_EVENT_LINK, .device_time = GW_NO_TIME, .quality = 1, .of.link = {1}}},
    {0,
     {.sensor = 0,
      .arrival = 1000,
      .device_time = (int64_t)1700000000 * 1000000000 + 1000,
      .quality = 1,
      .of.pose = {{0.25, 1.5, -2}, {0, 0.6, 0, 0.8}}}},
    {1,
     {.sensor = 3,
      .arrival = 4000123,
      .device_time = 5123456789,
      .latency = 1500000,
      .quality = 0.75,
      .of.pose = {{1.0 / 3, -1e-7, 900}, {0.5, -0.5, 0.5, -0.5}}}},
    {1,
     {.sensor = 2,
      .arrival = 4000123,
      .device_time = 5123456789,
      .quality = -1,
      .of.pose = {{0}, {0, 0, 0, 1}}}},
    {0,
     {.kind = GW_EVENT_GAZE,
      .sensor = 1,
      .arrival = 5000000,
      .device_time = -7,
      .quality = 0.5,
      .of.gaze = {GW_GAZE_IN_HEAD, 1, {0.03, 0, 0}, {0.6, 0, -0.8}, 0.25}}},
    {0,
     {.kind = GW_EVENT_GAZE,
      .arrival = 5000000,
      .device_time = GW_NO_TIME,
      .quality = -1,
      .of.gaze = {GW_GAZE_IN_DEVICE, 0, {0}, {0, 0, -1}, 0}}},
    {1,
     {.kind = GW_EVENT_BUTTON,
      .sensor = 7,
      .arrival = 6000000,
      .device_time = 1,
      .quality = 1,
      .of.button = {1}}},
    {1,
     {.kind = GW_EVENT_ANALOG,
      .sensor = 0,
      .arrival = 7000000,
      .device_time = 2,
      .quality = 1,
      .of.analog = {0.1}}},
    {1,
     {.kind = GW_EVENT_ANALOG,
      .sensor = 1,
      .arrival = 7000000,
      .device_time = 2,
      .quality = 1,
      .of.analog = {-1}}},
    {1,
     {.kind = GW_EVENT_BUTTON,
      .sensor = 7,
      .arrival = 3000000000,
      .device_time = 3,
      .quality = 1,
      .of.button = {0}}},
    {0, {.kind = GW_EVENT_LINK, .arrival = 3000000001, .device_time = GW_NO_TIME, .quality = 1}},
};
enum { ALL_KINDS = sizeof all_kinds / sizeof *all_kinds };

static void write_all(const char *path, int overwrite) {
    gw_recording_writer *writer;
    uint32_t number;
    check_ok(gw_recording_writer_open(path, GW_RECORDING_BY_NAME, start_time, overwrite, &writer, &error));
    check_ok(gw_recording_writer_sender(writer, "Glasses", &number, &error));
    check_ok(gw_recording_writer_sender(writer, "Wand, \"left\"", &number, &error));
    assert_int_equal(number, 1);
    check_ok(gw_recording_writer_note(writer, 0, "gaze: with consent", &error));
    for (int i = 0; i < ALL_KINDS; i++)
        check_ok(gw_recording_writer_event(writer, all_kinds[i].sender, &all_kinds[i].event, &error));
    check_ok(gw_recording_writer_close(&writer, &error));
}

static void assert_same_event(const gw_recorded_event *got, const gw_recorded_event *wanted) {
    const gw_tracking_event *a = &got->event, *b = &wanted->event;
    assert_int_equal(got->sender, wanted->sender);
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->sensor, b->sensor);
    assert_int_equal(a->arrival, b->arrival);
    assert_int_equal(a->device_time, b->device_time);
    assert_int_equal(a->latency, b->latency);
    assert_true(a->quality == b->quality);
    if (a->kind == GW_EVENT_POSE) {
        assert_memory_equal(a->of.pose.position, b->of.pose.position, sizeof b->of.pose.position);
        assert_memory_equal(a->of.pose.orientation, b->of.pose.orientation, sizeof b->of.pose.orientation);
    } else if (a->kind == GW_EVENT_GAZE) {
        assert_int_equal(a->of.gaze.frame, b->of.gaze.frame);
        assert_int_equal(a->of.gaze.has_origin, b->of.gaze.has_origin);
        assert_memory_equal(a->of.gaze.origin, b->of.gaze.origin, sizeof b->of.gaze.origin);
        assert_memory_equal(a->of.gaze.direction, b->of.gaze.direction, sizeof b->of.gaze.direction);
        assert_true(a->of.gaze.openness == b->of.gaze.openness);
    } else if (a->kind == GW_EVENT_ANALOG) {
        assert_true(a->of.analog.value == b->of.analog.value);
    } else {
        assert_int_equal(a->of.link.up, b->of.link.up); /* a button's first field as well */
    }
}

static void every_form_keeps_every_bit(void **state) {
    (void)state;
    static const char *const names[] = {"all.vrpn", "all.vrpn.gz", "all.csv", "all.csv.gz"};
    for (size_t form = 0; form < sizeof names / sizeof *names; form++) {
        char path[512];
        gw_recording *recording;
        write_all(scratch_path(path, names[form]), 1);
        check_ok(gw_recording_load(path, &recording, &error));
        assert_int_equal(recording->is_csv, form >= 2);
        assert_int_equal(recording->is_gzip, form % 2);
        assert_int_equal(recording->count, ALL_KINDS);
        assert_int_equal(recording->start, start_time);
        assert_int_equal(recording->sender_count, 2);
        assert_string_equal(recording->senders[1], "Wand, \"left\"");
        assert_int_equal(recording->note_count, 1);
        assert_string_equal(recording->notes[0], "gaze: with consent");
        assert_false(recording->damage.found);
        for (int i = 0; i < ALL_KINDS; i++)
            assert_same_event(&recording->events[i], &all_kinds[i]);
        gw_recording_destroy(&recording);
        unlink(path);
    }
}

/* Bytes of the file, exactly allocated, so that a sanitizer sees a read beyond them. */
static gw_bytes bytes_of(const char *name) {
    char path[512];
    gw_bytes bytes;
    write_all(scratch_path(path, name), 1);
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    unlink(path);
    return bytes;
}

static gw_recording *parse_copy(const uint8_t *data, size_t size, gw_code *code) {
    uint8_t *exact = malloc(size > 0 ? size : 1);
    gw_recording *recording = NULL;
    gw_error error = {0};
    assert_non_null(exact);
    memcpy(exact, data, size);
    fuzz_recording(exact, size);
    *code = gw_recording_parse(exact, size, "cut", &recording, &error);
    free(exact);
    return recording;
}

/* Cut anywhere, a log gives the records before the cut and says where the rest is missing. */
static void every_prefix_of_a_log_is_read_up_to_the_cut(void **state) {
    (void)state;
    gw_bytes bytes = bytes_of("prefix.vrpn");
    uint64_t borders = 0, last = 24;
    for (size_t size = 0; size <= bytes.size; size++) {
        gw_code code;
        gw_recording *recording = parse_copy(bytes.data, size, &code);
        assert_int_equal(code, size < 24 ? GW_BAD_INPUT : GW_OK);
        if (code != GW_OK)
            continue;
        for (size_t i = 0; i < recording->count; i++)
            assert_same_event(&recording->events[i], &all_kinds[i]);
        if (recording->damage.found) {
            assert_int_equal(recording->damage.offset, last);
            assert_int_equal(recording->damage.record, recording->counters.records + 1);
            assert_non_null(strstr(recording->damage.text, "cut off"));
        } else {
            last = size;
            borders++;
        }
        assert_int_equal(recording->counters.bytes, last);
        gw_recording_destroy(&recording);
    }
    assert_int_equal(last, bytes.size);
    assert_true(borders > ALL_KINDS);
    gw_bytes_finish(&bytes);
}

/* Of a gzipped log that ends early all is read that its bytes still say. */
static void every_prefix_of_a_gzipped_log_is_read(void **state) {
    (void)state;
    gw_bytes bytes = bytes_of("prefix.vrpn.gz");
    size_t most = 0;
    for (size_t size = 2; size < bytes.size; size++) {
        gw_code code;
        gw_recording *recording = parse_copy(bytes.data, size, &code);
        if (code != GW_OK)
            continue;
        assert_true(recording->damage.found);
        assert_non_null(strstr(recording->damage.text, ".gz"));
        most = recording->count > most ? recording->count : most;
        for (size_t i = 0; i < recording->count; i++)
            assert_same_event(&recording->events[i], &all_kinds[i]);
        gw_recording_destroy(&recording);
    }
    assert_int_equal(most, ALL_KINDS); /* only the checksum is missing then */
    gw_bytes_finish(&bytes);
}

static void flipped_bits_never_break_the_reader(void **state) {
    (void)state;
    static const char *const names[] = {"flip.vrpn", "flip.vrpn.gz", "flip.csv"};
    for (size_t form = 0; form < 3; form++) {
        gw_bytes bytes = bytes_of(names[form]);
        size_t read = 0, changed = 0;
        for (size_t bit = 0; bit < 8 * bytes.size; bit++) {
            bytes.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
            gw_code code;
            gw_recording *recording = parse_copy(bytes.data, bytes.size, &code);
            bytes.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
            read += code == GW_OK;
            changed += code == GW_OK && recording->count != ALL_KINDS;
            gw_recording_destroy(&recording);
        }
        assert_true(read > 0 && changed > 0);
        gw_bytes_finish(&bytes);
    }
}

static void a_bad_length_is_named_with_its_place(void **state) {
    (void)state;
    gw_bytes bytes = bytes_of("length.vrpn");
    /* Devices, the note and its type, the types of links and stamps, a stamp, the first event; one type more.
     */
    size_t at = 24, records = 0;
    while (records < 9) {
        at += 24 + (size_t)gw_get_int32(bytes.data + at + 16);
        records++;
    }
    gw_put_int32(bytes.data + at + 16, 64001);
    gw_recording *recording;
    char wanted[160], text[512];
    check_ok(gw_recording_parse(bytes.data, bytes.size, "long", &recording, &error));
    snprintf(wanted, sizeof wanted,
             "byte %zu, record %zu: a payload of 0 to 64000 bytes was expected, not of 64001", at,
             records + 1);
    gw_recording_damage_text(recording, text, sizeof text);
    assert_string_equal(text, wanted);
    assert_true(recording->count > 0 && recording->count < ALL_KINDS);
    gw_recording_destroy(&recording);
    gw_bytes_finish(&bytes);
}

/* What was flushed is there without the end of the file: a program that is killed never writes it. */
static void what_was_flushed_can_be_read(void **state) {
    (void)state;
    static const char *const names[] = {"live.vrpn", "live.vrpn.gz", "live.csv"};
    for (size_t form = 0; form < 3; form++) {
        char path[512];
        gw_recording_writer *writer;
        gw_recording *recording;
        uint32_t number;
        unlink(scratch_path(path, names[form]));
        check_ok(gw_recording_writer_open(path, GW_RECORDING_BY_NAME, start_time, 0, &writer, &error));
        check_ok(gw_recording_writer_sender(writer, "a", &number, &error));
        check_ok(gw_recording_writer_sender(writer, "b", &number, &error));
        for (int i = 0; i < 9; i++)
            check_ok(gw_recording_writer_event(writer, all_kinds[i].sender, &all_kinds[i].event, &error));
        check_ok(gw_recording_writer_flush(writer, &error));
        check_ok(gw_recording_load(path, &recording, &error));
        assert_int_equal(recording->count, 9);
        assert_int_equal(recording->damage.found, form == 1); /* a gzip stream has an end */
        gw_recording_destroy(&recording);
        check_ok(gw_recording_writer_close(&writer, &error));
        unlink(path);
    }
}

static void files_are_not_overwritten_unasked(void **state) {
    (void)state;
    char path[512];
    gw_recording_writer *writer;
    write_all(scratch_path(path, "there.vrpn"), 1);
    check_fails(gw_recording_writer_open(path, GW_RECORDING_BY_NAME, 0, 0, &writer, &error), GW_BAD_INPUT,
                "--overwrite");
    write_all(path, 1);
    unlink(path);
    check_fails(gw_recording_writer_open("/dev/null/x.vrpn", GW_RECORDING_BY_NAME, 0, 0, &writer, &error),
                GW_NO_OUTPUT, "/dev/null/x.vrpn");
    check_ok(gw_recording_writer_open("/dev/full", GW_RECORDING_BY_NAME, 0, 0, &writer, &error));
    check_fails(gw_recording_writer_flush(writer, &error), GW_NO_OUTPUT, "No space left");
    gw_recording_writer_close(&writer, NULL);
}

/* A log of anyone: no stamps; the record's time is all there is. */
static void put_foreign_pose(uint8_t *to, int64_t time, double x) {
    const int32_t fields[6] = {3,  0, (int32_t)(time / 1000000000), (int32_t)(time % 1000000000 / 1000),
                               64, 0};
    for (int i = 0; i < 6; i++)
        to = gw_put_int32(to, fields[i]);
    to = gw_put_int32(gw_put_int32(to, 0), 99);
    const double values[7] = {x, 1, 2, 0, 0, 0, 2};
    for (int i = 0; i < 7; i++)
        to = gw_put_double(to, values[i]);
}

static void times_of_a_foreign_log(void **state) {
    (void)state;
    static const struct {
        int64_t time, arrival;                             /* ms */
    } rows[] = {{5000, 0},      {5010, 10},    {5005, 10}, /* out of order: arrives with the one before */
                {5020, 20},     {1020, 20},                /* the clock was set back by 4 s */
                {1030, 30},     {9001030, 30},             /* and ahead by two and a half hours */
                {9004030, 3030}};                          /* a hole of 3 s */
    enum { ROWS = sizeof rows / sizeof *rows };
    uint8_t bytes[24 + 37 + 50 + ROWS * 88] = "vrpn: ver. 07.38  0", *to = bytes + 24;
    static const int32_t sender[7] = {-1, 0, 5, 0, 13, 0, 9}, type[7] = {-2, 3, 5, 0, 26, 0, 22};
    for (int i = 0; i < 7; i++)
        to = gw_put_int32(to, sender[i]);
    memcpy(to, "Tracker0", 9);
    to += 9;
    for (int i = 0; i < 7; i++)
        to = gw_put_int32(to, type[i]);
    memcpy(to, "vrpn_Tracker Pos_Quat", 22);
    to += 22;
    for (int i = 0; i < ROWS; i++, to += 88)
        put_foreign_pose(to, rows[i].time * 1000000, i);
    gw_recording *recording;
    check_ok(gw_recording_parse(bytes, sizeof bytes, "foreign", &recording, &error));
    assert_int_equal(recording->count, ROWS);
    assert_int_equal(recording->start, (int64_t)5000000000);
    for (int i = 0; i < ROWS; i++) {
        const gw_tracking_event *event = &recording->events[i].event;
        assert_int_equal(event->device_time, rows[i].time * 1000000);
        assert_int_equal(event->arrival, rows[i].arrival * 1000000);
        assert_true(event->quality == 1.0 && event->of.pose.orientation[3] == 1.0);
    }
    assert_int_equal(recording->counters.out_of_order, 1);
    assert_int_equal(recording->counters.clock_steps, 2);
    /* Written and read again it is the same recording, device times and all. */
    char path[512];
    gw_recording *again;
    check_ok(gw_recording_write(scratch_path(path, "again.vrpn"), GW_RECORDING_BY_NAME, recording, 0,
                                INT64_MAX, 1, &error));
    check_ok(gw_recording_load(path, &again, &error));
    assert_int_equal(again->count, ROWS);
    for (int i = 0; i < ROWS; i++)
        assert_same_event(&again->events[i], &recording->events[i]);
    assert_int_equal(again->counters.clock_steps, 0);
    gw_recording_destroy(&again);
    gw_recording_destroy(&recording);
    unlink(path);
}

/* A log whose recorder was killed between two records looks whole, but for the mark of its end. */
static void a_log_that_was_not_closed_is_told(void **state) {
    (void)state;
    char path[512], text[320];
    const size_t mark = 24; /* bytes of the last record */
    for (int marked = 0; marked < 2; marked++) {
        gw_recording_writer *writer;
        gw_recording *recording;
        uint32_t number;
        gw_bytes bytes;
        check_ok(gw_recording_writer_open(scratch_path(path, "killed.vrpn"), GW_RECORDING_BY_NAME,
                                          (int64_t)1000500000 * 1000000, 1, &writer, &error));
        check_ok(gw_recording_writer_sender(writer, "T", &number, &error));
        if (marked)
            check_ok(gw_recording_writer_mark_end(writer, &error));
        for (int i = 0; i < 9; i++) {
            const gw_tracking_event pose = {.kind = GW_EVENT_POSE,
                                            .arrival = i * (int64_t)1000000,
                                            .device_time = GW_NO_TIME,
                                            .quality = 1,
                                            .of.pose.orientation = {0, 0, 0, 1}};
            check_ok(gw_recording_writer_event(writer, number, &pose, &error));
        }
        check_ok(gw_recording_writer_close(&writer, &error));
        check_ok(gw_file_read(path, 10000, &bytes, &error));
        check_ok(gw_recording_parse(bytes.data, bytes.size, "whole", &recording, &error));
        assert_false(recording->damage.found);
        assert_int_equal(recording->count, 9);
        gw_recording_destroy(&recording);
        const size_t pose = 24 + 64 + 24 + 32; /* and its stamp */
        check_ok(gw_recording_parse(bytes.data, bytes.size - (marked ? mark : pose), "killed", &recording,
                                    &error));
        gw_recording_damage_text(recording, text, sizeof text);
        assert_int_equal(recording->count, marked ? 9 : 8);
        assert_int_equal(recording->damage.found, marked);
        assert_true(!marked || strstr(text, "the mark of its end was expected"));
        gw_recording_destroy(&recording);
        gw_bytes_finish(&bytes);
        unlink(path);
    }
}

static void our_own_records_byte_by_byte(void **state) {
    (void)state;
    char path[512];
    gw_recording_writer *writer;
    uint32_t number;
    gw_bytes bytes;
    check_ok(gw_recording_writer_open(scratch_path(path, "own.vrpn"), GW_RECORDING_BY_NAME,
                                      (int64_t)1000500000 * 1000000, 1, &writer, &error));
    check_ok(gw_recording_writer_sender(writer, "G", &number, &error));
    const gw_tracking_event gaze = {.kind = GW_EVENT_GAZE,
                                    .sensor = 2,
                                    .arrival = 1,
                                    .device_time = 3,
                                    .latency = 4,
                                    .quality = 0.5,
                                    .of.gaze = {GW_GAZE_IN_HEAD, 0, {0}, {0, 0, -1}, 1}};
    check_ok(gw_recording_writer_event(writer, number, &gaze, &error));
    check_ok(gw_recording_writer_close(&writer, &error));
    check_ok(gw_file_read(path, 4096, &bytes, &error));
    unlink(path);
    /* As docs/tracks.md has it: sender 0 is "G", type 8 a gaze, type 7 a stamp, then one of each. */
    char got[1024];
    for (size_t i = 24; i < bytes.size; i++)
        snprintf(got + 2 * (i - 24), 3, "%02x", bytes.data[i]);
    assert_string_equal(
        got,
        "ffffffff00000000000f4434000000000000000600000000000000024700fffffffe00000008000f4434000000000000"
        "0012000000000000000e67617a6577616c6c2047617a6500fffffffe00000007000f4434000000000000001300000000"
        "0000000f67617a6577616c6c205374616d70000000000700000000000f443400000000000000200000000000038df30f"
        "190801000000000000000300000000000000043fe00000000000000000000800000000000f4434000000000000004000"
        "000000000000020000000100000000000000000000000000000000000000000000000000000000000000000000000000"
        "000000bff00000000000003ff0000000000000");
    gw_bytes_finish(&bytes);
}

/* The expanded bytes count, and no more than a window of them is ever held. */
static void bombs_are_bounded(void **state) {
    (void)state;
    enum { SIZE = 1 << 20, LIMIT = SIZE - 1000 };
    uint8_t *zeros = calloc(1, SIZE), packed[4096];
    assert_non_null(zeros);
    z_stream stream = {.next_in = zeros, .avail_in = SIZE, .next_out = packed, .avail_out = sizeof packed};
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 9, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    gw_byte_stream *bytes;
    const uint8_t *at;
    check_ok(gw_byte_stream_of(packed, stream.total_out, LIMIT, &bytes, &error));
    size_t read = 0, there;
    while ((there = gw_byte_stream_peek(bytes, 60000, &at)) > 0) {
        gw_byte_stream_take(bytes, there);
        read += there;
    }
    assert_int_equal(read, LIMIT);
    assert_non_null(strstr(gw_byte_stream_problem(bytes), "more than 1047576 bytes"));
    gw_byte_stream_close(&bytes);
    free(zeros);
}

static void csv_errors_name_the_line(void **state) {
    (void)state;
    static const char head[] = "arrival_s,sensor,x,y,z,qx,qy,qz,qw\n";
    static const struct {
        const char *row, *part;
    } rows[] = {
        {"0,0,1,2,3,0,0,0\n", "t.csv:3: column qw: '' is not a number"},
        {"0,0,1,2,3,0,0,0,nan\n", "t.csv:3: column qw: 'nan' is not a number"},
        {"0,0,0x1,2,3,0,0,0,1\n", "t.csv:3: column x: '0x1'"},
        {"0,0,1.5.5,2,3,0,0,0,1\n", "t.csv:3: column x: '1.5.5'"},
        {"0,0,1e999,2,3,0,0,0,1\n", "t.csv:3: not a place"},
        {"0,0,1,2,3,0,0,0,0\n", "t.csv:3: not a place"},
        {"0,-1,1,2,3,0,0,0,1\n", "t.csv:3: column sensor: '-1'"},
        {"1e3,0,1,2,3,0,0,0,1\n", "t.csv:3: column arrival_s: '1e3' is not a time"},
        {"99999999999,0,1,2,3,0,0,0,1\n", "t.csv:3: column arrival_s"},
        {"0,0,1,2,3,0,0,0,1,5\n", "t.csv:3: more than 9 columns"},
        {"0,0,\"1,2,3,0,0,0,1,5\n", "t.csv:3: a quote is not closed"},
    };
    gw_recording *recording;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s0.5,0,1,2,3,0,0,0,1\r\n%s0.6,0,1,2,3,0,0,0,1\n", head, rows[i].row);
        check_fails(gw_recording_parse(text, strlen(text), "t.csv", &recording, &error), GW_BAD_INPUT,
                    rows[i].part);
    }
    static const struct {
        const char *text, *part;
    } heads[] = {{"arrival_s,sensr\n", "did you mean 'sensor'?"},
                 {"sensor\n", "t.csv:1: there is no column arrival_s"},
                 {"arrival_s,x,x\n", "column x is there twice"},
                 {"Once upon a time\n", "t.csv:1: neither a VRPN log nor CSV with known columns"},
                 {"# only a note\n\n", "there is no line of columns"},
                 {"arrival_s,kind\n0,pos\n", "t.csv:2: column kind: 'pos'"},
                 {"arrival_s,kind,value\n0,button,2\n", "'2' is not 0 or 1"},
                 {"arrival_s,kind,frame\n0,gaze,wall\n", "'wall' is not device or head"},
                 {"arrival_s,kind,quality\n0,pose,7\n", "a quality -1 to 1"}};
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        check_fails(gw_recording_parse(heads[i].text, strlen(heads[i].text), "t.csv", &recording, &error),
                    GW_BAD_INPUT, heads[i].part);
}

/* Columns in any order, most of them left out, as a spreadsheet would have it; the last line is cut. */
static void csv_of_others_is_read(void **state) {
    (void)state;
    static const char text[] = "# made by hand\n\nqw,qz,qy,qx,z,y,x,arrival_s\n"
                               "2,0,0,0,3,2,1,12.0000000019\n1,0,0,0,3,2,1,12.5\n1,0,0,0,3,2";
    gw_recording *recording;
    char damage[512];
    check_ok(gw_recording_parse(text, sizeof text - 1, "t.csv", &recording, &error));
    assert_int_equal(recording->count, 2);
    assert_int_equal(recording->start, (int64_t)12000000001);
    assert_int_equal(recording->duration, 499999999);
    assert_string_equal(recording->senders[0], "Tracker0");
    assert_string_equal(recording->notes[0], "made by hand");
    const gw_tracking_event *event = &recording->events[0].event;
    assert_true(event->device_time == GW_NO_TIME && event->quality == 1.0);
    assert_true(event->of.pose.position[0] == 1 && event->of.pose.orientation[3] == 1);
    gw_recording_damage_text(recording, damage, sizeof damage);
    assert_non_null(strstr(damage, "line 6: a whole line was expected"));
    gw_recording_destroy(&recording);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_keeps_every_bit),
        cmocka_unit_test(every_prefix_of_a_log_is_read_up_to_the_cut),
        cmocka_unit_test(every_prefix_of_a_gzipped_log_is_read),
        cmocka_unit_test(flipped_bits_never_break_the_reader),
        cmocka_unit_test(a_bad_length_is_named_with_its_place),
        cmocka_unit_test(what_was_flushed_can_be_read),
        cmocka_unit_test(files_are_not_overwritten_unasked),
        cmocka_unit_test(times_of_a_foreign_log),
        cmocka_unit_test(a_log_that_was_not_closed_is_told),
        cmocka_unit_test(our_own_records_byte_by_byte),
        cmocka_unit_test(bombs_are_bounded),
        cmocka_unit_test(csv_errors_name_the_line),
        cmocka_unit_test(csv_of_others_is_read),
    };
    return cmocka_run_group_tests_name("recording", tests, NULL, NULL);
}
