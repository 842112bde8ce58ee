/* Many octrees and renderers on one device: drawn in turns, each has the picture that it has alone, also
 * beside a scene that is rebuilt for every frame and gives its storage to a pool. */
#include "tests/support/check.h"

#include "build/import.h"
#include "render/root_grid.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

enum { MODELS = 6, SIDE = 64, PIXELS = SIDE * SIDE, ROUNDS = 3 };
static const char *const depth[] = {"octree_depth=7", "tau=2", NULL};
static const double eye[3] = {0.3, 1.2, 3.4}, target[3] = {0, 0.2, 0};

/* Spheres of growing size with different ripples; the last model moves. */
static gw_scene *make_model(uint32_t index) {
    const char *program = getenv("GAZEWALL");
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    const double centre[3] = {0, 0.1 * index, 0};
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    if (index == MODELS - 1) {
        check_ok(gw_import("configs/scenes/moving.gltf", &options, &scene, &error));
        return scene;
    }
    gw_mesh_add_sphere(&mesh, centre, 0.4 + 0.1 * index, 0.05 * index, 8 + 4 * index, 6 + 2 * index);
    scene = gw_mesh_take(&mesh);
    return scene;
}

static gw_renderer *make_renderer(const gw_stage *stage) {
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.settings = &stage->settings};
    check_ok(gw_renderer_create(stage->device, stage->scene, stage->octree, &options, &renderer, &error));
    return renderer;
}

static uint8_t *draw(const gw_stage *stage, gw_renderer *renderer, int round) {
    gw_camera camera;
    gw_camera_look(&camera, stage, eye, target, 50, SIDE);
    camera.state.time = (int64_t)round * 700000000;
    return gw_camera_take(&camera, renderer, NULL);
}

/* A model on the device of `first`, whose settings it shares. */
static gw_stage open_beside(const gw_stage *first, uint32_t index) {
    gw_stage stage = {.device = first->device, .scene = make_model(index), .settings = first->settings};
    const gw_octree_options options = {.settings = &first->settings};
    check_ok(gw_octree_build(stage.device, stage.scene, &options, &stage.octree, &error));
    return stage;
}

static void close_beside(gw_stage *stage) {
    gw_octree_destroy(&stage->octree);
    gw_scene_destroy(&stage->scene);
}

static void neighbours_change_no_pixel(void **state) {
    (void)state;
    gw_stage first, stages[MODELS];
    gw_renderer *renderers[MODELS];
    uint8_t *alone[ROUNDS][MODELS];
    check_ok(gw_stage_open(&first, make_model(0), NULL, depth, &error));
    for (uint32_t m = 0; m < MODELS; m++) { /* the one that moves comes last: it starts the pool */
        gw_stage stage = open_beside(&first, m);
        gw_renderer *renderer = make_renderer(&stage);
        for (int round = 0; round < ROUNDS; round++)
            alone[round][m] = draw(&stage, renderer, round);
        gw_renderer_destroy(&renderer);
        close_beside(&stage);
    }
    for (uint32_t m = 0; m < MODELS; m++) {
        stages[m] = open_beside(&first, m);
        renderers[m] = make_renderer(&stages[m]);
    }
    for (int round = 0; round < ROUNDS; round++)
        for (uint32_t m = 0; m < MODELS; m++) {
            uint8_t *beside = draw(&stages[m], renderers[m], round);
            assert_memory_equal(beside, alone[round][m], PIXELS * 4);
            free(beside);
        }
    assert_true(gw_mean_difference(alone[0][0], alone[0][1], PIXELS) > 0.5);
    assert_true(gw_mean_difference(alone[0][MODELS - 1], alone[1][MODELS - 1], PIXELS) > 0.5);
    for (uint32_t m = 0; m < MODELS; m++) {
        gw_renderer_destroy(&renderers[m]);
        close_beside(&stages[m]);
        for (int round = 0; round < ROUNDS; round++)
            free(alone[round][m]);
    }
    gw_stage_close(&first);
}

/* What a renderer says it holds is what its octree and scene need. */
static void parts_add_up(void **state) {
    (void)state;
    gw_stage stage;
    check_ok(gw_stage_open(&stage, make_model(3), NULL, depth, &error));
    gw_renderer *renderer = make_renderer(&stage);
    free(draw(&stage, renderer, 0));
    const gw_renderer_parts p = gw_renderer_parts_of(renderer);
    const size_t with_grid =
        gw_root_grid_begin(stage.octree) + gw_root_grid_size(gw_root_grid_level(stage.octree));
    assert_true(with_grid > stage.octree->node_count);
    assert_int_equal(p.nodes, with_grid * sizeof(gw_node));
    assert_int_equal(p.references, gw_octree_reference_bytes(stage.octree));
    assert_int_equal(p.voxels, gw_octree_payload_bytes(stage.octree));
    assert_int_equal(p.triangles, stage.scene->triangle_count * sizeof(gw_gpu_triangle));
    assert_true(p.rays > 0);
    assert_int_equal(p.nodes + p.references + p.voxels + p.triangles + p.attributes + p.textures + p.rays,
                     gw_renderer_bytes(renderer));
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_change_no_pixel),
        cmocka_unit_test(parts_add_up),
    };
    return cmocka_run_group_tests_name("resident", tests, NULL, NULL);
}
