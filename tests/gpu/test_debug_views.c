/* Pictures that explain: heat maps of work tell what the counters count. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "tests/support/renders.h"
#include "wall/rock.h"

#include <math.h>

enum { SIDE = 60, PIXELS = SIDE * SIDE }; /* 60: blocks at the right and the bottom stick out */

static gw_stage stage;

static const double eye[3] = {0.5, 0.5, 3}, centre[3] = {0, 0, 0};

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_rock_scene(20000, &scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=7", NULL}, &error));
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_stage_close(&stage);
    return 0;
}

/* 0..1 behind the colour of a heat map: red, green and blue change in turn (shaders/shade/debug_view.glsl).
 */
static double heat_of(const uint8_t *rgba) {
    double red = gw_srgb_code_to_linear(rgba[0]), green = gw_srgb_code_to_linear(rgba[1]),
           blue = gw_srgb_code_to_linear(rgba[2]);
    return blue > 0 ? 0.5 - 0.5 * blue : red < 1 ? (1 + red) / 3 : 1 - green / 3;
}

static void maps_of_work_tell_what_is_counted(void **state) {
    static const struct {
        uint8_t view;
        double most;
        size_t counter;
    } maps[] = {{GW_DEBUG_STEPS, 200, offsetof(gw_counters, steps)},
                {GW_DEBUG_LOADS, 100, offsetof(gw_counters, node_loads)},
                {GW_DEBUG_TESTS, 100, offsetof(gw_counters, triangle_tests)},
                {GW_DEBUG_VOXELS, 20, offsetof(gw_counters, voxels)}};
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    (void)state;
    gw_camera_look(&camera, &stage, eye, centre, 40, SIDE);
    camera.state.tau_inside = camera.state.tau = 2; /* so that there are voxels */
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i) {
        gw_counters counters = {0};
        camera.state.debug = maps[i].view;
        uint8_t *rgba = gw_camera_take(&camera, renderer, &counters);
        double told = 0;
        for (size_t p = 0; p < PIXELS; ++p)
            told += maps[i].most * heat_of(rgba + p * 4);
        double counted = (double)*(const uint64_t *)((const char *)&counters + maps[i].counter);
        assert_true(counted > PIXELS);
        assert_true(fabs(told / counted - 1) < 0.03); /* 8 bits a channel; what is beyond red is cut */
        assert_true(counters.voxel_rays > 0 && counters.voxel_rays <= counters.rays);
        free(rgba);
    }
    gw_renderer_destroy(&renderer);
}

/* A picture whose blocks stick out of it, drawn by a renderer that has drawn a larger one: what that left
 * behind in the rays' memory is not counted. */
static void what_sticks_out_is_not_counted(void **state) {
    const gw_renderer_options counting = {.count = 1};
    gw_counters alone = {0}, after = {0};
    gw_camera camera, larger;
    (void)state;
    gw_camera_look(&camera, &stage, eye, centre, 40, SIDE);
    gw_camera_look(&larger, &stage, eye, centre, 40, 2 * SIDE);
    for (int warm = 0; warm < 2; ++warm) {
        gw_renderer *renderer = NULL;
        check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &counting, &renderer, &error));
        if (warm)
            free(gw_camera_take(&larger, renderer, NULL));
        free(gw_camera_take(&camera, renderer, warm ? &after : &alone));
        gw_renderer_destroy(&renderer);
    }
    assert_memory_equal(&alone, &after, sizeof alone);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_of_work_tell_what_is_counted),
        cmocka_unit_test(what_sticks_out_is_not_counted),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
