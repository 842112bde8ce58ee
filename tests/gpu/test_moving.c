/* Rebuilds: an octree built again for a pose has the bytes of one built anew, pictures are those of the pose,
 * and nothing is allocated on the GPU once every pose has been seen. The scene is configs/scenes/moving.gltf,
 * through the real import child ($GAZEWALL). */
#include "tests/support/check.h"

#include "build/animation.h"
#include "build/import.h"
#include "build/scene_pose.h"
#include "tests/support/renders.h"

static const char *const depth[] = {"octree_depth=8", "dense_leaf=2", NULL};
static const int64_t second = 1000000000;
/* Forward and back, over the loop's end, and twice in a row the same. */
static const double times[] = {0, 0.5, 1.25, 3.75, 1.25, 0.5, 0.5, 0, 4.5, 2};
enum { TIMES = sizeof times / sizeof *times, SIDE = 96 };

static gw_scene *import(void) {
    const char *program = getenv("GAZEWALL");
    gw_scene *scene = NULL;
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    check_ok(gw_import("configs/scenes/moving.gltf", &options, &scene, &error));
    assert_non_null(scene->animation);
    return scene;
}

static int64_t time_of(int i) {
    return (int64_t)(times[i] * (double)second);
}

static void same_octree(const gw_octree *a, const gw_octree *b) {
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->reference_count, b->reference_count);
    assert_memory_equal(a->level_begin, b->level_begin, sizeof a->level_begin);
    assert_memory_equal(a->nodes, b->nodes, (size_t)gw_octree_node_bytes(a));
    assert_memory_equal(a->payloads, b->payloads, (size_t)gw_octree_payload_bytes(a));
    assert_memory_equal(a->references, b->references, (size_t)gw_octree_reference_bytes(a));
    assert_true(a->box_count > 0 && a->box_count == b->box_count);
    assert_memory_equal(a->boxes, b->boxes, (size_t)gw_octree_box_bytes(a));
    assert_true(gw_hash_equal(a->hash, b->hash));
    assert_int_equal(a->statistics.pairs, b->statistics.pairs);
    assert_int_equal(a->statistics.leaves, b->statistics.leaves);
}

static void rebuilds_have_the_bytes_of_builds(void **state) {
    (void)state;
    gw_stage stage;
    gw_posed *posed = NULL;
    gw_octree_rebuilder *rebuilder = NULL;
    check_ok(gw_stage_open(&stage, import(), NULL, depth, &error));
    const gw_octree_options options = {.settings = &stage.settings};
    check_ok(gw_posed_create(stage.scene, &posed, &error));
    check_ok(gw_octree_rebuilder_create(stage.device, &options, &rebuilder, &error));
    gw_gl_pool_start(stage.device);
    for (int i = 0; i < TIMES; i++) {
        const gw_octree *again = NULL;
        gw_octree *anew = NULL;
        gw_posed_move(posed, time_of(i));
        check_ok(gw_octree_rebuild(rebuilder, gw_posed_scene(posed), &again, &error));
        check_ok(gw_octree_build(stage.device, gw_posed_scene(posed), &options, &anew, &error));
        same_octree(again, anew);
        if (time_of(i) == 0)
            same_octree(again, stage.octree);
        else
            assert_false(gw_hash_equal(again->hash, stage.octree->hash));
        /* At time 0 the bead's triangles are points: they are listed where they are, and harm nothing. */
        check_ok(gw_octree_validate(stage.device, gw_posed_scene(posed), again, &error));
        gw_octree_destroy(&anew);
    }
    gw_octree_rebuilder_destroy(&rebuilder);
    gw_posed_destroy(&posed);
    gw_stage_close(&stage);
}

static gw_renderer *mover(const gw_stage *stage) {
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.settings = &stage->settings};
    check_ok(gw_renderer_create(stage->device, stage->scene, stage->octree, &options, &renderer, &error));
    return renderer;
}

static void frames_show_the_pose_of_their_time(void **state) {
    (void)state;
    static const double eye[3] = {0.5, 2.0, 6.0}, target[3] = {0, 0.8, 0};
    gw_stage stage;
    gw_posed *posed = NULL;
    gw_camera camera;
    uint8_t *at_0 = NULL;
    check_ok(gw_stage_open(&stage, import(), NULL, depth, &error));
    check_ok(gw_posed_create(stage.scene, &posed, &error));
    gw_camera_look(&camera, &stage, eye, target, 45, SIDE);
    gw_renderer *moving = mover(&stage), *still = gw_stage_renderer(&stage);
    for (int i = 0; i < TIMES; i++) {
        gw_counters counters = {0};
        gw_octree *anew = NULL;
        gw_renderer *direct = NULL;
        const gw_octree_options options = {.settings = &stage.settings};
        camera.state.time = time_of(i);
        gw_posed_move(posed, time_of(i));
        check_ok(gw_octree_build(stage.device, gw_posed_scene(posed), &options, &anew, &error));
        check_ok(gw_renderer_create(stage.device, gw_posed_scene(posed), anew, NULL, &direct, &error));
        uint8_t *moved = gw_camera_take(&camera, moving, &counters),
                *wanted = gw_camera_take(&camera, direct, NULL),
                *stayed = gw_camera_take(&camera, still, NULL);
        assert_memory_equal(moved, wanted, SIDE * SIDE * 4);
        assert_int_equal(counters.nan_pixels + counters.step_cap_hits, 0);
        at_0 = at_0 ? at_0 : stayed;
        assert_memory_equal(stayed, at_0, SIDE * SIDE * 4); /* without settings time stands still */
        assert_true((gw_mean_difference(moved, at_0, SIDE * SIDE) > 0.5) == (time_of(i) != 0));
        free(moved);
        free(wanted);
        if (stayed != at_0)
            free(stayed);
        gw_renderer_destroy(&direct);
        gw_octree_destroy(&anew);
    }
    free(at_0);
    gw_renderer_destroy(&moving);
    gw_renderer_destroy(&still);
    gw_posed_destroy(&posed);
    gw_stage_close(&stage);
}

/* The second time through the same poses everything is there. */
static void nothing_is_allocated_for_a_pose_seen_before(void **state) {
    (void)state;
    static const double eye[3] = {0.5, 2.0, 6.0}, target[3] = {0, 0.8, 0};
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, import(), NULL, depth, &error));
    gw_camera_look(&camera, &stage, eye, target, 45, 16);
    gw_renderer *moving = mover(&stage);
    gw_gl_pool_counts first = {0}, second_round;
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < TIMES; i++) {
            camera.state.time = time_of(i);
            free(gw_camera_take(&camera, moving, NULL));
        }
        second_round = gw_gl_pool_counts_of(stage.device);
        if (round == 1)
            first = second_round;
    }
    assert_int_equal(second_round.made, first.made);
    assert_true(second_round.reused > first.reused + 100);
    json_t *report = json_object();
    check_ok(gw_renderer_report(moving, NULL, report, &error));
    const json_t *rebuild = json_object_get(report, "rebuild");
    assert_int_equal(json_integer_value(json_object_get(rebuild, "rebuilds")),
                     3 * TIMES - 4); /* once at 0, and 0.5 twice */
    assert_int_equal(json_integer_value(json_object_get(rebuild, "held_vertices")), 0);
    json_decref(report);
    gw_renderer_destroy(&moving);
    gw_stage_close(&stage);
}

/* What stays pays nothing: no pool, no second octree, no word in the report. */
static void a_still_scene_pays_nothing(void **state) {
    (void)state;
    gw_stage stage;
    gw_scene *scene = import();
    gw_animation_destroy(&scene->animation);
    check_ok(gw_stage_open(&stage, scene, NULL, depth, &error));
    gw_renderer *renderer = mover(&stage), *plain = gw_stage_renderer(&stage);
    json_t *report = json_object();
    check_ok(gw_renderer_report(renderer, NULL, report, &error));
    assert_null(json_object_get(report, "rebuild"));
    assert_int_equal(gw_renderer_bytes(renderer), gw_renderer_bytes(plain));
    assert_int_equal(gw_gl_pool_counts_of(stage.device).reused, 0);
    json_decref(report);
    gw_renderer_destroy(&renderer);
    gw_renderer_destroy(&plain);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rebuilds_have_the_bytes_of_builds),
        cmocka_unit_test(frames_show_the_pose_of_their_time),
        cmocka_unit_test(nothing_is_allocated_for_a_pose_seen_before),
        cmocka_unit_test(a_still_scene_pays_nothing),
    };
    return cmocka_run_group_tests_name("moving", tests, NULL, NULL);
}
