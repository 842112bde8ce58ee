/* Pixels are a pure function: the same bits however a picture is split, whatever is compiled in beyond need,
 * counted or not, suspended or not. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 72, PIXELS = SIDE * SIDE };

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera exact, mixed; /* the same view: triangles only, and voxels outside a gaze */

static int open_stage(void **state) {
    (void)state;
    gw_scene *scene = NULL;
    check_ok(gw_demo_scene(&scene, &error));
    gw_crop_textures(scene, 64);
    check_ok(
        gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", "tau=3", NULL}, &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&exact, &stage, view->eye, view->look_at, view->fov, SIDE);
    mixed = exact;
    gw_camera_gaze(&mixed, 24, 40, 6.0);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static uint8_t *picture(const gw_camera *camera, gw_renderer *by, gw_counters *counters) {
    uint8_t *rgba = calloc(PIXELS, 4);
    assert_non_null(rgba);
    check_ok(gw_camera_picture(camera, by, rgba, counters, &error));
    return rgba;
}

static void expect_same(const uint8_t *a, const uint8_t *b, const char *what) {
    for (size_t i = 0; i < PIXELS; ++i)
        if (memcmp(a + i * 4, b + i * 4, 4))
            fail_msg("%s: pixel (%zu, %zu) is %d %d %d, expected %d %d %d", what, i % SIDE, i / SIDE,
                     b[i * 4], b[i * 4 + 1], b[i * 4 + 2], a[i * 4], a[i * 4 + 1], a[i * 4 + 2]);
}

static void the_picture_shows_something(void **state) {
    (void)state;
    uint8_t *sharp = picture(&exact, renderer, NULL), *coarse = picture(&mixed, renderer, NULL);
    size_t colors = 0;
    for (size_t i = 1; i < PIXELS; ++i)
        colors += memcmp(sharp + i * 4, sharp + i * 4 - 4, 4) != 0;
    assert_true(colors > PIXELS / 2);
    for (size_t i = 0; i < PIXELS; ++i)
        assert_int_equal(sharp[i * 4 + 3], 255);
    double difference = gw_mean_difference(sharp, coarse, PIXELS);
    print_message("voxels outside the gaze change pixels by %.2f/255 on average\n", difference);
    assert_true(difference > 0.1 && difference < 30.0);
    free(sharp);
    free(coarse);
}

static void inside_the_gaze_pixels_are_exact(void **state) {
    (void)state;
    uint8_t *sharp = picture(&exact, renderer, NULL), *coarse = picture(&mixed, renderer, NULL);
    /* A disc well inside the 6 degrees: the view's pixels are at least fov / side wide in the middle. */
    double pixels_per_degree =
        SIDE / (2.0 * tan(stage.scene->viewpoints[0].fov / 360.0 * 3.14159265) * 57.2958);
    int same = 0;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            if (hypot(x + 0.5 - 24, y + 0.5 - 40) > 4.0 * pixels_per_degree)
                continue;
            size_t i = (size_t)(y * SIDE + x) * 4;
            assert_memory_equal(sharp + i, coarse + i, 4);
            ++same;
        }
    assert_true(same > 8);
    free(sharp);
    free(coarse);
}

/* Renders the square in columns x rows pieces with uneven borders. */
static uint8_t *in_pieces(const gw_camera *camera, const int *columns, const int *rows) {
    uint8_t *rgba = calloc(PIXELS, 4), *piece = calloc(PIXELS, 4);
    assert_non_null(rgba);
    assert_non_null(piece);
    for (int j = 0; rows[j + 1] > 0; ++j)
        for (int i = 0; columns[i + 1] > 0; ++i) {
            gw_rectangle part = {columns[i], rows[j], (uint32_t)(columns[i + 1] - columns[i]),
                                 (uint32_t)(rows[j + 1] - rows[j])};
            check_ok(gw_renderer_frame(renderer, &camera->placement, &camera->plane, &part, &camera->state,
                                       piece, NULL, &error));
            for (uint32_t y = 0; y < part.height; ++y)
                memcpy(rgba + ((size_t)(rows[j] + (int)y) * SIDE + (size_t)columns[i]) * 4,
                       piece + (size_t)y * part.width * 4, (size_t)part.width * 4);
        }
    free(piece);
    return rgba;
}

static void splits_give_the_same_pixels(void **state) {
    (void)state;
    static const int splits[][2][8] = {
        {{0, 36, 72}, {0, 36, 72}}, {{0, 24, 48, 72}, {0, 72}}, {{0, 7, 50, 72}, {0, 1, 33, 71, 72}}};
    const gw_camera *cameras[] = {&exact, &mixed};
    for (int c = 0; c < 2; ++c) {
        uint8_t *whole = picture(cameras[c], renderer, NULL);
        for (size_t s = 0; s < sizeof splits / sizeof splits[0]; ++s) {
            uint8_t *parts = in_pieces(cameras[c], splits[s][0], splits[s][1]);
            expect_same(whole, parts, c ? "split with voxels" : "split");
            free(parts);
        }
        free(whole);
    }
}

static void single_pixels_and_aprons_are_those_of_the_whole(void **state) {
    (void)state;
    uint8_t *whole = picture(&mixed, renderer, NULL);
    for (int i = 0; i < 12; ++i) {
        gw_rectangle one = {(i * 31 + 5) % SIDE, (i * 47 + 3) % SIDE, 1, 1};
        uint8_t pixel[4];
        check_ok(gw_renderer_frame(renderer, &mixed.placement, &mixed.plane, &one, &mixed.state, pixel, NULL,
                                   &error));
        assert_memory_equal(pixel, whole + ((size_t)one.y * SIDE + (size_t)one.x) * 4, 4);
    }
    /* A rectangle that begins outside the square, at negative pixels. */
    gw_rectangle apron = {-13, -9, 40, 30};
    uint8_t *around = calloc(40 * 30, 4);
    assert_non_null(around);
    check_ok(gw_renderer_frame(renderer, &mixed.placement, &mixed.plane, &apron, &mixed.state, around, NULL,
                               &error));
    for (int y = 9; y < 30; ++y)
        assert_memory_equal(around + (y * 40 + 13) * 4, whole + (y - 9) * SIDE * 4, 27 * 4);
    free(around);
    free(whole);
}

static void other_renderer(const gw_renderer_options *options, const char *what, gw_counters *counters) {
    gw_renderer *other = NULL;
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, options, &other, &error));
    const gw_camera *cameras[] = {&exact, &mixed};
    for (int c = 0; c < 2; ++c) {
        uint8_t *wanted = picture(cameras[c], renderer, NULL), *got = picture(cameras[c], other, counters);
        expect_same(wanted, got, what);
        free(wanted);
        free(got);
    }
    gw_renderer_destroy(&other);
}

/* Effect by effect: test_effects.c. */
static void forcing_effects_changes_no_pixel(void **state) {
    (void)state;
    other_renderer(&(gw_renderer_options){.force_features = GW_ALL_FEATURES}, "all effects", NULL);
}

static void counting_changes_no_pixel_and_counts(void **state) {
    (void)state;
    gw_counters first = {0}, second = {0};
    other_renderer(&(gw_renderer_options){.count = 1}, "counting", &first);
    other_renderer(&(gw_renderer_options){.count = 1}, "counting again", &second);
    assert_memory_equal(&first, &second, sizeof first);
    assert_int_equal(first.rays, 2 * PIXELS);
    assert_true(first.steps > first.rays && first.node_loads > first.rays &&
                first.triangle_tests > first.rays / 2);
    assert_true(first.voxels > 0);
    assert_int_equal(first.step_cap_hits, 0);
    assert_int_equal(first.nan_pixels, 0);
}

static void suspending_rays_changes_no_pixel(void **state) {
    (void)state;
    gw_counters counters = {0};
    other_renderer(&(gw_renderer_options){.loop_budget = 32}, "short budget", &counters);
    assert_true(counters.resumed > PIXELS);
    assert_int_equal(counters.step_cap_hits, 0);
}

/* Rays that meet no voxel end in the kernel that knows none; the others go on in the one that does. */
static void two_kernels_draw_what_one_draws(void **state) {
    (void)state;
    gw_counters one = {0}, two = {0};
    other_renderer(&(gw_renderer_options){.one_kernel = 1, .loop_budget = 400}, "one kernel", &one);
    free(picture(&exact, renderer, &two));
    assert_int_equal(two.resumed, 0);
    free(picture(&mixed, renderer, &two));
    print_message("%d rays, %llu resumed\n", PIXELS, (unsigned long long)two.resumed);
    assert_true(two.resumed > PIXELS / 10);
}

static void double_edges_only_touch_exact_edges(void **state) {
    (void)state;
    gw_camera precise = exact;
    precise.state.triangle_precision = GW_PRECISION_DOUBLE;
    uint8_t *single = picture(&exact, renderer, NULL), *twice = picture(&precise, renderer, NULL);
    size_t changed = 0;
    for (size_t i = 0; i < PIXELS; ++i)
        changed += memcmp(single + i * 4, twice + i * 4, 4) != 0;
    assert_true(changed <= PIXELS / 200);
    free(single);
    free(twice);
}

static void what_is_no_number_is_refused_or_left_out(void **state) {
    (void)state;
    uint8_t *rgba = calloc(PIXELS, 4);
    gw_camera bad = exact;
    bad.state.eye[1] = NAN;
    check_fails(gw_camera_picture(&bad, renderer, rgba, NULL, &error), GW_BAD_INPUT, "eye");
    bad = exact;
    bad.plane.step_x[0] = INFINITY;
    check_fails(gw_camera_picture(&bad, renderer, rgba, NULL, &error), GW_BAD_INPUT, "plane");
    bad = exact;
    bad.state.tau = -1.0f;
    check_fails(gw_camera_picture(&bad, renderer, rgba, NULL, &error), GW_BAD_INPUT, "knob");
    gw_rectangle none = {0, 0, 0, 5};
    check_fails(
        gw_renderer_frame(renderer, &exact.placement, &exact.plane, &none, &exact.state, rgba, NULL, &error),
        GW_BAD_INPUT, "0 x 5");
    /* A gaze that is no number is nobody's gaze: everything is sharp. */
    gw_camera lost = mixed;
    lost.state.gazes[0].direction[2] = NAN;
    uint8_t *sharp = picture(&exact, renderer, NULL), *got = picture(&lost, renderer, NULL);
    expect_same(sharp, got, "gaze NaN");
    lost = mixed;
    lost.state.gazes[0].confidence = 0.0f;
    free(got);
    got = picture(&lost, renderer, NULL);
    expect_same(sharp, got, "no confidence");
    free(sharp);
    free(got);
    free(rgba);
}

static void the_report_tells_what_ran_and_why_not(void **state) {
    (void)state;
    json_t *report = json_object();
    uint8_t *rgba = picture(&mixed, renderer, NULL);
    check_ok(gw_renderer_report(renderer, NULL, report, &error));
    char *text = json_dumps(report, JSON_COMPACT);
    assert_non_null(text);
    assert_non_null(strstr(text, "\"run\":[\"textures\""));
    assert_non_null(strstr(text, "\"lod\",\"gaze\",\"sparse-samples\""));
    assert_non_null(strstr(text, "{\"name\":\"point-lights\",\"why\":\"the scene has none\"}"));
    free(text);
    json_decref(report);
    free(rgba);
}

/* Two quads across the view, the nearer (z = 0) in a material of its own, the farther red. */
static gw_scene *two_quads(gw_alpha_mode mode, float alpha) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, -1, 0}, (const double[]){2, 0, 0}, (const double[]){0, 2, 0},
                     3, 3);
    gw_mesh_add_grid(&mesh, (const double[]){-1, -1, -0.5}, (const double[]){2, 0, 0},
                     (const double[]){0, 2, 0}, 3, 3);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    assert_non_null(materials);
    materials[0] = (gw_material){.base_color = {1, 0, 0, 1}, .roughness = 1, .base_color_texture = -1};
    materials[1] = (gw_material){.base_color = {0, 1, 0, alpha},
                                 .roughness = 1,
                                 .base_color_texture = -1,
                                 .alpha_mode = mode,
                                 .alpha_cutoff = 0.5f};
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t i = 0; i < scene->triangle_count; ++i)
        scene->material_of[i] = scene->positions[scene->triangles[i][0] * 3 + 2] > 0.0f;
    return scene;
}

/* The middle pixel's red and green under light from everywhere. */
static void middle_pixel(gw_alpha_mode mode, float alpha, const char *tau_inside, uint8_t pixel[4]) {
    gw_stage quads;
    check_ok(gw_stage_open(&quads, two_quads(mode, alpha), NULL,
                           (const char *const[]){"octree_depth=5", tau_inside, NULL}, &error));
    gw_renderer *by = NULL;
    check_ok(gw_renderer_create(quads.device, quads.scene, quads.octree, NULL, &by, &error));
    gw_camera camera;
    gw_camera_look(&camera, &quads, (const double[]){0.05, 0.1, 3}, (const double[]){0, 0, 0}, 20, SIDE);
    uint8_t *rgba = picture(&camera, by, NULL);
    memcpy(pixel, rgba + (PIXELS / 2 + SIDE / 2) * 4, 4);
    free(rgba);
    gw_renderer_destroy(&by);
    gw_stage_close(&quads);
}

static void masks_cut_and_blending_blends(void **state) {
    (void)state;
    /* tau_inside 0.001 runs the kernel with voxels where none is coarse enough: the same answers. */
    const char *taus[] = {"tau_inside=0", "tau_inside=0.001"};
    for (int t = 0; t < 2; ++t) {
        uint8_t opaque[4], kept[4], cut[4], half[4];
        middle_pixel(GW_ALPHA_OPAQUE, 0.2f, taus[t], opaque);
        middle_pixel(GW_ALPHA_MASK, 0.6f, taus[t], kept);
        middle_pixel(GW_ALPHA_MASK, 0.4f, taus[t], cut);
        middle_pixel(GW_ALPHA_BLEND, 0.5f, taus[t], half);
        assert_true(opaque[1] > 100 && opaque[0] < 60);
        assert_memory_equal(opaque, kept, 4);
        assert_true(cut[0] > 100 && cut[1] < 60);
        assert_true(half[0] > 70 && half[1] > 70 && half[0] < cut[0] && half[1] < opaque[1]);
    }
}

/* Faces doubled with opposite winding, one red, one green: each viewer sees the side that faces him,
 * everywhere. */
static void doubled_faces_show_their_front(void **state) {
    (void)state;
    gw_scene *scene = NULL;
    gw_mesh mesh = {0};
    const double corner[3] = {-1, -1, 0}, right[3] = {2, 0, 0.1}, up[3] = {0, 2, 0.2};
    gw_mesh_add_grid(&mesh, corner, right, up, 5, 7);
    size_t faces = mesh.triangle_count;
    for (size_t i = 0; i < faces; ++i)
        gw_mesh_triangle(&mesh, mesh.triangles[i][0], mesh.triangles[i][2], mesh.triangles[i][1]);
    scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    assert_non_null(materials);
    for (int m = 0; m < 2; ++m)
        materials[m] =
            (gw_material){.base_color = {m == 0, m == 1, 0, 1}, .roughness = 1, .base_color_texture = -1};
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        const float *p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = scene->positions + (size_t)scene->triangles[i][k] * 3;
        float facing = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        scene->material_of[i] = facing < 0.0f;
    }
    gw_stage faced;
    gw_renderer *by = NULL;
    check_ok(gw_stage_open(&faced, scene, NULL, (const char *const[]){"octree_depth=5", "tau_inside=0", NULL},
                           &error));
    check_ok(gw_renderer_create(faced.device, faced.scene, faced.octree, NULL, &by, &error));
    for (int side = 0; side < 2; ++side) {
        gw_camera camera;
        gw_camera_look(&camera, &faced, (const double[]){0.05, 0.1, side ? -3 : 3}, (const double[]){0, 0, 0},
                       20, SIDE);
        uint8_t *rgba = picture(&camera, by, NULL);
        for (size_t i = 0; i < PIXELS; ++i)
            assert_true(rgba[i * 4 + (size_t)side] > 2 * rgba[i * 4 + 1 - (size_t)side]);
        free(rgba);
    }
    gw_renderer_destroy(&by);
    gw_stage_close(&faced);
}

/* A glowing wall gives the same light as triangles and as voxels; a wall that does not glow has no array for
 * it. */
static void voxels_emit_what_triangles_emit(void **state) {
    (void)state;
    double light[2];
    gw_scene *dark = two_quads(GW_ALPHA_OPAQUE, 1), *bright = two_quads(GW_ALPHA_OPAQUE, 1);
    for (int k = 0; k < 3; ++k) {
        bright->materials[1].emissive[k] = 0.25f * (float)(k + 1);
        bright->ambient[k] = 0;
    }
    gw_stage stages[2];
    check_ok(gw_stage_open(&stages[0], dark, NULL, (const char *const[]){"octree_depth=5", NULL}, &error));
    check_ok(gw_stage_open(&stages[1], bright, NULL, (const char *const[]){"octree_depth=5", NULL}, &error));
    assert_null(stages[0].octree->emissions);
    assert_non_null(stages[1].octree->emissions);
    gw_renderer *by = NULL;
    check_ok(gw_renderer_create(stages[1].device, stages[1].scene, stages[1].octree, NULL, &by, &error));
    gw_camera camera;
    gw_camera_look(&camera, &stages[1], (const double[]){0.05, 0.1, 3}, (const double[]){0, 0, 0}, 20, SIDE);
    for (int voxels = 0; voxels < 2; ++voxels) {
        camera.state.geometry = voxels ? GW_GEOMETRY_VOXELS : GW_GEOMETRY_TRIANGLES;
        uint8_t *rgba = picture(&camera, by, NULL);
        light[voxels] = gw_mean_linear(rgba, PIXELS);
        free(rgba);
    }
    print_message("mean light %.4f from triangles, %.4f from voxels\n", light[0], light[1]);
    assert_true(light[0] > 0.4);
    assert_true(fabs(light[1] - light[0]) < 0.01 * light[0]);
    gw_renderer_destroy(&by);
    gw_stage_close(&stages[0]);
    gw_stage_close(&stages[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_shows_something),
        cmocka_unit_test(inside_the_gaze_pixels_are_exact),
        cmocka_unit_test(splits_give_the_same_pixels),
        cmocka_unit_test(single_pixels_and_aprons_are_those_of_the_whole),
        cmocka_unit_test(forcing_effects_changes_no_pixel),
        cmocka_unit_test(counting_changes_no_pixel_and_counts),
        cmocka_unit_test(suspending_rays_changes_no_pixel),
        cmocka_unit_test(two_kernels_draw_what_one_draws),
        cmocka_unit_test(double_edges_only_touch_exact_edges),
        cmocka_unit_test(what_is_no_number_is_refused_or_left_out),
        cmocka_unit_test(the_report_tells_what_ran_and_why_not),
        cmocka_unit_test(masks_cut_and_blending_blends),
        cmocka_unit_test(doubled_faces_show_their_front),
        cmocka_unit_test(voxels_emit_what_triangles_emit),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
