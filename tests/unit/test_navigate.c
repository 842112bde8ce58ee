/* Navigation: speed in metres a second of the room, no roll, no pole, and a guard that no step passes, where
 * the naive step does. */
#include "tests/support/check.h"

#include "render/camera.h"
#include "render/vector3.h"
#include "wall/navigate.h"

#include <math.h>

static const double neutral[3] = {100, -50, 1800}; /* mm */

static gw_navigation standing(void) {
    return (gw_navigation){.position = {1, 2, 3}, .scale = 1000, .speed = 1.4};
}

static double apart(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(gw_dot(d, d));
}

/* --- moving
 * ---------------------------------------------------------------------------------------------------- */

static void speed_is_that_of_the_room(void **state) {
    const double scales[] = {1000, 50000, 10}; /* mm of the wall per scene metre */
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        gw_navigation n = standing(), before = n;
        n.scale = before.scale = scales[i];
        const gw_navigation_input ahead = {.move = {0, 0, 1}};
        for (int step = 0; step < 60; step++)
            n = gw_navigate(&n, &ahead, 1 / 60.0, NULL);
        /* One second at 1.4 m/s, in metres of the scene; it looks along -z. */
        assert_true(fabs(before.position[2] - n.position[2] - 1.4 * 1000 / scales[i]) < 1e-9 * 1e5);
        assert_true(fabs(n.position[0] - 1) + fabs(n.position[1] - 2) < 1e-12);
    }
}

static void directions_are_the_viewers(void **state) {
    const double quarter = M_PI / 2;
    const struct {
        double yaw, pitch;
        gw_navigation_input input;
        double way[3];
    } cases[] = {{0, 0, {.move = {1, 0, 0}}, {1, 0, 0}},
                 {0, 0, {.move = {0, 1, 0}}, {0, 1, 0}},
                 {quarter, 0, {.move = {0, 0, 1}}, {1, 0, 0}},
                 {quarter, 0, {.move = {1, 0, 0}}, {0, 0, 1}},
                 {0, 0.5, {.move = {0, 0, 1}}, {0, sin(0.5), -cos(0.5)}},
                 {0, 0.5, {.move = {0, 1, 0}}, {0, 1, 0}},
                 {0, 0, {.move = {0, 0, -1}, .haste = 4}, {0, 0, 4}}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        gw_navigation n = standing();
        n.yaw = cases[i].yaw;
        n.pitch = cases[i].pitch;
        n = gw_navigate(&n, &cases[i].input, 1 / 1.4, NULL);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(n.position[k] - (k + 1) - cases[i].way[k]) < 1e-12);
    }
}

static void time_never_runs_back_and_speed_has_ends(void **state) {
    const gw_navigation_input ahead = {.move = {0, 0, 1}}, wheel = {.notches = 1000},
                              back = {.notches = -1000};
    gw_navigation n = standing(), after = gw_navigate(&n, &ahead, -1, NULL);
    (void)state;
    assert_memory_equal(&n, &after, sizeof n);
    assert_true(gw_navigate(&n, &wheel, 0, NULL).speed == GW_FASTEST);
    assert_true(gw_navigate(&n, &back, 0, NULL).speed == GW_SLOWEST);
    assert_false(gw_navigation_is_asked(&(gw_navigation_input){.haste = 4, .notches = 2}));
    assert_true(gw_navigation_is_asked(&(gw_navigation_input){.turn = {0, 0.1}}));
}

/* --- the view
 * -------------------------------------------------------------------------------------------------- */

static gw_similarity placed(const gw_navigation *n, gw_frame_state *frame) {
    const gw_scene scene = {.bounds = {{-1, -1, -1}, {1, 1, 1}},
                            .placement = {.kind = GW_PLACE_FIT_BEHIND_WALL}};
    const double centre[3] = {100, -50, 0};
    gw_similarity out;
    memset(frame, 0, sizeof *frame);
    gw_navigation_apply(n, frame);
    check_ok(gw_place_frame(&scene, frame, 2000, 1000, centre, neutral, &out, &error));
    return out;
}

/* Whatever is asked for, however long: up on the wall has no part to the side (no roll), the direction is
 * never lost, and the eye stands where navigation says. */
static void it_never_rolls_nor_tips_over(void **state) {
    gw_navigation n = standing();
    (void)state;
    for (int i = 0; i < 2000; i++) {
        const gw_navigation_input input = {.move = {sin(i * 0.7), cos(i * 1.3), sin(i * 0.31)},
                                           .turning = {3 * sin(i * 0.05), 2 * cos(i * 0.011)},
                                           .turn = {0.02, i % 500 == 0 ? 9 : 0}};
        gw_frame_state frame;
        n = gw_navigate(&n, &input, 0.02, NULL);
        assert_true(fabs(n.pitch) <= GW_STEEPEST && fabs(n.yaw) <= M_PI);
        const gw_similarity s = placed(&n, &frame);
        assert_true(fabs(s.rotation[0][1]) < 1e-6); /* the wall's right lies level in the scene */
        assert_true(s.rotation[1][1] > 0.01);       /* and its up is up */
        double eye[3];
        gw_wall_to_scene(&s, neutral, eye);
        assert_true(apart(eye, n.position) < 1e-5);
    }
}

/* Taking off changes nothing of the picture, whatever the placement's scale: flying on would jump otherwise.
 */
static void taking_off_does_not_jump(void **state) {
    gw_frame_state frame;
    (void)state;
    for (int i = 0; i < 20; i++) {
        const gw_navigation wanted = {.position = {0.3 * i, -0.1 * i, 2},
                                      .yaw = 0.3 * i - 3,
                                      .pitch = 0.14 * i - 1.4,
                                      .scale = 700.0 * (i + 1),
                                      .speed = 1};
        const gw_similarity before = placed(&wanted, &frame);
        const gw_navigation n = gw_navigation_of(&before, neutral, 1);
        const gw_similarity after = placed(&n, &frame);
        assert_true(fabs(after.scale / before.scale - 1) < 1e-6);
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                assert_true(fabs(after.rotation[r][c] - before.rotation[r][c]) < 1e-6);
            /* mm on a wall of metres */
            assert_true(fabs(after.translation[r] - before.translation[r]) < 0.05);
        }
    }
}

/* --- the guard
 * ------------------------------------------------------------------------------------------------- */

/* A room of planes, each with the room on the side of its normal; endless, infinitely thin. */
typedef struct room {
    size_t count;
    double planes[6][4]; /* unit normal, offset */
    int asked;
} room;

static int meet(void *context, const double from[3], const double direction[3], double reach,
                double *distance, double normal[3]) {
    room *r = context;
    double nearest = reach;
    int met = 0;
    r->asked++;
    for (size_t i = 0; i < r->count; i++) {
        const double *p = r->planes[i], slope = gw_dot(p, direction);
        const double t = slope != 0 ? (p[3] - gw_dot(p, from)) / slope : -1;
        if (t <= 0 || t > nearest)
            continue;
        nearest = *distance = t;
        met = 1;
        for (int k = 0; k < 3; k++)
            normal[k] = i % 2 ? p[k] : -p[k]; /* on either side */
    }
    return met;
}

static double least_height(const room *r, const double at[3]) {
    double least = INFINITY;
    for (size_t i = 0; i < r->count; i++)
        least = fmin(least, gw_dot(r->planes[i], at) - r->planes[i][3]);
    return least;
}

static const room box = {
    .count = 6,
    .planes = {{1, 0, 0, -2}, {-1, 0, 0, -2}, {0, 1, 0, -1}, {0, -1, 0, -1}, {0, 0, 1, -3}, {0, 0, -1, -3}}};

static void no_step_passes_a_wall(void **state) {
    room r = box;
    const gw_surfaces surfaces = {.meet = meet, .context = &r};
    const gw_navigation start = {.scale = 1000, .speed = 10};
    const gw_navigation_input ahead = {.move = {0, 0, 1}};
    (void)state;
    /* One step of a second: the naive one is behind the wall, 7 m out of the room. */
    assert_true(least_height(&r, gw_navigate(&start, &ahead, 1, NULL).position) < -6.9);
    const gw_navigation stopped = gw_navigate(&start, &ahead, 1, &surfaces);
    assert_true(fabs(stopped.position[2] + 3 - 0.001 * GW_CLEARANCE) < 1e-9);
    /* Again and again against it, nothing gives way. */
    gw_navigation n = stopped;
    for (int i = 0; i < 1000; i++)
        n = gw_navigate(&n, &ahead, 0.2, &surfaces);
    assert_true(apart(n.position, stopped.position) < 1e-9);
    /* Away from it nothing holds. */
    const gw_navigation_input away = {.move = {0, 0, -1}};
    assert_true(fabs(gw_navigate(&n, &away, 0.1, &surfaces).position[2] - n.position[2] - 1) < 1e-12);
}

/* Every way through the box, at any speed, for thousands of steps: the eye stays inside. */
static void nobody_leaves_a_closed_room(void **state) {
    room r = box;
    const gw_surfaces surfaces = {.meet = meet, .context = &r};
    gw_navigation n = {.scale = 1000, .speed = 3}, naive = n;
    int outside = 0;
    double way = 0;
    (void)state;
    for (int i = 0; i < 5000; i++) {
        const gw_navigation_input input = {.move = {sin(i * 0.17), 0.7 * cos(i * 0.013), cos(i * 0.37)},
                                           .turning = {sin(i * 0.003), 0.4 * sin(i * 0.007)},
                                           .haste = i % 7 ? 1 : 40};
        const gw_navigation before = n;
        n = gw_navigate(&n, &input, 0.05, &surfaces);
        naive = gw_navigate(&naive, &input, 0.05, NULL);
        way += apart(n.position, before.position);
        assert_true(least_height(&r, n.position) > 0.01);
        outside += least_height(&r, naive.position) < 0;
    }
    assert_true(outside > 1000); /* without the guard it is out most of the time */
    assert_true(way > 100);      /* with it one still gets about */
}

static void one_slides_along_a_wall(void **state) {
    room r = box;
    const gw_surfaces surfaces = {.meet = meet, .context = &r};
    gw_navigation n = {.position = {-1.5, 0, -2.5}, .yaw = M_PI / 4, .scale = 1000, .speed = 1};
    const gw_navigation_input ahead = {.move = {0, 0, 1}};
    (void)state;
    for (int i = 0; i < 20; i++)
        n = gw_navigate(&n, &ahead, 0.1, &surfaces);
    /* Along x as if nothing were there, in z no further than the wall. */
    assert_true(fabs(n.position[0] + 1.5 - 2 * sqrt(0.5)) < 0.1);
    assert_true(n.position[2] > -3 + 0.0009 * GW_CLEARANCE && n.position[2] < -2.8);
}

/* In a scene that is shown a hundred times as large the same hand's breadth is a hundredth of the scene's. */
static void clearance_is_that_of_the_room(void **state) {
    room r = box;
    const gw_surfaces surfaces = {.meet = meet, .context = &r};
    const gw_navigation start = {.scale = 100000, .speed = 200};
    const gw_navigation_input ahead = {.move = {0, 0, 1}};
    (void)state;
    gw_navigation n = gw_navigate(&start, &ahead, 10, &surfaces);
    assert_true(fabs(n.position[2] + 3 - 0.00001 * GW_CLEARANCE) < 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(speed_is_that_of_the_room),
        cmocka_unit_test(directions_are_the_viewers),
        cmocka_unit_test(time_never_runs_back_and_speed_has_ends),
        cmocka_unit_test(it_never_rolls_nor_tips_over),
        cmocka_unit_test(taking_off_does_not_jump),
        cmocka_unit_test(no_step_passes_a_wall),
        cmocka_unit_test(nobody_leaves_a_closed_room),
        cmocka_unit_test(one_slides_along_a_wall),
        cmocka_unit_test(clearance_is_that_of_the_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
