/* Cameras: paths through their keys, smooth in between, and planes of pixels that look where they should. */
#include "tests/support/check.h"

#include "render/camera.h"

#include <math.h>

static gw_camera_key keys[] = {{1, {0, 0, 0}, {0, 0, -1}},
                               {2, {1, 0, 0}, {1, 0, -1}},
                               {4, {3, 2, 0}, {3, 2, -5}},
                               {5, {3, 4, 0}, {0, 4, 0}}};
static const gw_camera_path path = {.name = "there", .fov = 45, .key_count = 4, .keys = keys};

static void a_path_goes_through_its_keys(void **state) {
    double eye[3], look_at[3];
    (void)state;
    for (size_t i = 0; i < path.key_count; ++i) {
        gw_camera_path_at(&path, keys[i].time, eye, look_at);
        for (int k = 0; k < 3; ++k) {
            assert_true(fabs(eye[k] - keys[i].eye[k]) < 1e-12);
            assert_true(fabs(look_at[k] - keys[i].look_at[k]) < 1e-12);
        }
    }
    gw_camera_path_at(&path, -100, eye, look_at);
    assert_true(eye[0] == 0 && look_at[2] == -1);
    gw_camera_path_at(&path, 100, eye, look_at);
    assert_true(fabs(eye[1] - 4) < 1e-12 && fabs(look_at[0]) < 1e-12);
}

/* On both sides of a key the speed is the same, and that of the line between the key's neighbours: keys at 1
 * and 4 s are (3, 2, 0) apart. A path of straight lines would jump from (1, 0) to (1, 1) per second at 2 s.
 */
static void speed_has_no_jumps(void **state) {
    const double step = 1e-6;
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        double at[3], beside[3], look_at[3];
        gw_camera_path_at(&path, 2, at, look_at);
        gw_camera_path_at(&path, 2 + side * step, beside, look_at);
        assert_true(fabs((beside[0] - at[0]) / (side * step) - 1) < 1e-4);
        assert_true(fabs((beside[1] - at[1]) / (side * step) - 2.0 / 3) < 1e-4);
    }
}

static void paths_are_found_by_name_and_number(void **state) {
    gw_camera_path two[2] = {path, path};
    gw_scene scene = {.path_count = 2, .paths = two}, none = {0};
    const gw_camera_path *found = NULL;
    (void)state;
    snprintf(two[1].name, sizeof two[1].name, "back");
    check_ok(gw_camera_path_find(&scene, "back", &found, &error));
    assert_ptr_equal(found, &two[1]);
    check_ok(gw_camera_path_find(&scene, "0", &found, &error));
    assert_ptr_equal(found, &two[0]);
    check_fails(gw_camera_path_find(&scene, "2", &found, &error), GW_BAD_INPUT,
                "it has 2, the first is 'there'");
    check_fails(gw_camera_path_find(&none, "0", &found, &error), GW_BAD_INPUT, "it has 0");
}

/* 100 x 50 pixels at 90 degrees: 2 m before the camera the picture is 4 m high, 8 m wide. */
static void a_camera_looks_where_it_should(void **state) {
    const double eye[3] = {1, 2, 3}, look_at[3] = {1, 2, 1}, up[3] = {0, 1, 0}, down[3] = {1, 0, 3};
    const uint32_t size[2] = {100, 50};
    gw_perspective view;
    (void)state;
    check_ok(gw_perspective_of(eye, look_at, up, 90, size, &view, &error));
    assert_true(fabs(view.plane.corner[0] + 3000) < 1e-9 && fabs(view.plane.corner[1] - 4000) < 1e-9);
    assert_true(fabs(view.plane.step_x[0] - 80) < 1e-9 && fabs(view.plane.step_y[1] + 80) < 1e-9);
    assert_true(view.eye[2] == 3000 && fabs(view.centre[2] - 1000) < 1e-9);
    check_ok(gw_perspective_of(eye, down, up, 90, size, &view, &error));
    assert_true(view.plane.step_y[2] > 0 && view.plane.step_x[0] > 0);
    check_fails(gw_perspective_of(eye, eye, up, 90, size, &view, &error), GW_BAD_INPUT, "no direction");
}

/* A wall that navigates shows what stands there, true to scale; without navigation the scene stands as it is
 * placed. */
static void a_frame_stands_where_its_state_says(void **state) {
    const double centre[3] = {0, 0, 0}, neutral[3] = {10, 20, 1800};
    gw_scene scene = {.bounds = {{-1, -1, -1}, {1, 1, 1}}};
    gw_frame_state frame;
    gw_similarity placed, navigated;
    double wall[3];
    (void)state;
    memset(&frame, 0, sizeof frame);
    check_ok(gw_place_scene(&scene, 2000, 1000, centre, neutral, &placed, &error));
    check_ok(gw_place_frame(&scene, &frame, 2000, 1000, centre, neutral, &navigated, &error));
    assert_memory_equal(&placed, &navigated, sizeof placed);
    const double ahead[3] = {5, 2, 7};
    for (int k = 0; k < 3; ++k)
        frame.stand[k] = frame.look_at[k] = (float)ahead[k];
    frame.stand[2] = 9; /* looks along -z, as the wall does */
    check_ok(gw_place_frame(&scene, &frame, 2000, 1000, centre, neutral, &navigated, &error));
    gw_scene_to_wall(&navigated, ahead, wall);
    assert_true(fabs(wall[0] - 10) < 1e-9 && fabs(wall[1] - 20) < 1e-9 && fabs(wall[2] + 200) < 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_goes_through_its_keys),
        cmocka_unit_test(speed_has_no_jumps),
        cmocka_unit_test(paths_are_found_by_name_and_number),
        cmocka_unit_test(a_camera_looks_where_it_should),
        cmocka_unit_test(a_frame_stands_where_its_state_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
