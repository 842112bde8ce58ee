/* Error falls with tau: pictures of 16 rays a pixel, whose aliasing is small, against the same of exact
 * triangles; root mean square in linear light, and FLIP behind the acuity of a viewer. The exact picture is
 * reached to the bit, and the mean colour is kept on the way. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/demo_scene.h"
#include "build/import.h"
#include "render/acuity_filter.h"
#include "render/flip.h"
#include "render/frame_block.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <unistd.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE };

/* Of a pixel's footprint; its 16 rays have a quarter of it. */
static const float taus[] = {8, 4, 2, 1, 0.5f, 0.25f, 0.125f, 0.0625f, 0};
enum { TAUS = sizeof taus / sizeof taus[0], RAYS_FACTOR = 4 };

static double rms_error(const uint8_t *a, const uint8_t *b) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        double d = i % 4 == 3 ? 0 : gw_srgb_code_to_linear(a[i]) - gw_srgb_code_to_linear(b[i]);
        sum += d * d;
    }
    return sqrt(sum / (PIXELS * 3));
}

/* In 1/255 of the sRGB scale: the largest of the channels. */
static double mean_colour_error(const uint8_t *a, const uint8_t *b) {
    double most = 0;
    for (size_t c = 0; c < 3; ++c) {
        double sums[2] = {0, 0};
        for (size_t i = 0; i < PIXELS; ++i) {
            sums[0] += gw_srgb_code_to_linear(a[i * 4 + c]);
            sums[1] += gw_srgb_code_to_linear(b[i * 4 + c]);
        }
        double error = 255 * (pow(sums[0] / PIXELS, 1 / 2.4) - pow(sums[1] / PIXELS, 1 / 2.4)) * 1.055;
        most = fabs(error) > fabs(most) ? error : most;
    }
    return most;
}

/* FLIP of what somebody sees who looks at the picture's middle, 30 pixels a degree. */
static double seen_error(const gw_stage *stage, const gw_camera *camera, const uint8_t *a, const uint8_t *b) {
    gw_camera viewer = *camera;
    gw_camera_gaze(&viewer, SIDE / 2.0, SIDE / 2.0, 1);
    gw_frame_block block;
    check_ok(gw_frame_block_fill(stage->scene, stage->octree, &viewer.placement, &viewer.plane, &viewer.state,
                                 &block, NULL, &error));
    gw_image filtered[2];
    const uint8_t *pictures[2] = {a, b};
    for (int i = 0; i < 2; ++i) {
        gw_image picture;
        check_ok(gw_image_create(SIDE, SIDE, &picture, &error));
        memcpy(picture.rgba, pictures[i], PIXELS * 4);
        check_ok(gw_acuity_filter(&picture, &block, &filtered[i], &error));
        gw_image_finish(&picture);
    }
    double seen = 0;
    check_ok(gw_flip(&filtered[0], &filtered[1], 30, NULL, &seen, &error));
    gw_image_finish(&filtered[0]);
    gw_image_finish(&filtered[1]);
    return seen;
}

/* Errors along the taus; the mean colour may be off by so much up to tau 1. */
static void error_falls(const char *name, gw_scene *scene, const gw_viewpoint *view, const char *depth,
                        double mean_limit) {
    gw_stage stage;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){depth, "samples=16", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, view->eye, view->look_at, view->fov, SIDE);
    uint8_t *exact = gw_camera_take(&camera, renderer, NULL);
    double before = INFINITY, seen_before = INFINITY;
    for (int i = 0; i < TAUS; ++i) {
        camera.state.tau_inside = taus[i] * RAYS_FACTOR;
        uint8_t *coarse = gw_camera_take(&camera, renderer, NULL);
        double rms = rms_error(coarse, exact), seen = seen_error(&stage, &camera, coarse, exact),
               mean = mean_colour_error(coarse, exact);
        print_message("%s, tau %-6g rms %.4f, seen FLIP %.4f, mean colour %+.2f/255\n", name, (double)taus[i],
                      rms, seen, mean);
        assert_true(rms <= before * 1.05 + 1e-5);
        assert_true(seen <= seen_before * 1.05 + 1e-5);
        assert_true(taus[i] > 1 || fabs(mean) <= mean_limit);
        before = rms;
        seen_before = seen;
        free(coarse);
    }
    assert_true(before == 0);
    free(exact);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void demo(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    gw_viewpoint view = scene->viewpoints[0];
    error_falls("demo", scene, &view, "octree_depth=10", 1.6);
}

/* Leaves of one side each, at random in a cube. */
static void foliage(void **state) {
    gw_mesh mesh = {0};
    uint64_t random = 11;
    (void)state;
    for (int i = 0; i < 6000; ++i) {
        double at[3], u[3], v[3];
        for (int k = 0; k < 3; ++k)
            at[k] = 2 * gw_test_random(&random) - 1;
        for (int k = 0; k < 3; ++k)
            u[k] = 0.06 * (gw_test_random(&random) - 0.5);
        for (int k = 0; k < 3; ++k)
            v[k] = 0.06 * (gw_test_random(&random) - 0.5);
        gw_mesh_add_grid(&mesh, at, u, v, 1, 1);
    }
    const gw_viewpoint view = {"", {0.4, 0.3, 5}, {0, 0, 0}, {0, 1, 0}, 26};
    error_falls("foliage", gw_mesh_take(&mesh), &view, "octree_depth=9", 1.0);
}

static void bumpy_ball(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.8, 0.2, 240, 120);
    const gw_viewpoint view = {"", {0.4, 0.3, 3}, {0, 0, 0}, {0, 1, 0}, 36};
    error_falls("bumpy ball", gw_mesh_take(&mesh), &view, "octree_depth=9", 1.0);
}

/* A tree that tests/scenes.sh fetches. */
static void maple(void **state) {
    const char *folder = getenv("GAZEWALL_SCENES"), *program = getenv("GAZEWALL");
    gw_import_options options = {.program = program ? program : "out/gazewall"};
    gw_scene *scene = NULL;
    char path[1024];
    (void)state;
    snprintf(path, sizeof path, "%s/furniture/Scopia/scopia/japaneseMaple/japaneseMaple.obj",
             folder ? folder : "out/scenes");
    if (access(path, R_OK) != 0) {
        print_message("%s was not fetched (tests/scenes.sh)\n", path);
        skip();
    }
    check_ok(gw_import(path, &options, &scene, &error));
    gw_viewpoint view = {"", {0}, {0}, {0, 1, 0}, 40};
    double size = ldexp(1, scene->exponent);
    for (int k = 0; k < 3; ++k) {
        view.look_at[k] = scene->centre[k];
        view.eye[k] = scene->centre[k] + (const double[]){0.5, 0.3, 1.8}[k] * size;
        scene->ambient[k] = 2;
    }
    error_falls("maple", scene, &view, "octree_depth=10", 2.8); /* voxels of leaves are too dense */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(demo),
        cmocka_unit_test(foliage),
        cmocka_unit_test(bumpy_ball),
        cmocka_unit_test(maple),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
