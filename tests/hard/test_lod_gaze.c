/* Hard cases of levels of detail and of gazes: a checker finer than voxels keeps its colour at every level,
 * however fine; a hand-over of levels at grazing light; gazes on seams, off the wall, of no number, that
 * jump; eyes on and behind the panel's plane and far off-axis. No picture holds a pixel that is no number, no
 * ray is cut off. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };

static uint8_t *take(const gw_camera *camera, gw_renderer *renderer) {
    gw_counters counters = {0};
    uint8_t *rgba = gw_camera_take(camera, renderer, &counters);
    assert_int_equal(counters.nan_pixels, 0);
    assert_int_equal(counters.step_cap_hits, 0);
    return rgba;
}

/* A wall of squares, coloured by chance or by turns. */
static gw_scene *checker(uint32_t squares, int by_chance) {
    gw_mesh mesh = {0};
    uint64_t random = 9;
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.9, 0.013}, (const double[]){1.8, 0, 0.2},
                     (const double[]){0, 1.8, -0.3}, squares, squares);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    assert_non_null(materials);
    for (int m = 0; m < 2; ++m)
        materials[m] = (gw_material){.base_color = {m ? 1 : 0.02f, m ? 0.9f : 0, m ? 0.1f : 0.4f, 1},
                                     .roughness = 1,
                                     .base_color_texture = -1};
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        uint32_t square = t / 2;
        scene->material_of[t] =
            by_chance ? gw_test_random(&random) < 0.04 : (square % squares + square / squares) % 2;
    }
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = 3;
    return scene;
}

/* Mean linear colours of the picture. */
static void mean_of(const uint8_t *rgba, double mean[3]) {
    for (size_t c = 0; c < 3; ++c) {
        mean[c] = 0;
        for (size_t i = 0; i < PIXELS; ++i)
            mean[c] += gw_srgb_code_to_linear(rgba[i * 4 + c]) / PIXELS;
    }
}

/* The wall fills the picture at every tau; 16 rays a pixel at tau 0 are the reference. */
static void colours_are_kept(uint32_t squares, int by_chance) {
    gw_stage stage;
    check_ok(gw_stage_open(&stage, checker(squares, by_chance), NULL,
                           (const char *const[]){"octree_depth=9", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.2, 0.1, 2.5}, (const double[]){0, 0, 0.013}, 26, SIDE);
    camera.state.samples = 4;
    uint8_t *exact = take(&camera, renderer);
    double wanted[3], most = 0;
    mean_of(exact, wanted);
    for (float tau = 1; tau <= 8; tau *= 1.4142136f) {
        double mean[3];
        camera.state.tau_inside = 4 * tau;
        uint8_t *coarse = take(&camera, renderer);
        mean_of(coarse, mean);
        for (int c = 0; c < 3; ++c)
            most = fmax(
                most, fabs((double)gw_srgb_code_from_linear(mean[c]) - gw_srgb_code_from_linear(wanted[c])));
        free(coarse);
    }
    print_message("checker of %u squares%s: mean colour off by %.0f codes at most\n", squares,
                  by_chance ? " by chance" : "", most);
    assert_true(most <= 1);
    free(exact);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void checkers_keep_their_colour_at_every_level(void **state) {
    (void)state;
    colours_are_kept(40, 0);
    colours_are_kept(220, 0);
    colours_are_kept(160, 1);
}

/* Waves lit by a light that grazes them: tau moved in small steps through the levels moves no pixel at once.
 */
static void levels_hand_over_at_grazing_light(void **state) {
    enum { STEPS = 24 };
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.9, 0}, (const double[]){1.8, 0, 0},
                     (const double[]){0, 1.8, 0}, 120, 120);
    for (size_t i = 0; i < mesh.point_count; ++i)
        mesh.points[i * 3 + 2] += 0.02 * sin(14 * mesh.points[i * 3]) * cos(11 * mesh.points[i * 3 + 1]);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_light *light = calloc(1, sizeof *light);
    assert_non_null(light);
    *light = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.98, 0.1, -0.15}, .color = {9, 9, 9}};
    scene->lights = light;
    scene->light_count = 1;
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = 0;
    gw_stage stage;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.2, 0.1, 2.5}, (const double[]){0, 0, 0}, 26, SIDE);
    double most[2] = {0, 0}, all[2] = {0, 0};
    for (int stepped = 0; stepped < 2; ++stepped) {
        uint8_t *before = NULL;
        camera.state.level_blend = camera.state.leaf_blend = !stepped;
        for (int i = 0; i <= STEPS; ++i) {
            camera.state.tau_inside = (float)(0.4 * pow(2, 4.0 * i / STEPS));
            uint8_t *now = take(&camera, renderer);
            double step = before ? gw_mean_difference(before, now, PIXELS) : 0;
            most[stepped] = fmax(most[stepped], step);
            all[stepped] += step / STEPS;
            free(before);
            before = now;
        }
        free(before);
    }
    print_message(
        "grazing light: steps of %.2f/255, the largest %.2f; without blending %.2f, the largest %.2f\n",
        all[0], most[0], all[1], most[1]);
    assert_true(most[0] < 3.5 * all[0]);
    assert_true(most[1] > 2.5 * most[0] && most[1] > 6 * all[1]); /* the naive variant pops */
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static gw_stage ball;
static gw_renderer *ball_renderer;
static gw_camera front;

static int open_ball(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.8, 0.2, 120, 80);
    check_ok(gw_stage_open(&ball, gw_mesh_take(&mesh), NULL,
                           (const char *const[]){"octree_depth=8", "tau=6", NULL}, &error));
    ball_renderer = gw_stage_renderer(&ball);
    gw_camera_look(&front, &ball, (const double[]){0.1, 0.2, 3}, (const double[]){0, 0, 0}, 40, SIDE);
    return 0;
}

static int close_ball(void **state) {
    (void)state;
    gw_renderer_destroy(&ball_renderer);
    gw_stage_close(&ball);
    return 0;
}

/* Where the camera at a still place is sharp, no matter where its gaze lies on seams of blocks and tiles. */
static void gazes_on_seams_are_sharp_on_both_sides(void **state) {
    static const double seams[][2] = {{24, 24}, {8, 24}, {24, 8.0001}, {23.9999, 31.9999}};
    (void)state;
    uint8_t *sharp = take(&front, ball_renderer);
    double per_degree = SIDE / 40.0;
    for (size_t s = 0; s < sizeof seams / sizeof seams[0]; ++s) {
        gw_camera gazed = front;
        gw_camera_gaze(&gazed, seams[s][0], seams[s][1], 5);
        uint8_t *rgba = take(&gazed, ball_renderer);
        for (int y = 0; y < SIDE; ++y)
            for (int x = 0; x < SIDE; ++x)
                if (hypot(x + 0.5 - seams[s][0], y + 0.5 - seams[s][1]) < 3.5 * per_degree)
                    assert_memory_equal(rgba + (y * SIDE + x) * 4, sharp + (y * SIDE + x) * 4, 4);
        free(rgba);
    }
    free(sharp);
}

/* Two gazes: what either makes sharp is sharp; what is no number is nobody's. */
static void two_gazes_are_the_union(void **state) {
    (void)state;
    gw_camera left = front, right = front, both = front, odd;
    gw_camera_gaze(&left, 12, 20, 4);
    gw_camera_gaze(&right, 36, 30, 4);
    both.state = left.state;
    both.state.gazes[1] = right.state.gazes[0];
    both.state.gaze_count = 2;
    uint8_t *sharp = take(&front, ball_renderer), *l = take(&left, ball_renderer),
            *r = take(&right, ball_renderer), *b = take(&both, ball_renderer);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x)
            if (hypot(x - 11.5, y - 19.5) < 3 || hypot(x - 35.5, y - 29.5) < 3)
                assert_memory_equal(b + (y * SIDE + x) * 4, sharp + (y * SIDE + x) * 4, 4);
    assert_true(gw_mean_difference(b, sharp, PIXELS) <= gw_mean_difference(l, sharp, PIXELS));
    assert_true(gw_mean_difference(b, sharp, PIXELS) <= gw_mean_difference(r, sharp, PIXELS));
    odd = both;
    odd.state.gazes[1].eye[0] = INFINITY;
    uint8_t *o = take(&odd, ball_renderer);
    assert_memory_equal(o, l, PIXELS * 4);
    free(sharp);
    free(l);
    free(r);
    free(b);
    free(o);
}

/* The eye comes up to the panel, stands in its plane, and behind it: pictures of numbers, whatever they show;
 * in the plane every ray runs along the panel. */
static void eyes_on_and_behind_the_panel_give_pictures(void **state) {
    static const double shares[] = {0.5, 0.9, 0.999, 1.0, 1.001, 1.5};
    (void)state;
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; ++i)
        for (int gazed = 0; gazed < 2; ++gazed) {
            gw_camera camera = front;
            if (gazed)
                gw_camera_gaze(&camera, 20, 25, 4);
            for (int k = 0; k < 3; ++k) {
                double middle = camera.plane.corner[k] +
                                SIDE / 2.0 * (camera.plane.step_x[k] + camera.plane.step_y[k]) + 0.37;
                camera.state.eye[k] += shares[i] * (middle - camera.state.eye[k]);
            }
            free(take(&camera, ball_renderer));
        }
    /* Exactly on a pixel's centre: that ray has no direction and misses. */
    gw_camera camera = front;
    for (int k = 0; k < 3; ++k)
        camera.state.eye[k] =
            camera.plane.corner[k] + 20.5 * camera.plane.step_x[k] + 20.5 * camera.plane.step_y[k];
    free(take(&camera, ball_renderer));
}

/* A panel seen from 80 to 89.9 degrees off its axis: the same pixels in pieces. */
static void panels_far_off_axis_have_no_seams(void **state) {
    static const double degrees[] = {80, 85, 89, 89.9};
    (void)state;
    for (size_t i = 0; i < sizeof degrees / sizeof degrees[0]; ++i) {
        gw_camera camera = front;
        double angle = degrees[i] * 3.14159265358979 / 180;
        /* A panel through the ball's front, turned about its left edge; the eye 0.6 m before that. */
        for (int k = 0; k < 3; ++k) {
            camera.plane.step_x[k] = (k == 0) * cos(angle) * 20 - (k == 2) * sin(angle) * 20;
            camera.plane.step_y[k] = (k == 1) * -20.0;
            camera.plane.corner[k] = (k == 0) * -100.0 + (k == 1) * 480.0 + (k == 2) * 2400.0;
            camera.state.eye[k] =
                camera.plane.corner[k] + 10 * camera.plane.step_x[k] + (k == 2) * 600 + (k == 0) * 3;
        }
        gw_camera_gaze(&camera, 10, 24, 3);
        uint8_t *whole = take(&camera, ball_renderer), *piece = calloc(PIXELS, 4);
        assert_non_null(piece);
        for (int part = 0; part < 2; ++part) {
            const gw_rectangle r = {part ? 17 : 0, 0, part ? SIDE - 17 : 17, SIDE};
            check_ok(gw_renderer_frame(ball_renderer, &camera.placement, &camera.plane, &r, &camera.state,
                                       piece, NULL, &error));
            for (uint32_t y = 0; y < SIDE; ++y)
                assert_memory_equal(piece + (size_t)y * r.width * 4,
                                    whole + ((size_t)y * SIDE + (size_t)r.x) * 4, r.width * 4);
        }
        free(piece);
        free(whole);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checkers_keep_their_colour_at_every_level),
        cmocka_unit_test(levels_hand_over_at_grazing_light),
        cmocka_unit_test_setup_teardown(gazes_on_seams_are_sharp_on_both_sides, open_ball, close_ball),
        cmocka_unit_test_setup_teardown(two_gazes_are_the_union, open_ball, close_ball),
        cmocka_unit_test_setup_teardown(eyes_on_and_behind_the_panel_give_pictures, open_ball, close_ball),
        cmocka_unit_test_setup_teardown(panels_far_off_axis_have_no_seams, open_ball, close_ball),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
