/* Voxels that stand for triangles: they converge, walls of them do not leak, cancelling normals stay visible,
 * gazes of every kind give pictures. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE };

static void a_smaller_tau_is_never_worse_and_ends_exact(void **state) {
    (void)state;
    static const float taus[] = {8.0f, 4.0f, 2.0f, 1.0f, 0.5f, 0.25f, 0.0625f, 0.0009765625f};
    gw_scene *scene = NULL;
    gw_stage stage;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera camera;
    gw_camera_look(&camera, &stage, view->eye, view->look_at, view->fov, SIDE);
    uint8_t *sharp = gw_camera_take(&camera, renderer, NULL);
    double before = INFINITY;
    for (size_t i = 0; i < sizeof taus / sizeof taus[0]; ++i) {
        gw_counters counters = {0};
        camera.state.tau_inside = taus[i];
        uint8_t *coarse = gw_camera_take(&camera, renderer, &counters);
        double error_now = gw_mean_difference(sharp, coarse, PIXELS);
        print_message("tau %-8g mean error %.3f/255\n", (double)taus[i], error_now);
        assert_true(error_now <= before * 1.05);
        assert_int_equal(counters.nan_pixels, 0);
        assert_int_equal(counters.step_cap_hits, 0);
        before = error_now;
        free(coarse);
    }
    assert_true(before == 0.0);
    free(sharp);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

/* A black, finely cut wall that is oblique to the cells, before a white background: what is bright came
 * through. With relief its points stand out and back by turns, so that the normals within a voxel disagree.
 */
static gw_scene *black_wall(double tilt, double relief) {
    gw_mesh mesh = {0};
    double c = cos(tilt), s = sin(tilt);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9 * c, -0.9, -0.9 * s}, (const double[]){1.8 * c, 0, 1.8 * s},
                     (const double[]){0, 1.8, 0}, 160, 160);
    for (size_t i = 0; i < mesh.point_count; ++i) {
        double out = (i % 161 + i / 161) % 2 ? relief : -relief;
        mesh.points[i * 3] -= out * s;
        mesh.points[i * 3 + 2] += out * c;
    }
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->materials[0].base_color[k] = 0.0f;
        scene->ambient[k] = 0.0f;
        scene->background[k] = 1.0f;
    }
    return scene;
}

/* Mean and worst share of light that comes through the wall's middle, over angles of view. */
static void leak_of(const char *shaders, double relief, double *mean, double *worst) {
    static const double tilts[] = {0.0, 0.3, 0.785398};
    double sum = 0.0;
    int count = 0;
    *worst = 0.0;
    for (size_t t = 0; t < 3; ++t) {
        gw_stage stage;
        check_ok(gw_stage_open(&stage, black_wall(tilts[t], relief), shaders,
                               (const char *const[]){"octree_depth=7", "geometry=voxels", NULL}, &error));
        gw_renderer *renderer = gw_stage_renderer(&stage);
        for (int a = 0; a < 7; ++a)
            for (int b = 0; b < 3; ++b) {
                double yaw = tilts[t] + (a - 3) * 0.4, pitch = (b - 1) * 0.5;
                const double eye[] = {3.0 * sin(-yaw) * cos(pitch), 3.0 * sin(pitch),
                                      3.0 * cos(yaw) * cos(pitch)};
                gw_camera camera;
                gw_camera_look(&camera, &stage, eye, (const double[]){0, 0, 0}, 7, SIDE);
                uint8_t *rgba = gw_camera_take(&camera, renderer, NULL);
                double through = gw_mean_linear(rgba, PIXELS);
                sum += through;
                ++count;
                *worst = through > *worst ? through : *worst;
                free(rgba);
            }
        gw_renderer_destroy(&renderer);
        gw_stage_close(&stage);
    }
    *mean = sum / count;
}

static void walls_of_voxels_do_not_leak(void **state) {
    (void)state;
    char folder[512];
    const char *naive = gw_naive_shaders(folder, "multiplying", "blend/opacity.glsl", "MULTIPLY_OPACITY");
    static const double reliefs[] = {0.0, 0.003, 0.006, 0.012};
    double naive_most = 0.0, mean[4], worst[4];
    for (size_t i = 0; i < 4; ++i) {
        double naive_mean, naive_worst;
        leak_of(NULL, reliefs[i], &mean[i], &worst[i]);
        leak_of(naive, reliefs[i], &naive_mean, &naive_worst);
        print_message(
            "relief %.3f: through the wall: mean %.4f, worst view %.4f; opacities multiplied: %.4f, %.4f\n",
            reliefs[i], mean[i], worst[i], naive_mean, naive_worst);
        naive_most = naive_mean > naive_most ? naive_mean : naive_most;
    }
    for (size_t i = 0; i < 4; ++i) {
        assert_true(mean[i] < (reliefs[i] > 0.0 ? 0.05 : 0.01));
        assert_true(worst[i] < (reliefs[i] > 0.0 ? 0.20 : 0.03));
    }
    assert_true(naive_most > 0.05);
}

/* A black floor, cut fine in every second square, seen at a grazing angle before a white background: fine
 * squares become voxels beside coarse ones that stay triangles. A ray may cross the floor in a voxel's cell
 * and go on below it into a leaf of triangles, where nothing stops it any more. */
static double light_through_floor(float flatness) {
    gw_mesh mesh = {0};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            uint32_t cuts = (i + j) % 2 ? 1 : 9;
            gw_mesh_add_grid(&mesh, (const double[]){-1 + 0.25 * i, 0.013, -1 + 0.25 * j},
                             (const double[]){0, 0, 0.25}, (const double[]){0.25, 0, 0}, cuts, cuts);
        }
    gw_scene *scene = NULL;
    gw_stage stage;
    scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->materials[0].base_color[k] = 0.0f;
        scene->ambient[k] = 0.0f;
        scene->background[k] = 1.0f;
    }
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", "tau_inside=6", NULL},
                           &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.1, 0.5, 1.9}, (const double[]){0, 0.013, 0.1}, 8,
                   SIDE);
    camera.state.voxel_flatness = flatness;
    gw_counters counters = {0};
    uint8_t *rgba = gw_camera_take(&camera, renderer, &counters);
    double through = gw_mean_linear(rgba, PIXELS);
    free(rgba);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return through;
}

static void voxels_beside_triangles_do_not_leak(void **state) {
    (void)state;
    double slabs = light_through_floor(0.95f), clouds = light_through_floor(1.2f);
    print_message("light through a floor of voxels and triangles: %.4f as slabs, %.4f as clouds\n", slabs,
                  clouds);
    assert_true(slabs < 0.005);
    assert_true(clouds > 10 * slabs && clouds > 0.01); /* the naive variant fails */
}

/* A thin plate: both sides in the same voxels, so that their normals cancel. */
static void cancelling_normals_are_neither_black_nor_lost(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    /* Moves the octree's middle plane, which would part the sides. */
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.8, 0.8, -0.5}, 0.02);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.9, 0.0501}, (const double[]){1.8, 0, 0},
                     (const double[]){0, 1.8, 0}, 90, 90);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.9, 0.0500}, (const double[]){0, 1.8, 0},
                     (const double[]){1.8, 0, 0}, 90, 90);
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = 2.0f;
    gw_stage stage;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=6", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.2, 3}, (const double[]){0, 0, 0}, 10, SIDE);
    uint8_t *sharp = gw_camera_take(&camera, renderer, NULL);
    camera.state.geometry = GW_GEOMETRY_VOXELS;
    gw_counters counters = {0};
    uint8_t *voxels = gw_camera_take(&camera, renderer, &counters);
    assert_int_equal(counters.nan_pixels, 0);
    double light = gw_mean_linear(sharp, PIXELS), voxel_light = gw_mean_linear(voxels, PIXELS);
    print_message("thin plate: %.4f as triangles, %.4f as voxels\n", light, voxel_light);
    assert_true(light > 0.1);
    assert_true(fabs(voxel_light - light) < 0.1 * light);
    free(sharp);
    free(voxels);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void gazes_of_every_kind_give_pictures(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.8, 0.2, 120, 80);
    gw_scene *scene = NULL;
    gw_stage stage;
    scene = gw_mesh_take(&mesh);
    check_ok(
        gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", "tau=6", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera plain;
    gw_camera_look(&plain, &stage, (const double[]){0.1, 0.2, 3}, (const double[]){0, 0, 0}, 40, SIDE);
    uint8_t *sharp = gw_camera_take(&plain, renderer, NULL);
    /* On a corner of blocks, off the wall, behind the viewer, straight at the edge, no ellipse at all, and
     * late. */
    const double at[][3] = {{32, 32, 5}, {-300, 20, 5}, {32, 64, 0}, {0, 0, 90}, {20.5, 40.5, 1e-6}};
    gw_counters counters = {0};
    for (size_t i = 0; i < sizeof at / sizeof at[0]; ++i) {
        gw_camera camera = plain;
        gw_camera_gaze(&camera, at[i][0], at[i][1], at[i][2]);
        uint8_t *rgba = gw_camera_take(&camera, renderer, &counters);
        assert_true(gw_mean_difference(rgba, sharp, PIXELS) < 40.0);
        if (at[i][2] == 90)
            assert_memory_equal(rgba, sharp, PIXELS * 4);
        free(rgba);
    }
    gw_camera late = plain, behind = plain, two = plain;
    gw_camera_gaze(&late, 32, 32, 5);
    late.state.gazes[0].age = 10.0f; /* widened by the limit */
    gw_camera wide = plain;
    gw_camera_gaze(&wide, 32, 32, 5.0 + (double)plain.state.gaze_growth_limit);
    uint8_t *late_picture = gw_camera_take(&late, renderer, &counters),
            *wide_picture = gw_camera_take(&wide, renderer, &counters);
    assert_memory_equal(late_picture, wide_picture, PIXELS * 4);
    gw_camera_gaze(&behind, 32, 32, 5);
    for (int k = 0; k < 3; ++k)
        behind.state.gazes[0].direction[k] *= -1.0f;
    uint8_t *behind_picture = gw_camera_take(&behind, renderer, &counters);
    assert_true(gw_mean_difference(behind_picture, sharp, PIXELS) > 0.0);
    /* Two viewers: exact wherever either looks. */
    gw_camera_gaze(&two, 20, 32, 4);
    two.state.gazes[1] = two.state.gazes[0];
    gw_camera other = plain;
    gw_camera_gaze(&other, 46, 32, 4);
    two.state.gazes[1] = other.state.gazes[0];
    two.state.gaze_count = 2;
    uint8_t *both = gw_camera_take(&two, renderer, &counters);
    for (int x = 18; x < 50; ++x)
        if (abs(x - 20) < 3 || abs(x - 46) < 3)
            assert_memory_equal(both + (32 * SIDE + x) * 4, sharp + (32 * SIDE + x) * 4, 4);
    assert_int_equal(counters.nan_pixels, 0);
    assert_int_equal(counters.step_cap_hits, 0);
    free(both);
    free(behind_picture);
    free(late_picture);
    free(wide_picture);
    free(sharp);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_smaller_tau_is_never_worse_and_ends_exact),
        cmocka_unit_test(walls_of_voxels_do_not_leak),
        cmocka_unit_test(voxels_beside_triangles_do_not_leak),
        cmocka_unit_test(cancelling_normals_are_neither_black_nor_lost),
        cmocka_unit_test(gazes_of_every_kind_give_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
