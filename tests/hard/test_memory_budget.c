/* The memory budget: trees that keep it, lose nothing, and are better than trees cut at a lower depth. */
#include "tests/support/check.h"

#include "build/octree_budget.h"
#include "build/octree_part.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

enum { SIDE = 96, BUDGETS = 3 };
static const double shares[BUDGETS] = {1.0 / 2, 1.0 / 4, 1.0 / 16};

static gw_stage stage;

/* A finely bumped ball, a coarse one and a speck over a floor: detail is where little of the room is. */
static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, -0.6, -1}, (const double[]){0, 0, 2},
                     (const double[]){2, 0, 0}, 24, 24);
    gw_mesh_add_sphere(&mesh, (const double[]){-0.3, -0.1, 0.1}, 0.35, 0.2, 120, 60);
    gw_mesh_add_sphere(&mesh, (const double[]){0.55, -0.2, -0.2}, 0.3, 0.1, 30, 16);
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.3, 0.6, 0.4}, 0.002);
    return gw_mesh_take(&mesh);
}

static int open_stage(void **state) {
    (void)state;
    check_ok(gw_stage_open(&stage, make_scene(), NULL,
                           (const char *const[]){"octree_depth=10", "dense_leaf=0", NULL}, &error));
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_stage_close(&stage);
    return 0;
}

static gw_octree *build(double mebibytes, int depth, uint64_t part_limit, uint64_t texel_limit) {
    gw_settings settings = stage.settings;
    gw_octree_options options = {.settings = &settings, .part_limit = part_limit, .texel_limit = texel_limit};
    gw_octree *octree = NULL;
    settings.octree_memory = mebibytes;
    settings.octree_depth = depth;
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &octree, &error));
    return octree;
}

static double full_mebibytes(void) {
    return (double)gw_octree_bytes(stage.octree) / 1048576.0;
}

static uint64_t triangle_tests(const gw_octree *octree, uint8_t *rgba) {
    gw_renderer *renderer = NULL;
    gw_counters counters = {0};
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.4, 0.5, 2.2}, (const double[]){0, -0.2, 0}, 55, SIDE);
    check_ok(gw_renderer_create(stage.device, stage.scene, octree, &(gw_renderer_options){.count = 1},
                                &renderer, &error));
    check_ok(gw_camera_picture(&camera, renderer, rgba, &counters, &error));
    gw_renderer_destroy(&renderer);
    return counters.triangle_tests;
}

/* Within the budget, close to it, the same picture, and counted; the naive rule - the deepest limit whose
 * tree keeps the budget - needs more tests. */
static void budgets_are_kept_and_well_spent(void **state) {
    static uint8_t wanted[SIDE * SIDE * 4], got[SIDE * SIDE * 4];
    (void)state;
    const uint64_t full_tests = triangle_tests(stage.octree, wanted);
    assert_int_equal(stage.octree->statistics.stopped_budget, 0);
    for (int i = 0; i < BUDGETS; ++i) {
        const double budget = full_mebibytes() * shares[i];
        gw_octree *octree = build(budget, 10, 0, 0), *naive = NULL;
        assert_true((double)gw_octree_bytes(octree) <= budget * 1048576.0);
        assert_true((double)gw_octree_bytes(octree) >= 0.85 * budget * 1048576.0);
        assert_true(octree->statistics.stopped_budget > 0 && octree->statistics.least_gain > 0);
        check_ok(gw_octree_validate(stage.device, stage.scene, octree, &error));
        const uint64_t tests = triangle_tests(octree, got);
        assert_memory_equal(got, wanted, sizeof got);
        for (int depth = 9; !naive || gw_octree_bytes(naive) > gw_octree_bytes(octree); --depth) {
            gw_octree_destroy(&naive);
            naive = build(0, depth, 0, 0);
        }
        const uint64_t naive_tests = triangle_tests(naive, got);
        assert_memory_equal(got, wanted, sizeof got);
        print_message("%.3f of %.2f MiB: %.2f tests a ray (all of it %.2f); depth %u, %.3f of it: %.2f\n",
                      shares[i], full_mebibytes(), (double)tests / (SIDE * SIDE),
                      (double)full_tests / (SIDE * SIDE), naive->depth,
                      (double)gw_octree_bytes(naive) / (double)gw_octree_bytes(stage.octree),
                      (double)naive_tests / (SIDE * SIDE));
        assert_true(naive_tests > tests);
        gw_octree_destroy(&octree);
        gw_octree_destroy(&naive);
    }
}

static void parts_do_not_show(void **state) {
    (void)state;
    const double budget = full_mebibytes() / 4;
    gw_octree *whole = build(budget, 10, 0, 0),
              *parts = build(budget, 10, (uint64_t)stage.scene->triangle_count * 3 / 2, 0);
    assert_true(parts->statistics.parts > 1);
    assert_true(gw_hash_equal(whole->hash, parts->hash));
    assert_int_equal(whole->statistics.least_gain, parts->statistics.least_gain);
    assert_int_equal(whole->statistics.stopped_budget, parts->statistics.stopped_budget);
    gw_octree_destroy(&whole);
    gw_octree_destroy(&parts);
}

static void a_budget_that_holds_all_changes_nothing(void **state) {
    (void)state;
    gw_octree *octree = build(full_mebibytes() * 1.0001, 10, 0, 0);
    assert_true(gw_hash_equal(octree->hash, stage.octree->hash));
    assert_int_equal(octree->statistics.least_gain, 0);
    gw_octree_destroy(&octree);
}

/* What a driver cannot address used to be an error. */
static void a_drivers_limit_is_a_budget(void **state) {
    (void)state;
    const uint64_t most = stage.octree->node_count / 3;
    gw_octree *octree = build(0, 10, 0, most);
    assert_true(octree->node_count <= most && octree->reference_count <= most &&
                octree->box_count * 2 <= most);
    assert_true(octree->statistics.stopped_budget > 0);
    check_ok(gw_octree_validate(stage.device, stage.scene, octree, &error));
    gw_octree_destroy(&octree);
}

static void a_budget_for_nothing_is_refused_with_numbers(void **state) {
    (void)state;
    gw_settings settings = stage.settings;
    gw_octree_options options = {.settings = &settings};
    gw_octree *octree = NULL;
    settings.octree_memory = 0.01;
    check_fails(gw_octree_build(stage.device, stage.scene, &options, &octree, &error), GW_MACHINE,
                "octree_memory allows 0.01");
    assert_null(octree);
}

/* Boxes over long lists are as dear as four lists: they are for leaves that have the gain. */
static void boxes_keep_the_budget_too(void **state) {
    (void)state;
    gw_settings settings = stage.settings;
    gw_octree_options options = {.settings = &settings};
    gw_octree *octree = NULL;
    settings.dense_leaf = 64;
    settings.octree_memory = full_mebibytes() / 16;
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &octree, &error));
    assert_true((double)gw_octree_bytes(octree) <= settings.octree_memory * 1048576.0);
    assert_true(octree->statistics.longest_list > 64);
    gw_octree_destroy(&octree);
    settings.octree_depth = 5; /* long lists at the depth limit: some keep their boxes, some do not */
    settings.octree_memory = 0;
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &octree, &error));
    const uint64_t bytes = gw_octree_bytes(octree), leaves = octree->statistics.dense_leaves;
    gw_octree_destroy(&octree);
    settings.octree_memory = 0.8 * (double)bytes / 1048576.0;
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &octree, &error));
    assert_true(gw_octree_bytes(octree) <= bytes * 8 / 10 && gw_octree_bytes(octree) > bytes * 6 / 10);
    assert_true(octree->statistics.dense_leaves > 0 && octree->statistics.dense_leaves < leaves);
    gw_octree_destroy(&octree);
}

/* Three builders notice together what none of them can know alone. */
static void parts_of_several_builders_tell_whether_they_fit(void **state) {
    (void)state;
    gw_settings settings = stage.settings;
    gw_octree_options options = {.settings = &settings};
    gw_octree_division division;
    gw_octree_part parts[3];
    gw_octree *whole = NULL;
    settings.dense_leaf = 64; /* boxes of several parts count as well */
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &whole, &error));
    const double full = (double)gw_octree_bytes(whole) / 1048576.0, budgets[] = {1.0001, 0.9999, 0.25};
    assert_true(whole->box_count > 0);
    gw_octree_destroy(&whole);
    for (int tight = 0; tight < 3; ++tight) {
        settings.octree_memory = full * budgets[tight];
        check_ok(gw_octree_divide(stage.scene, &settings, 3, &division, &error));
        for (uint32_t p = 0; p < 3; ++p)
            check_ok(
                gw_octree_build_part(stage.device, stage.scene, &options, &division, p, &parts[p], &error));
        assert_int_equal(gw_octree_parts_fit(stage.device, stage.scene, &options, parts, 3), tight == 0);
        for (uint32_t p = 0; p < 3; ++p)
            free(parts[p].data);
    }
}

/* A child always gains less than its parent, and what a level needs for a gain is exact. */
static void gains_make_trees(void **state) {
    (void)state;
    uint64_t random = 3;
    for (int i = 0; i < 1000; ++i) {
        const uint32_t level = 1 + (uint32_t)(gw_test_random(&random) * 14);
        const uint32_t pairs = 1 + (uint32_t)(gw_test_random(&random) * 1e6);
        const uint64_t gain = gw_octree_gain(level, pairs);
        assert_true(level == 15 || gw_octree_gain(level + 1, pairs) < gain);
        assert_int_equal(gw_octree_least_pairs(gain, level), pairs);
        assert_int_equal(gw_octree_least_pairs(gain + 1, level), pairs + 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(budgets_are_kept_and_well_spent),
        cmocka_unit_test(parts_do_not_show),
        cmocka_unit_test(a_budget_that_holds_all_changes_nothing),
        cmocka_unit_test(a_drivers_limit_is_a_budget),
        cmocka_unit_test(a_budget_for_nothing_is_refused_with_numbers),
        cmocka_unit_test(boxes_keep_the_budget_too),
        cmocka_unit_test(parts_of_several_builders_tell_whether_they_fit),
        cmocka_unit_test(gains_make_trees),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
