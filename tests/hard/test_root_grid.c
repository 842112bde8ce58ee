/* Rays that may meet voxels start at the root grid and show, to the bit, what they show from the root: also
 * where cells above the grid stand for their contents. */
#include "tests/support/check.h"

#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

enum { SIDE = 40, PIXELS = SIDE * SIDE, TAUS = 4 };

/* The last is so coarse that cells of the grid, of 1/8, stand for their contents. */
static const float taus[TAUS] = {0.25f, 1, 4, 16};

typedef struct drawn {
    uint8_t *pictures[TAUS];
    gw_counters work[TAUS];
} drawn;

static gw_scene *sunlit_ball(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0.1, 0.2, -0.1}, 0.6, 0.2, 80, 50);
    gw_mesh_add_grid(&mesh, (const double[]){-1, -0.6, -1}, (const double[]){0, 0, 2},
                     (const double[]){2, 0, 0}, 9, 9);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->lights[0] =
        (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.4, -0.8, -0.5}, .color = {2, 2, 2}};
    scene->light_count = 1;
    return scene;
}

static drawn draw(const char *shaders, gw_features forbidden) {
    drawn out = {0};
    gw_stage stage;
    gw_camera camera;
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.count = 1, .forbid_features = forbidden};
    check_ok(
        gw_stage_open(&stage, sunlit_ball(), shaders, (const char *const[]){"octree_depth=7", NULL}, &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &renderer, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.5, 2.6}, (const double[]){0, 0, 0}, 44, SIDE);
    for (int i = 0; i < TAUS; ++i) {
        camera.state.tau_inside = taus[i];
        out.pictures[i] = gw_camera_take(&camera, renderer, &out.work[i]);
    }
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return out;
}

static void finish(drawn *gone) {
    for (int i = 0; i < TAUS; ++i)
        free(gone->pictures[i]);
}

static void the_grid_shows_what_the_root_shows(void **state) {
    (void)state;
    char folder[512];
    drawn grid = draw(NULL, 0),
          root = draw(gw_naive_shaders(folder, "no-grid", "trace/stack.glsl", "NO_ROOT_GRID"), 0);
    for (int i = 0; i < TAUS; ++i) {
        print_message("# tau %g: %llu steps from the grid, %llu from the root, %llu voxels\n",
                      (double)taus[i], (unsigned long long)grid.work[i].steps,
                      (unsigned long long)root.work[i].steps, (unsigned long long)grid.work[i].voxels);
        assert_memory_equal(grid.pictures[i], root.pictures[i], PIXELS * 4);
        assert_int_equal(grid.work[i].voxels, root.work[i].voxels);
        assert_int_equal(grid.work[i].triangle_tests, root.work[i].triangle_tests);
        assert_int_equal(grid.work[i].step_cap_hits, 0);
    }
    assert_true(grid.work[1].steps * 10 < root.work[1].steps * 9);
    finish(&grid);
    finish(&root);
}

/* The naive rule, every ray from the grid, passes cells by that stand for their contents. */
static void not_every_ray_may_start_there(void **state) {
    (void)state;
    char folder[512];
    drawn all = draw(gw_naive_shaders(folder, "all-from-grid", "trace/grid.glsl", "ALWAYS_FROM_GRID"),
                     GW_FEATURE_SHADOWS),
          some = draw(NULL, GW_FEATURE_SHADOWS);
    assert_memory_equal(all.pictures[0], some.pictures[0], PIXELS * 4);
    const double wrong = gw_mean_difference(all.pictures[TAUS - 1], some.pictures[TAUS - 1], PIXELS);
    print_message("# every ray from the grid at tau %g: off by %.1f/255\n", (double)taus[TAUS - 1], wrong);
    assert_true(wrong > 1);
    finish(&all);
    finish(&some);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_grid_shows_what_the_root_shows),
        cmocka_unit_test(not_every_ray_may_start_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
