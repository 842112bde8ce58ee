/* From a device's numbers to wall space: all 48 axis maps against matrices, left-handed ones too; units; eyes
 * behind their sensors. */
#include "tests/support/check.h"
#include "tests/support/random.h"

#include "tracking/quaternion.h"
#include "tracking/setup.h"

#include <math.h>

static uint64_t seed = 20250611;

static double random_number(void) { /* -1 to 1 */
    return 2 * random_unit(&seed) - 1;
}

static void random_turn(double q[4]) {
    do
        for (int i = 0; i < 4; i++)
            q[i] = random_number();
    while (!gw_turn_normalise(q));
}

static void random_vector(double v[3], double size) {
    for (int i = 0; i < 3; i++)
        v[i] = size * random_number();
}

static void assert_near(const double *a, const double *b, double tolerance, const char *what, int map) {
    for (int i = 0; i < 3; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance))
            fail_msg("%s, map %d: [%g, %g, %g], expected [%g, %g, %g]", what, map, a[0], a[1], a[2], b[0],
                     b[1], b[2]);
}

static void maps_are_48_and_come_back_as_text(void **state) {
    (void)state;
    int right = 0;
    for (int m = 0; m < GW_AXIS_MAPS; m++) {
        const gw_axis_map map = gw_axis_map_at(m);
        gw_axis_map again;
        char text[GW_AXIS_TEXT];
        gw_axis_map_write(&map, text);
        check_ok(gw_axis_map_parse(text, &again, &error));
        assert_memory_equal(&map, &again, sizeof map);
        for (int other = 0; other < m; other++) {
            const gw_axis_map before = gw_axis_map_at(other);
            assert_memory_not_equal(&map, &before, sizeof map);
        }
        double columns[3][3];
        for (int c = 0; c < 3; c++)
            gw_axis_map_apply(&map, (const double[3]){c == 0, c == 1, c == 2}, columns[c]);
        const double *a = columns[0], *b = columns[1], *c = columns[2];
        const double determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                                   a[2] * (b[0] * c[1] - b[1] * c[0]);
        assert_true(determinant == gw_axis_map_hand(&map));
        right += determinant > 0;
    }
    assert_int_equal(right, 24);
}

static void usual_frames_have_names(void **state) {
    (void)state;
    static const struct {
        const char *name, *text;
        int hand;
        double forward[3]; /* in the device's axes: what looks at the wall */
    } known[] = {{"y-up", "x y z", 1, {0, 0, -1}},
                 {"z-up", "x z -y", 1, {0, 1, 0}},
                 {"unity", "x y -z", -1, {0, 0, 1}},
                 {"unreal", "y z -x", -1, {1, 0, 0}}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        gw_axis_map map;
        char text[GW_AXIS_TEXT];
        double forward[3];
        check_ok(gw_axis_map_parse(known[i].name, &map, &error));
        gw_axis_map_write(&map, text);
        assert_string_equal(text, known[i].text);
        assert_int_equal(gw_axis_map_hand(&map), known[i].hand);
        gw_axis_map_apply(&map, known[i].forward, forward);
        assert_near(forward, (const double[3]){0, 0, -1}, 0, known[i].name, (int)i);
    }
}

static void wrong_maps_are_refused(void **state) {
    (void)state;
    gw_axis_map map;
    check_ok(gw_axis_map_parse(" +X,-z\ty ", &map, &error));
    static const char *const wrong[] = {"", "x", "x y", "x y z x", "x y w", "--x y z", "x-", "north"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        check_fails(gw_axis_map_parse(wrong[i], &map, &error), GW_BAD_INPUT, "is no axis map");
    check_fails(gw_axis_map_parse("x -x z", &map, &error), GW_BAD_INPUT, "names an axis twice");
}

/* What defines the orientation: a point of the sensor's body is, in wall space, where the room puts the point
 * that the device would report there. It must hold for every map; with the quaternion taken through a
 * reflection without its sign it does not. */
static void bodies_are_where_their_points_are(void **state) {
    (void)state;
    int naive_failed = 0;
    for (int m = 0; m < GW_AXIS_MAPS; m++)
        for (int repeat = 0; repeat < 20; repeat++) {
            gw_room room;
            double p[3], q[4], body[3], at[3], turned[4], device[3], wanted[3], got[3];
            gw_room_default(repeat % 2 ? 1000 : 1, &room);
            room.axes = gw_axis_map_at(m);
            random_turn(room.turn);
            random_vector(room.shift, 3000);
            random_vector(p, 2);
            random_turn(q);
            random_vector(body, 0.3);
            gw_turn_vector(q, body, device);
            for (int i = 0; i < 3; i++)
                device[i] += p[i];
            gw_room_position(&room, device, wanted);
            gw_room_pose(&room, p, q, at, turned);
            gw_axis_map_apply(&room.axes, body, body);
            gw_turn_vector(turned, body, got);
            for (int i = 0; i < 3; i++)
                got[i] = at[i] + room.unit * got[i];
            assert_near(got, wanted, 1e-9, "body", m);

            double naive[4] = {0, 0, 0, q[3]};
            gw_axis_map_apply(&room.axes, q, naive);
            gw_turn_after(room.turn, naive, naive);
            gw_turn_vector(naive, body, got);
            double off = 0;
            for (int i = 0; i < 3; i++)
                off = fmax(off, fabs(at[i] + room.unit * got[i] - wanted[i]) / room.unit);
            naive_failed += gw_axis_map_hand(&room.axes) < 0 && off > 1e-3;
        }
    assert_true(naive_failed > 24 * 20 * 9 / 10);
}

/* A person who turns to the left in a left-handed frame turns to the left in the room. */
static void a_left_handed_head_turns_the_right_way(void **state) {
    (void)state;
    gw_room room;
    double at[3], q[4], looks[3];
    const double half = 0.5 * 30 * 3.14159265358979323846 / 180;
    gw_room_default(1000, &room);
    check_ok(gw_axis_map_parse("unity", &room.axes, &error));
    /* Unity: y up, left-handed; a positive turn about y is to the right. */
    gw_room_pose(&room, (const double[3]){0.5, 1.7, -2}, (const double[4]){0, sin(half), 0, cos(half)}, at,
                 q);
    assert_near(at, (const double[3]){500, 1700, 2000}, 1e-9, "position", 0);
    gw_turn_vector(q, (const double[3]){0, 0, -1}, looks);
    assert_near(looks, (const double[3]){0.5, 0, -sqrt(0.75)}, 1e-12, "direction", 0);
}

static void eyes_are_behind_their_sensors(void **state) {
    (void)state;
    gw_tracker_viewer viewer;
    double eye[3], head[4], right[3];
    gw_tracker_viewer_default(0, &viewer);
    const double r = sqrt(0.5);
    /* A sensor on the back of the head, upside down: its y is down. */
    memcpy(viewer.head_turn, (const double[4]){0, 0, 1, 0}, sizeof viewer.head_turn);
    memcpy(viewer.eye_offset, (const double[3]){0, -60, -200}, sizeof viewer.eye_offset);
    /* The head looks to the left (-x): the head's turn is 90 degrees about y, the sensor's that and its own.
     */
    double sensor[4];
    gw_turn_after((const double[4]){0, r, 0, r}, (const double[4]){0, 0, -1, 0}, sensor);
    gw_tracker_eye(&viewer, (const double[3]){100, 1700, 2000}, sensor, eye, head);
    assert_near(eye, (const double[3]){-100, 1640, 2000}, 1e-9, "eye", 0);
    gw_turn_vector(head, (const double[3]){1, 0, 0}, right);
    assert_near(right, (const double[3]){0, 0, -1}, 1e-12, "right", 0);
}

static void defaults_are_those_of_tracks(void **state) {
    (void)state;
    gw_tracker_setup setup;
    gw_tracker_setup_default("Tracker0@host", &setup);
    assert_int_equal(setup.source_count, 1);
    assert_true(setup.sources[0].room.unit == 1000);
    assert_int_equal(setup.viewer_count, GW_TRACK_VIEWERS);
    assert_int_equal(setup.viewers[3].head_sensor, 6);
    assert_int_equal(setup.viewers[3].gaze_sensor, 7);
    assert_int_equal(setup.navigation.reset, -1);
    assert_true(gw_tracker_gaze_error(&setup.viewers[0]) < gw_gaze_default_error(GW_GAZE_KIND_HEAD));
    setup.viewers[0].gaze_error = 3;
    assert_true(gw_tracker_gaze_error(&setup.viewers[0]) == 3);
    gw_tracker_setup_default("dtrack:5000", &setup);
    assert_true(setup.sources[0].room.unit == 1);
}

static void units_that_cannot_be_are_suspected(void **state) {
    (void)state;
    static const struct {
        double unit, away;
        const char *says;
    } rooms[] = {{1000, 1700, "is it mm?"}, {1000, 170, "is it cm?"}, {1, 1.7, "is it m?"},
                 {1000, 1.7, NULL},         {1, 1700, NULL},          {10, 170, NULL}};
    for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
        gw_room room;
        gw_room_sanity sanity = {0};
        char text[256];
        gw_room_default(rooms[i].unit, &room);
        for (int k = 0; k < 10; k++) {
            assert_false(gw_room_suspect(&sanity, &room, text, sizeof text));
            gw_room_watch(&sanity, &room, (const double[3]){0, 0, rooms[i].away});
        }
        assert_int_equal(gw_room_suspect(&sanity, &room, text, sizeof text), rooms[i].says != NULL);
        if (rooms[i].says)
            assert_non_null(strstr(text, rooms[i].says));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_are_48_and_come_back_as_text),
        cmocka_unit_test(usual_frames_have_names),
        cmocka_unit_test(wrong_maps_are_refused),
        cmocka_unit_test(bodies_are_where_their_points_are),
        cmocka_unit_test(a_left_handed_head_turns_the_right_way),
        cmocka_unit_test(eyes_are_behind_their_sensors),
        cmocka_unit_test(defaults_are_those_of_tracks),
        cmocka_unit_test(units_that_cannot_be_are_suspected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
