/* "A teapot in a stadium": 70,000 triangles inside one octree cell at the depth limit. The plain list costs a
 * ray all of them; with boxes over the list a ray tests a bounded number, and finds the same hits to the last
 * bit. */
#include "tests/support/check.h"

#include "build/octree_internal.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { AROUND = 266, RINGS = 134, RAYS = 768 };

/* In scene metres; the octree's root is 2 m wide, so a cell of level 9 is 1/256 m wide; this is a cell's
 * middle. */
static const double centre[3] = {333.5 / 256 - 1, 308.5 / 256 - 1, 151.5 / 256 - 1};
static const double radius = 0.00165;

static gw_stage dense, plain;

/* A bumpy sphere inside one cell of level 9, among the walls of a room. */
static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    const double low[3] = {-0.99, -0.99, -0.99}, high[3] = {0.99, 0.99, 0.99};
    const double x[3] = {1.98, 0, 0}, y[3] = {0, 1.98, 0}, z[3] = {0, 0, 1.98};
    const double minus_x[3] = {-1.98, 0, 0}, minus_y[3] = {0, -1.98, 0}, minus_z[3] = {0, 0, -1.98};
    gw_mesh_add_grid(&mesh, low, x, y, 7, 7);
    gw_mesh_add_grid(&mesh, low, z, x, 7, 7);
    gw_mesh_add_grid(&mesh, high, minus_y, minus_z, 7, 7);
    gw_mesh_add_grid(&mesh, high, minus_x, minus_y, 7, 7);
    gw_mesh_add_sphere(&mesh, centre, radius, 0.08, AROUND, RINGS);
    return gw_mesh_take(&mesh);
}

static int open_stages(void **state) {
    (void)state;
    check_ok(
        gw_stage_open(&dense, make_scene(), NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    check_ok(gw_stage_open(&plain, make_scene(), NULL,
                           (const char *const[]){"octree_depth=9", "dense_leaf=0", NULL}, &error));
    return 0;
}

static int close_stages(void **state) {
    (void)state;
    gw_stage_close(&dense);
    gw_stage_close(&plain);
    return 0;
}

static void to_rebased(const double metres[3], float out[3]) {
    for (int k = 0; k < 3; ++k)
        out[k] = (float)ldexp(metres[k] - dense.scene->centre[k], -dense.scene->exponent);
}

/* Rays of kind i mod 4: from the room to the sphere's neighbourhood; along an axis; from a vertex to a
 * vertex, in floats exactly; from inside the sphere. */
static void make_rays(gw_ray *rays) {
    uint64_t random = 11;
    const gw_scene *scene = dense.scene;
    for (int i = 0; i < RAYS; ++i) {
        double from[3], to[3];
        for (int k = 0; k < 3; ++k) {
            from[k] = i % 4 == 3 ? centre[k] + 0.3 * radius * (gw_test_random(&random) - 0.5)
                                 : 1.8 * (gw_test_random(&random) - 0.5);
            to[k] = centre[k] + 2.2 * radius * (gw_test_random(&random) - 0.5);
        }
        if (i % 4 == 1)
            for (int k = 0; k < 3; ++k)
                from[k] = k == i / 4 % 3 ? from[k] : to[k];
        to_rebased(from, rays[i].origin);
        to_rebased(to, rays[i].direction);
        if (i % 4 == 2) {
            uint32_t a = (uint32_t)(gw_test_random(&random) * scene->vertex_count);
            uint32_t b = (uint32_t)(gw_test_random(&random) * scene->vertex_count);
            memcpy(rays[i].origin, scene->positions + (size_t)a * 3, 3 * sizeof(float));
            memcpy(rays[i].direction, scene->positions + (size_t)b * 3, 3 * sizeof(float));
        }
        for (int k = 0; k < 3; ++k)
            rays[i].direction[k] -= rays[i].origin[k];
        if (i % 4 == 1)
            for (int k = 0; k < 3; ++k)
                rays[i].direction[k] = k == i / 4 % 3 ? rays[i].direction[k] : 0.0f;
        rays[i].minimum = 0;
        rays[i].maximum = i % 8 == 0 ? 1.0f : INFINITY;
    }
}

static void trace(const gw_stage *stage, uint32_t budget, gw_trace_method method, const gw_ray *rays,
                  gw_hit *hits, gw_counters *counters) {
    gw_renderer *renderer = NULL;
    gw_renderer_options options = {.loop_budget = budget, .count = 1};
    check_ok(gw_renderer_create(stage->device, stage->scene, stage->octree, &options, &renderer, &error));
    check_ok(gw_renderer_trace(renderer, method, rays, RAYS, hits, counters, &error));
    gw_renderer_destroy(&renderer);
}

static gw_ray rays[RAYS];
static gw_hit with_boxes[RAYS], with_list[RAYS], by_force[RAYS];

static void one_cell_holds_them_all(void **state) {
    (void)state;
    assert_int_equal(dense.octree->statistics.dense_leaves, 1);
    assert_true(dense.octree->statistics.longest_list >= 70000);
    assert_int_equal(dense.octree->box_count, gw_octree_boxes_of(dense.octree->statistics.longest_list, 64));
    assert_int_equal(plain.octree->box_count, 0);
    check_ok(gw_octree_validate(dense.device, dense.scene, dense.octree, &error));
}

static void boxes_bound_the_tests_of_a_ray(void **state) {
    (void)state;
    gw_counters few = {0}, many = {0};
    make_rays(rays);
    trace(&dense, 0, GW_TRACE_OCTREE, rays, with_boxes, &few);
    trace(&plain, 0, GW_TRACE_OCTREE, rays, with_list, &many);
    assert_memory_equal(with_boxes, with_list, sizeof with_list);
    size_t hits = 0;
    for (size_t i = 0; i < RAYS; ++i)
        hits += with_list[i].triangle != GW_NO_TRIANGLE;
    assert_true(hits > RAYS / 2);
    print_message("a ray: %.1f tests and %.1f steps with boxes, %.0f tests with the list\n",
                  (double)few.triangle_tests / RAYS, (double)few.steps / RAYS,
                  (double)many.triangle_tests / RAYS);
    assert_true(few.triangle_tests < (uint64_t)RAYS * 60);
    assert_true(few.steps < (uint64_t)RAYS * 200);
    assert_true(many.triangle_tests > (uint64_t)RAYS * 20000);
    assert_int_equal(few.step_cap_hits + many.step_cap_hits, 0);
}

static void hits_are_those_of_brute_force(void **state) {
    (void)state;
    make_rays(rays);
    trace(&dense, 0, GW_TRACE_OCTREE, rays, with_boxes, &(gw_counters){0});
    trace(&dense, 0, GW_TRACE_BRUTE_FORCE, rays, by_force, &(gw_counters){0});
    for (size_t i = 0; i < RAYS; ++i)
        if (memcmp(&with_boxes[i], &by_force[i], sizeof by_force[i]) != 0)
            fail_msg("ray %zu: t %.9g triangle %u, by force %.9g and %u", i, (double)with_boxes[i].t,
                     with_boxes[i].triangle, (double)by_force[i].t, by_force[i].triangle);
}

/* Some hit where there is one, after fewer tests; the end of a list that was left early is not its boxes'. */
static void any_hit_leaves_lists_early(void **state) {
    (void)state;
    gw_counters nearest = {0}, any = {0};
    make_rays(rays);
    trace(&dense, 0, GW_TRACE_OCTREE, rays, with_list, &nearest);
    trace(&dense, 0, GW_TRACE_ANY, rays, with_boxes, &any);
    for (size_t i = 0; i < RAYS; ++i)
        assert_int_equal(with_boxes[i].triangle == GW_NO_TRIANGLE, with_list[i].triangle == GW_NO_TRIANGLE);
    assert_true(any.triangle_tests < nearest.triangle_tests && any.steps < nearest.steps);
    trace(&dense, 41, GW_TRACE_ANY, rays, with_list, &any);
    assert_memory_equal(with_boxes, with_list, sizeof with_list);
}

/* Suspended between any two boxes or triangles, a ray ends where it would have. */
static void suspended_rays_go_on(void **state) {
    (void)state;
    gw_counters counters = {0};
    make_rays(rays);
    trace(&dense, 0, GW_TRACE_OCTREE, rays, with_boxes, &(gw_counters){0});
    trace(&dense, 41, GW_TRACE_OCTREE, rays, with_list, &counters);
    assert_true(counters.resumed > RAYS);
    assert_memory_equal(with_boxes, with_list, sizeof with_list);
}

static void pictures_are_the_same(void **state) {
    (void)state;
    enum { SIDE = 40 };
    static uint8_t first[SIDE * SIDE * 4], second[SIDE * SIDE * 4];
    const float taus[] = {0.0f, 0.02f};
    gw_camera camera;
    const double eye[3] = {centre[0] + 0.006, centre[1] + 0.004, centre[2] + 0.01};
    gw_camera_look(&camera, &dense, eye, centre, 25, SIDE);
    for (int i = 0; i < 2; ++i) {
        gw_renderer *a = NULL, *b = NULL;
        gw_counters counters = {0};
        camera.state.tau_inside = taus[i];
        check_ok(gw_renderer_create(dense.device, dense.scene, dense.octree, NULL, &a, &error));
        check_ok(gw_renderer_create(plain.device, plain.scene, plain.octree, NULL, &b, &error));
        check_ok(gw_camera_picture(&camera, a, first, &counters, &error));
        check_ok(gw_camera_picture(&camera, b, second, &counters, &error));
        assert_memory_equal(first, second, sizeof first);
        assert_int_equal(counters.step_cap_hits, 0);
        gw_renderer_destroy(&a);
        gw_renderer_destroy(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_cell_holds_them_all),       cmocka_unit_test(boxes_bound_the_tests_of_a_ray),
        cmocka_unit_test(hits_are_those_of_brute_force), cmocka_unit_test(suspended_rays_go_on),
        cmocka_unit_test(any_hit_leaves_lists_early),    cmocka_unit_test(pictures_are_the_same),
    };
    return cmocka_run_group_tests(tests, open_stages, close_stages);
}
