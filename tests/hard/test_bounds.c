/* Reads beyond the end of the octree's buffers: drivers answer zero, and the picture lies without a word.
 * --debug bounds finds them: how many, and the first index. */
#include "tests/support/check.h"

#include "build/gpu_types.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

enum { SIDE = 48, PIXELS = SIDE * SIDE };

static gw_stage stage;
static gw_camera camera;
static uint8_t *sound;

static int open_stage(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 1.0, 0.1, 40, 24);
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL,
                           (const char *const[]){"octree_depth=7", "leaf_triangles=1", "tau=0", NULL},
                           &error));
    gw_camera_look(&camera, &stage, (const double[]){0.4, 0.7, 3}, (const double[]){0, 0, 0}, 42, SIDE);
    sound = gw_stage_take(&stage, &camera, NULL, NULL);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    free(sound);
    gw_stage_close(&stage);
    return 0;
}

/* A picture of the octree as it stands, with checks or without. */
static gw_code draw(int checked, uint8_t *rgba, gw_error *error) {
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera with = camera;
    with.state.debug = checked ? GW_DEBUG_BOUNDS : GW_DEBUG_NONE;
    gw_code code = gw_camera_picture(&with, renderer, rgba, NULL, error);
    gw_renderer_destroy(&renderer);
    return code;
}

/* Nodes of the deepest level that has children, in every third place, whose children are where no node is. */
static uint32_t plant(uint32_t *links) {
    const uint32_t beyond = 0xf00000, deepest = stage.octree->level_begin[stage.octree->depth - 1];
    for (uint32_t i = 0; i < stage.octree->node_count; ++i) {
        gw_node *node = &stage.octree->nodes[i];
        links[i] = node->link;
        if (GW_NODE_KIND(node->bits) == GW_KIND_INNER && i >= deepest && i % 3 == 0)
            node->link = beyond;
    }
    return beyond;
}

static void restore(const uint32_t *links) {
    for (uint32_t i = 0; i < stage.octree->node_count; ++i)
        stage.octree->nodes[i].link = links[i];
}

static void what_is_sound_passes(void **state) {
    (void)state;
    uint8_t rgba[PIXELS * 4];
    check_ok(draw(1, rgba, &error));
    assert_memory_equal(rgba, sound, sizeof rgba);
}

static void planted_reads_are_reported(void **state) {
    (void)state;
    uint8_t rgba[PIXELS * 4];
    char wanted[64];
    uint32_t *links = malloc(stage.octree->node_count * sizeof *links);
    assert_non_null(links);
    snprintf(wanted, sizeof wanted, "the first of node %u", plant(links));
    check_fails(draw(1, rgba, &error), GW_MACHINE, wanted);
    restore(links);
    free(links);
}

static void without_checks_the_picture_lies(void **state) {
    (void)state;
    uint8_t rgba[PIXELS * 4];
    uint32_t *links = malloc(stage.octree->node_count * sizeof *links);
    assert_non_null(links);
    plant(links);
    check_ok(draw(0, rgba, &error));
    assert_memory_not_equal(rgba, sound, sizeof rgba);
    restore(links);
    free(links);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_sound_passes),
        cmocka_unit_test(planted_reads_are_reported),
        cmocka_unit_test(without_checks_the_picture_lies),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
