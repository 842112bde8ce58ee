/* 70,000 triangles in one octree cell: more than a loop of software GL may iterate before it is ended without
 * a word. Rays are suspended in time and find the last triangle of the list; with a budget above the driver's
 * limit they do not, and the loss is counted. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SHEETS = 70000, RAYS = 96 };

static gw_stage stage;
static gw_ray rays[RAYS];

/* Parallel triangles stacked along z inside one cell of level 1, and two far corners that make the cell small
 * beside the scene. */
static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    for (int i = 0; i < SHEETS; ++i) {
        double z = 0.2 + 0.4 * i / SHEETS;
        uint32_t a = gw_mesh_point(&mesh, 0.2, 0.2, z), b = gw_mesh_point(&mesh, 0.7, 0.2, z);
        gw_mesh_triangle(&mesh, a, b, gw_mesh_point(&mesh, 0.2, 0.7, z));
    }
    gw_mesh_add_tetrahedron(&mesh, (const double[]){-0.85, -0.85, -0.85}, 0.05);
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.85, 0.85, 0.85}, 0.05);
    return gw_mesh_take(&mesh);
}

static int open_stage(void **state) {
    (void)state;
    check_ok(gw_stage_open(&stage, make_scene(), NULL,
                           (const char *const[]){"octree_depth=1", "dense_leaf=0", NULL}, &error));
    assert_true(stage.octree->statistics.longest_list >= SHEETS);
    uint64_t random = 3;
    for (int i = 0; i < RAYS; ++i) {
        double at[3] = {0.22 + 0.2 * gw_test_random(&random), 0.22 + 0.2 * gw_test_random(&random), 2.0};
        for (int k = 0; k < 3; ++k)
            rays[i].origin[k] = (float)ldexp(at[k] - stage.scene->centre[k], -stage.scene->exponent);
        rays[i].direction[2] = -1.0f;
        rays[i].maximum = INFINITY;
    }
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_stage_close(&stage);
    return 0;
}

static void trace(uint32_t budget, gw_trace_method method, gw_hit *hits, gw_counters *counters) {
    gw_renderer *renderer = NULL;
    gw_renderer_options options = {.loop_budget = budget, .count = 1};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &renderer, &error));
    check_ok(gw_renderer_trace(renderer, method, rays, RAYS, hits, counters, &error));
    gw_renderer_destroy(&renderer);
}

static void long_lists_are_tested_to_their_end(void **state) {
    (void)state;
    gw_hit wanted[RAYS], got[RAYS];
    gw_counters counters = {0};
    trace(0, GW_TRACE_BRUTE_FORCE, wanted, NULL);
    trace(0, GW_TRACE_OCTREE, got, &counters);
    assert_memory_equal(wanted, got, sizeof got);
    assert_int_equal(counters.step_cap_hits, 0);
    assert_true(counters.resumed >= RAYS * (SHEETS / 4000));
    /* All of the budget is used, and the few steps from the root to the list that a resumed ray takes. */
    assert_in_range(counters.loop_iterations, 4000, 4000 + 16);
    /* The nearest sheet is the one with the largest z, which canonical order puts near the end of the list.
     */
    for (int i = 0; i < RAYS; ++i)
        assert_true(got[i].triangle != GW_NO_TRIANGLE && got[i].triangle > 65535);
}

static void pixels_come_through_long_lists_too(void **state) {
    (void)state;
    enum { SIDE = 16 };
    uint8_t pieces[SIDE * SIDE * 4], wanted[SIDE * SIDE * 4];
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.35, 0.35, 3}, (const double[]){0.35, 0.35, 0}, 4,
                   SIDE);
    for (int lod = 0; lod < 2; ++lod) {
        gw_renderer *renderer = NULL, *other = NULL;
        gw_counters counters = {0};
        camera.state.tau_inside = lod ? 0.001f : 0.0f;
        check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
        check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree,
                                    &(gw_renderer_options){.loop_budget = 1777}, &other, &error));
        check_ok(gw_camera_picture(&camera, renderer, pieces, &counters, &error));
        check_ok(gw_camera_picture(&camera, other, wanted, NULL, &error));
        assert_memory_equal(pieces, wanted, sizeof pieces);
        assert_true(counters.resumed > 0);
        assert_int_equal(counters.step_cap_hits, 0);
        assert_true(pieces[0] > 0);
        gw_renderer_destroy(&renderer);
        gw_renderer_destroy(&other);
    }
}

static void a_budget_above_the_drivers_limit_loses_hits_and_says_so(void **state) {
    (void)state;
    if (!gw_gl_limits_of(stage.device)->software) {
        print_message("this driver does not end loops\n");
        skip();
    }
    gw_hit wanted[RAYS], got[RAYS];
    gw_counters counters = {0};
    trace(0, GW_TRACE_OCTREE, wanted, NULL);
    trace(1u << 30, GW_TRACE_OCTREE, got, &counters);
    assert_memory_not_equal(wanted, got, sizeof got);
    assert_int_equal(counters.step_cap_hits, RAYS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_lists_are_tested_to_their_end),
        cmocka_unit_test(pixels_come_through_long_lists_too),
        cmocka_unit_test(a_budget_above_the_drivers_limit_loses_hits_and_says_so),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
