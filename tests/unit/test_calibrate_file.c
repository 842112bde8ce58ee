/* Files of marks and of gazes: wrong ones with message and line, what is understood, positions from a
 * recording, hostile ones. */
#include "tests/support/check.h"

#include "tests/fuzz/calibrate_entry.h"
#include "wall/calibrate_collect.h"

#include <math.h>

static gw_marks marks;

#define HEAD "version: 1\npoints:\n"
#define MARK "  - {name: a, wall: [0, 0, 1500], device: [1, 2, 3]}\n"
#define GAZES "version: 1\ngazes:\n"

typedef struct mistake {
    const char *text;
    int line;
    const char *message;
} mistake;

static const mistake wrong_marks[] = {
    {"", 1, "there is nothing in it"},
    {"- a\n", 1, "expected a map"},
    {"points: []\n", 1, "key 'version' is missing here; it is 1"},
    {"version: 2\npoints: []\n", 1, "key 'version': 2 is outside 1 to 1"},
    {"version: 1\n", 1, "key 'points' is missing here"},
    {"version: 1\npoints: 7\n", 2, "key 'points': expected a list"},
    {"version: 1\nmarks: []\n", 2, "key 'marks' is unknown"},
    {"version: 1\nsensor: -1\npoints: []\n", 2, "key 'sensor': -1 is outside 0 to 999"},
    {"version: 1\nsource: [a]\npoints: []\n", 2, "key 'source': expected"},
    {HEAD "  - a\n", 3, "key 'points': expected a map"},
    {HEAD "  - {name: a, device: [1, 2, 3]}\n", 3, "key 'wall' is missing here"},
    {HEAD "  - {name: a, wall: [0, 0], device: [1, 2, 3]}\n", 3, "key 'wall': expected 3 numbers, found 2"},
    {HEAD "  - {name: a, wall: [0, 0, 1.5m]}\n", 3, "key 'wall': item 3: expected a number, found '1.5m'"},
    {HEAD "  - {name: a, wall: [0, 2e6, 0]}\n", 3, "key 'wall': 2e+06 is beyond any room"},
    {HEAD "  - {name: a, wall: [0, 0, 0], device: [1, nan, 3]}\n", 3,
     "key 'device': item 2: expected a number"},
    {HEAD MARK "  - {name: a, wall: [1, 2, 3]}\n", 4, "key 'name': 'a' is a mark already"},
    {HEAD "  - {name: '', wall: [1, 2, 3]}\n", 3, "key 'name': expected 1 to 31 plain characters"},
    {HEAD "  - {name: a, wall: [0, 0, 0], device: [1, 2, 3], time: [0, 1]}\n", 3,
     "key 'time': the mark has a 'device', too; keep one"},
    {HEAD "  - {name: a, wall: [0, 0, 0], time: [2, 1]}\n", 3,
     "key 'time': 2 to 1 s; expected when the sensor"},
    {HEAD "  - {name: a, wal: [0, 0, 0]}\n", 3, "key 'wal' is unknown; did you mean 'wall'?"},
};

static const mistake wrong_gazes[] = {
    {"version: 1\n", 1, "key 'gazes' is missing here"},
    {GAZES "  - {viewer: 0, target: [0, 0, 0], eye: [0, 0, 9]}\n", 3, "key 'viewer': 0 is outside 1 to 4"},
    {GAZES "  - {target: [0, 0, 0], directions: []}\n", 3, "key 'eye' is missing here"},
    {GAZES "  - {target: [0, 0, 0], eye: [0, 0, 9]}\n", 3, "key 'directions' is missing here"},
    {GAZES "  - {target: [0, 0, 0], eye: [0, 0, 9], directions: [[0, 0, -1],\n     [0, 0]]}\n", 4,
     "key 'directions': expected 3 numbers, found 2"},
};

static void refuse(const mistake *wrong, gw_code code, const gw_error *error) {
    char start[32];
    snprintf(start, sizeof start, "marks.yaml:%d: ", wrong->line);
    if (code != GW_BAD_INPUT || strncmp(error->text, start, strlen(start)) != 0 ||
        !strstr(error->text, wrong->message))
        fail_msg("code %d, \"%s\", expected \"%s%s\" for\n%s", (int)code, error->text, start, wrong->message,
                 wrong->text);
}

static void wrong_files_are_refused_with_their_line(void **state) {
    gw_gazes gazes;
    (void)state;
    for (size_t i = 0; i < sizeof wrong_marks / sizeof *wrong_marks; i++) {
        gw_error error = {0};
        const char *text = wrong_marks[i].text;
        refuse(&wrong_marks[i], gw_marks_parse(text, strlen(text), "marks.yaml", &marks, &error), &error);
    }
    for (size_t i = 0; i < sizeof wrong_gazes / sizeof *wrong_gazes; i++) {
        gw_error error = {0};
        const char *text = wrong_gazes[i].text;
        refuse(&wrong_gazes[i], gw_gazes_parse(text, strlen(text), "marks.yaml", &gazes, &error), &error);
    }
    char many[8192] = HEAD;
    for (int i = 0; i <= GW_CALIBRATION_POINTS; i++)
        strcat(many, "  - {wall: [0, 0, 1], device: [1, 2, 3]}\n");
    check_fails(gw_marks_parse(many, strlen(many), "m", &marks, &error), GW_BAD_INPUT,
                "key 'points': 65 of them; at most 64");
}

static const char good[] = "version: 1\nsource: 'A@h'\nsensor: 3\npoints:\n"
                           "  - {wall: [0, 0, 1500], time: [0.5, 1.5]}\n" MARK;

static void marks_are_understood(void **state) {
    (void)state;
    check_ok(gw_marks_parse(good, strlen(good), "m", &marks, &error));
    assert_int_equal(marks.count, 2);
    assert_int_equal(marks.sensor, 3);
    assert_string_equal(marks.source, "A@h");
    assert_string_equal(marks.points[0].name, "1");
    assert_string_equal(marks.points[1].name, "a");
    assert_true(!marks.known[0] && marks.timed[0] && marks.times[0][1] == 1.5);
    assert_true(marks.known[1] && marks.points[1].device[2] == 3);
}

/* Of a recording counts the sensor, its time, and what was tracked. */
static void positions_come_from_a_recording(void **state) {
    gw_recorded_event events[6];
    gw_recording recording = {.name = "walk.vrpn", .count = 6, .events = events, .duration = 3000000000};
    (void)state;
    memset(events, 0, sizeof events);
    static const struct {
        double at, x, quality;
        int32_t sensor;
    } poses[6] = {{0.4, 9, 1, 3},  {0.6, 1, 1, 3}, {1, 50, -1, 3},
                  {1.1, 70, 1, 0}, {1.4, 3, 1, 3}, {1.6, 9, 1, 3}};
    for (int i = 0; i < 6; i++) {
        gw_tracking_event *event = &events[i].event;
        event->kind = GW_EVENT_POSE;
        event->sensor = poses[i].sensor;
        event->arrival = (int64_t)(poses[i].at * 1e9);
        event->quality = poses[i].quality;
        event->of.pose.position[0] = poses[i].x;
    }
    check_ok(gw_marks_parse(good, strlen(good), "m", &marks, &error));
    check_ok(gw_marks_take_recording(&marks, &recording, &error));
    assert_true(marks.known[0] && marks.points[0].device[0] == 2);
    assert_int_equal(marks.samples[0].count, 2);
    assert_true(marks.samples[0].spread == 1);
    check_ok(gw_marks_parse(good, strlen(good), "m", &marks, &error));
    marks.times[0][0] = 2;
    marks.times[0][1] = 2.5;
    check_fails(
        gw_marks_take_recording(&marks, &recording, &error), GW_BAD_INPUT,
        "mark '1': walk.vrpn has no position of sensor 3 from 2 to 2.5 s; it has sensors 0 3 in 3.000 s");
    marks.timed[0] = 0;
    check_fails(gw_marks_take_recording(&marks, &recording, &error), GW_BAD_INPUT,
                "mark '1' has neither a 'device' position nor a 'time'");
}

static void gazes_are_understood(void **state) {
    static const char text[] =
        GAZES "  - {target: [0, 0, 0], eye: [0, 0, 900], directions: [[0, 0, -1], [0, 0, -2]]}\n"
              "  - {viewer: 3, target: [0, 0, 0], eye: [0, 0, 900], directions: [[0, 0, 1]]}\n";
    gw_gazes gazes;
    gw_gaze_check check;
    (void)state;
    check_ok(gw_gazes_parse(text, strlen(text), "g", &gazes, &error));
    assert_true(gazes.count[0] == 2 && gazes.count[1] == 0 && gazes.count[2] == 1 && gazes.targets[2] == 1);
    assert_int_equal(gw_gaze_check_of(gazes.samples[0], 2, &check), 1);
    assert_true(check.most == 0);
    assert_int_equal(gw_gaze_check_of(gazes.samples[2], 1, &check), 1);
    assert_true(fabs(check.most - 180) < 1e-9); /* looks away */
    gw_gazes_finish(&gazes);
}

static void hostile_files_do_no_harm(void **state) {
    static const char *const seeds[2] = {
        HEAD MARK "  - {name: b, wall: [900, 0, 1500], device: [2, 2, 3]}\n"
                  "  - {name: c, wall: [0, 900, 1500], device: [1, 3, 3]}\n"
                  "  - {name: d, wall: [0, 0, 2500], device: [1, 2, 4]}\n",
        GAZES "  - {viewer: 1, target: [0, 0, 0], eye: [0, 0, 900], directions: [[0, 0, -1], [1, 0, -2]]}\n"};
    static const char letters[] = "0123456789.-,:[]{} \n'\"e\xff";
    uint32_t random = 5;
    (void)state;
    for (int round = 0; round < 4000; round++) {
        const char *seed = seeds[round % 2];
        const size_t size = strlen(seed);
        uint8_t *copy = malloc(size);
        assert_non_null(copy);
        memcpy(copy, seed, size);
        for (int change = 0; change <= round % 5; change++) {
            random = random * 1664525u + 1013904223u;
            copy[(random >> 8) % size] = (uint8_t)letters[(random >> 3) % (sizeof letters - 1)];
        }
        (round % 2 ? fuzz_gazes : fuzz_marks)(copy, size);
        free(copy);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_files_are_refused_with_their_line),
        cmocka_unit_test(marks_are_understood),
        cmocka_unit_test(positions_come_from_a_recording),
        cmocka_unit_test(gazes_are_understood),
        cmocka_unit_test(hostile_files_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
