/* Trackers in site files: wrong ones with message and line, odd ones with a warning, what is written and read
 * back bit for bit, the difference of two, the drawing, hostile ones. */
#include "tests/support/check.h"

#include "tests/fuzz/site_entry.h"
#include "tracking/quaternion.h"
#include "wall/site.h"

#include <math.h>

static gw_site site, other;
static gw_site_notes notes;

/* Line 1 and 2 are the wall; what is tested starts in line 3. */
#define WALL "version: 1\ngrid: {columns: 2, rows: 1, tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
#define LIST WALL "trackers:\n" /* line 3 */
#define VIEWERS LIST "  - source: A@h\n    viewers:\n"

static gw_code parse(const char *text, gw_site *out, gw_error *error) {
    return gw_site_parse(text, strlen(text), "wall.yaml", out, &notes, error);
}

typedef struct mistake {
    const char *text;
    int line;
    const char *message;
} mistake;

static const mistake mistakes[] = {
    {WALL "tracker: A@h\ntrackers: [{source: B@h}]\n", 3, "there are 'trackers', too, in line 4; keep one"},
    {WALL "trackers: A@h\n", 3, "key 'trackers': expected a list, found 'A@h'"},
    {WALL "trackers: []\n", 3, "key 'trackers': 0 of them; expected 1 to 4"},
    {LIST "  - unit: m\n", 4, "key 'source' is missing here"},
    {LIST "  - source: \"A'h\"\n", 4, "key 'source': 'A'h' has a character that cannot be here"},
    {LIST "  - source: A@h\n    units: m\n", 5, "key 'units' is unknown; did you mean 'unit'?"},
    {LIST "  - source: A@h\n    bind: eth0\n", 5, "key 'bind': 'eth0' is no address"},
    {LIST "  - source: A@h\n    unit: km\n", 5, "key 'unit': 'km' is unknown; expected m, mm, cm, inch, ft"},
    {LIST "  - source: A@h\n    unit: 0\n", 5, "key 'unit': 0 is outside 0.001 to 100000"},
    {LIST "  - source: A@h\n    unit: 25.4 mm\n", 5, "key 'unit': '25.4 mm' is unknown"},
    {LIST "  - source: A@h\n    axes: x y\n", 5, "key 'axes': 'x y' is no axis map; expected the device's"},
    {LIST "  - source: A@h\n    axes: x -y -y\n", 5, "names an axis twice"},
    {LIST "  - source: A@h\n    axes: [x, y, z]\n", 5, "key 'axes': expected"},
    {LIST "  - source: A@h\n    turn: [0, 90, 0]\n", 5,
     "key 'turn': 3 values; expected a quaternion [x, y, z, w], or three axis vectors [[...], [...], [...]] "
     "(not "
     "three angles"},
    {LIST "  - source: A@h\n    turn: [0, 0, 0, 0]\n", 5, "key 'turn': the quaternion has the length 0"},
    {LIST "  - source: A@h\n    turn: [0, 0.7, 0, 0.8]\n", 5, "has the length 1.06301; expected 1"},
    {LIST "  - source: A@h\n    turn: [0, 0, 0, 1e400]\n", 5, "key 'turn': item 4"},
    {LIST "  - source: A@h\n    turn: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]\n", 5,
     "key 'turn': the three axes are left-handed, which no turn is; give the hand of the device in 'axes'"},
    {LIST "  - source: A@h\n    turn: [[1, 0, 0], [0, 1, 0], [0, 0, 2]]\n", 5, "axis 3 has the length 2"},
    {LIST "  - source: A@h\n    turn: [[1, 0, 0], [0.1, 0.995, 0], [0, 0, 1]]\n", 5,
     "axes 1 and 2 are at 84.3 degrees instead of 90"},
    {LIST "  - source: A@h\n    shift: [0, 2e6, 0]\n", 5, "more than a kilometre away; expected mm"},
    {LIST "  - source: A@h\n  - source: A@h\n    viewers: [{head: 0}]\n", 5,
     "key 'source': 'A@h' is tracker 1 already; put all its viewers there"},
    {LIST "  - source: A@h\n  - source: B@h\n", 4, "several, and none says which sensors are whose"},
    {VIEWERS "      - {gaze: head}\n", 6, "key 'head' is missing here"},
    {VIEWERS "      - {head: -1}\n", 6, "key 'head': -1 is outside 0 to 999"},
    {VIEWERS "      - {head: none}\n", 6, "a viewer without a head has no gaze from it"},
    {VIEWERS "      - {head: 0, gaze: eyes}\n", 6,
     "key 'gaze': 'eyes' is unknown; expected head, none, 'sensor N'"},
    {VIEWERS "      - {head: 0, gaze: sensor -1}\n", 6, "key 'gaze': 'sensor -1' is unknown"},
    {VIEWERS "      - {head: 0, gaze: sensor 1 2}\n", 6, "key 'gaze': 'sensor 1 2' is unknown"},
    {VIEWERS "      - {head: 0, gaze: events 1000}\n", 6, "key 'gaze': 1000 is too high; expected 0 to 999"},
    {VIEWERS "      - {head: 3, gaze: sensor 3}\n", 6, "sensor 3 is this viewer's head; 'gaze: head' takes"},
    {VIEWERS "      - {head: 0}\n      - {head: 0}\n", 7,
     "key 'head': sensor 0 is the head of the viewer of line 6 already"},
    {VIEWERS "      - {head: 0, gaze: sensor 1}\n      - {head: 1}\n", 7,
     "key 'head': sensor 1 is the gaze of the viewer of line 6 already"},
    {VIEWERS "      - {head: 0, gaze: events 0}\n      - {head: 1, gaze: sensor 5 or events 0}\n", 7,
     "key 'gaze': events 0 are those of the viewer of line 6 already"},
    {VIEWERS "      - {head: 0, gaze: events 0, gaze_from: 'gaze:5'}\n", 6,
     "key 'gaze_from': no tracker of this site has the source 'gaze:5'"},
    {VIEWERS "      - {head: 0, gaze_from: A@h}\n", 6, "key 'gaze_from' goes with a 'gaze' of 'sensor N'"},
    {VIEWERS "      - {head: 0, gaze_error: 50}\n", 6, "key 'gaze_error': 50 is outside 0 to 45"},
    {VIEWERS "      - {head: 0, eye_offset: [0, -800, 700]}\n", 6,
     "the eyes are 1063 mm from the head's sensor; expected at most 1000"},
    {VIEWERS "      - {head: 0, head_turn: [0, 0, 1]}\n", 6,
     "key 'head_turn': 3 values; expected a quaternion"},
    {VIEWERS
     "      - {head: 0}\n      - {head: 1}\n      - {head: 2}\n      - {head: 3}\n      - {head: 4}\n",
     10, "one more than the 4 that a wall can have"},
    {LIST "  - source: A@h\n    navigation: {fly: 1}\n", 5, "key 'fly' is unknown"},
    {LIST "  - source: A@h\n    navigation: {forward: x}\n", 5, "key 'forward': expected a whole number"},
    {LIST "  - source: A@h\n    viewers: [{head: 0}]\n    navigation: {turn: 0}\n"
          "  - source: B@h\n    navigation: {turn: 0}\n",
     8, "key 'navigation': another tracker navigates already; keep one"},
};

static void wrong_trackers_are_refused_with_their_line(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        gw_error error = {0};
        char start[32];
        snprintf(start, sizeof start, "wall.yaml:%d: ", mistakes[i].line);
        if (parse(mistakes[i].text, &site, &error) != GW_BAD_INPUT)
            fail_msg("accepted, but \"%s\" was expected:\n%s", mistakes[i].message, mistakes[i].text);
        if (strncmp(error.text, start, strlen(start)) != 0 || !strstr(error.text, mistakes[i].message))
            fail_msg("\"%s\", expected \"%s%s\" for\n%s", error.text, start, mistakes[i].message,
                     mistakes[i].text);
    }
}

static const mistake oddities[] = {
    {LIST "  - source: A@h\n    shift: [0, 1.2, 0.35]\n", 5,
     "1.25 mm from wall space's origin; is it in metres?"},
    {LIST "  - source: A@h\n    shift: [0, 60000, 0]\n", 5, "60 m from wall space's origin; expected mm"},
    {VIEWERS "      - {head: 0, eye_offset: [0, -0.08, 0]}\n", 6,
     "0.08 mm is next to nothing; is it in metres?"},
    {VIEWERS "      - {head: 0, eye_offset: [0, -400, 0]}\n", 6,
     "the eyes are 400 mm from the head's sensor"},
};

static void odd_trackers_are_read_with_a_warning(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof oddities / sizeof *oddities; i++) {
        check_ok(parse(oddities[i].text, &site, &error));
        if (notes.count != 1 || notes.notes[0].line != oddities[i].line ||
            !strstr(notes.notes[0].text, oddities[i].message))
            fail_msg("%u notes, \"%d: %s\", expected \"%d: %s\"", notes.count, notes.notes[0].line,
                     notes.notes[0].text, oddities[i].line, oddities[i].message);
    }
}

static void the_short_form_is_one_usual_source(void **state) {
    gw_tracker_setup usual;
    (void)state;
    check_ok(parse(WALL, &site, &error));
    assert_int_equal(site.trackers.source_count, 0);
    check_ok(parse(WALL "tracker: Head@host\n", &site, &error));
    gw_tracker_setup_default("Head@host", &usual);
    assert_memory_equal(&site.trackers, &usual, sizeof usual);
    /* The long form without more says the same. */
    check_ok(parse(LIST "  - source: Head@host\n", &other, &error));
    assert_memory_equal(&site.trackers, &other.trackers, sizeof usual);
    static gw_site_changes changes;
    check_ok(gw_site_compare(&site, &other, &changes, &error));
    assert_int_equal(changes.count, 0);
}

#define BOTH                                                                                                 \
    LIST "  - source: 'dtrack:5000'\n    bind: 10.0.0.10\n    axes: z-up\n"                                  \
         "    turn: [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]]\n    shift: [-1200, 0, 1500]\n    viewers:\n" \
         "      - {head: 0, eye_offset: [0, -80, -60], gaze: events 2, gaze_from: 'gaze:5555', gaze_error: " \
         "1.5}\n"                                                                                            \
         "      - {head: 1}\n      - {head: none, gaze: sensor 7}\n    navigation: {forward: 1, reset: 2}\n" \
         "  - source: 'gaze:5555'\n    unit: 25.4\n"

static void everything_is_understood(void **state) {
    (void)state;
    check_ok(parse(BOTH, &site, &error));
    assert_int_equal(notes.count, 0);
    const gw_tracker_setup *setup = &site.trackers;
    const gw_tracker_viewer *first = &setup->viewers[0];
    assert_int_equal(setup->source_count, 2);
    assert_int_equal(setup->viewer_count, 3);
    assert_string_equal(setup->sources[0].bind, "10.0.0.10");
    assert_true(setup->sources[0].room.unit == 1 && setup->sources[1].room.unit == 25.4);
    assert_int_equal(first->gaze, GW_GAZE_KIND_EVENTS);
    assert_int_equal(first->gaze_source, 1);
    assert_int_equal(first->gaze_viewer, 2);
    assert_int_equal(first->gaze_sensor, -1);
    assert_true(gw_tracker_gaze_error(first) == 1.5);
    assert_int_equal(setup->viewers[1].gaze, GW_GAZE_KIND_HEAD);
    assert_int_equal(setup->viewers[2].head_sensor, -1);
    assert_int_equal(setup->viewers[2].gaze_sensor, 7);
    assert_int_equal(setup->navigation.forward, 1);
    assert_int_equal(setup->navigation.turn, -1);
    /* 10 mm along the device's y (to the wall, by its axis map) are 10 mm along the turned -z. */
    double at[3];
    gw_room_position(&setup->sources[0].room, (const double[3]){0, 10, 0}, at);
    assert_true(fabs(at[0] + 1194) < 1e-9 && fabs(at[1]) < 1e-9 && fabs(at[2] - 1492) < 1e-9);
}

static void assert_same_again(const char *what) {
    char *text;
    size_t size;
    check_ok(gw_site_write(&site, &text, &size, &error));
    check_ok(gw_site_parse(text, size, "again.yaml", &other, &notes, &error));
    if (memcmp(&site.trackers, &other.trackers, sizeof site.trackers) != 0 ||
        strcmp(site.tracker, other.tracker))
        fail_msg("%s: other trackers after they were written and read:\n%.1500s", what, text);
    free(text);
}

static void what_is_written_reads_back_bit_for_bit(void **state) {
    (void)state;
    check_ok(parse(WALL "tracker: Head@host\n", &site, &error));
    assert_same_again("short form");
    check_ok(parse(LIST "  - source: Head@host\n", &site, &error));
    assert_same_again("usual viewers");
    check_ok(parse(BOTH, &site, &error));
    assert_same_again("two sources");
    uint32_t seed = 11;
    for (int round = 0; round < 200; round++) {
        double r[8];
        for (int i = 0; i < 8; i++) {
            seed = seed * 1664525u + 1013904223u;
            r[i] = (double)(seed >> 8) / 8388608.0 - 1;
        }
        gw_room *room = &site.trackers.sources[0].room;
        gw_tracker_viewer *viewer = &site.trackers.viewers[0];
        room->axes = gw_axis_map_at(round % GW_AXIS_MAPS);
        room->unit = 1 + r[0] * r[0] * 1e3;
        memcpy(room->turn, r + 1, sizeof room->turn);
        for (int i = 0; i < 3; i++) {
            room->shift[i] = r[5 + i] * 3000;
            viewer->eye_offset[i] = r[i] * 100;
        }
        memcpy(viewer->head_turn, r + 4, sizeof viewer->head_turn);
        if (gw_turn_normalise(room->turn) && gw_turn_normalise(viewer->head_turn))
            assert_same_again("random room");
    }
}

static void axis_vectors_and_quaternions_are_one(void **state) {
    uint32_t seed = 5;
    (void)state;
    for (int round = 0; round < 400; round++) {
        double q[4], axes[3][3], same = 0;
        char text[1024];
        for (int i = 0; i < 4; i++) {
            seed = seed * 1664525u + 1013904223u;
            q[i] = round % 5 == i ? 0 : (double)(seed >> 8) / 8388608.0 - 1; /* half turns, too */
        }
        if (!gw_turn_normalise(q))
            continue;
        for (int i = 0; i < 3; i++)
            gw_turn_vector(q, (const double[3]){i == 0, i == 1, i == 2}, axes[i]);
        snprintf(text, sizeof text,
                 LIST "  - source: A@h\n    turn: [[%.17g, %.17g, %.17g], [%.17g, %.17g, %.17g], "
                      "[%.17g, %.17g, %.17g]]\n",
                 axes[0][0], axes[0][1], axes[0][2], axes[1][0], axes[1][1], axes[1][2], axes[2][0],
                 axes[2][1], axes[2][2]);
        check_ok(parse(text, &site, &error));
        for (int i = 0; i < 4; i++)
            same += q[i] * site.trackers.sources[0].room.turn[i];
        assert_true(fabs(fabs(same) - 1) < 1e-12);
    }
}

static void differences_say_what_can_be_taken_over(void **state) {
    static gw_site_changes changes;
    static const struct {
        const char *from, *to, *says;
        int restart;
    } cases[] = {
        {"shift: [-1200, 0, 1500]", "shift: [-1200, 0, 1510]",
         "tracker 1: shift [-1200, 0, 1500] -> [-1200, 0, 1510]", 0},
        {"axes: z-up", "axes: x y z", "tracker 1: axes x z -y -> x y z", 0},
        {"unit: 25.4", "unit: m", "tracker 2: unit 25.4 -> 1000", 0},
        {"[0, -80, -60]", "[0, -80, -70]", "viewer 1: eye_offset [0, -80, -60] -> [0, -80, -70]", 0},
        {"gaze_error: 1.5", "gaze_error: 2", "viewer 1: gaze_error 1.5 -> 2", 0},
        {"dtrack:5000", "dtrack:5001", "tracker 1: source dtrack:5000 -> dtrack:5001", 1},
        {"bind: 10.0.0.10", "bind: 10.0.0.11", "tracker 1: bind 10.0.0.10 -> 10.0.0.11", 1},
        {"head: 1}", "head: 4}", "viewer 2: head 1 -> 4", 1},
        {"gaze: sensor 7", "gaze: events 7", "viewer 3: gaze sensor -> events", 1},
        {"reset: 2", "reset: 3", "navigation: reset 2 -> 3", 1},
    };
    (void)state;
    check_ok(parse(BOTH, &site, &error));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *at = strstr(BOTH, cases[i].from);
        char text[2048];
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - BOTH), BOTH, cases[i].to,
                 at + strlen(cases[i].from));
        check_ok(parse(text, &other, &error));
        assert_int_equal(gw_site_compare(&site, &other, &changes, NULL),
                         cases[i].restart ? GW_BAD_INPUT : GW_OK);
        int found = 0;
        for (uint32_t c = 0; c < changes.count; c++)
            found |= strstr(changes.changes[c].text, cases[i].says) != NULL &&
                     changes.changes[c].restart == cases[i].restart;
        if (!found)
            fail_msg("\"%s\" is not told; first of %u: \"%s\"", cases[i].says, changes.count,
                     changes.changes[0].text);
    }
    check_ok(parse(WALL, &other, &error));
    check_fails(gw_site_compare(&site, &other, &changes, &error), GW_BAD_INPUT, "trackers: sources 2 -> 0");
}

/* Each device stands in each of the three views, with its axes. */
static void the_drawing_shows_devices(void **state) {
    char *svg;
    size_t size;
    int named = 0;
    (void)state;
    check_ok(parse(BOTH, &site, &error));
    check_ok(gw_site_draw(&site, "", &svg, &size, &error));
    assert_null(strstr(svg, "nan"));
    for (const char *at = svg; (at = strstr(at, ">dtrack:5000</text>")); at++)
        named++;
    assert_int_equal(named, 3);
    assert_non_null(strstr(svg, ">z</text>"));
    free(svg);
    check_ok(parse(WALL, &site, &error));
    check_ok(gw_site_draw(&site, "", &svg, &size, &error));
    assert_null(strstr(svg, ">z</text>"));
    free(svg);
}

static void hostile_trackers_do_no_harm(void **state) {
    static const char letters[] = "0123456789.-,:[]{} \n'\"e\xff";
    const size_t start = strlen(WALL), length = strlen(BOTH);
    uint32_t random = 3;
    (void)state;
    for (int round = 0; round < 3000; round++) {
        uint8_t *copy = malloc(length);
        assert_non_null(copy);
        memcpy(copy, BOTH, length);
        for (int change = 0; change <= round % 4; change++) {
            random = random * 1664525u + 1013904223u;
            copy[start + (random >> 8) % (length - start)] =
                (uint8_t)letters[(random >> 3) % (sizeof letters - 1)];
        }
        fuzz_site(copy, length);
        free(copy);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_trackers_are_refused_with_their_line),
        cmocka_unit_test(odd_trackers_are_read_with_a_warning),
        cmocka_unit_test(the_short_form_is_one_usual_source),
        cmocka_unit_test(everything_is_understood),
        cmocka_unit_test(what_is_written_reads_back_bit_for_bit),
        cmocka_unit_test(axis_vectors_and_quaternions_are_one),
        cmocka_unit_test(differences_say_what_can_be_taken_over),
        cmocka_unit_test(the_drawing_shows_devices),
        cmocka_unit_test(hostile_trackers_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
