/* Random frame states on a scene that has everything: whatever the state, pixels are the same however the
 * picture is split, whatever was drawn before it, however short the rays' breath, whatever is compiled in
 * beyond need. States are random from a printed seed; GW_TEST_SEED takes another. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 56, PIXELS = SIDE * SIDE, STATES = 14 };

static uint64_t seed = 20261124;
static gw_stage stage;
static gw_renderer *renderer, *short_winded, *forced;
static gw_camera view;

static uint32_t below(uint64_t *random, uint32_t count) {
    return (uint32_t)(gw_test_random(random) * count);
}

static float between(uint64_t *random, double low, double high) {
    return (float)(low + (high - low) * gw_test_random(random));
}

/* Glass, a mask that keeps and one that cuts, something that glows, a mirror; two lights. */
static void furnish(gw_scene *scene) {
    static const gw_material materials[] = {
        {.base_color = {0.7f, 0.5f, 0.3f, 1}, .roughness = 1},
        {.base_color = {0.2f, 0.5f, 0.8f, 0.4f}, .roughness = 0.3f, .alpha_mode = GW_ALPHA_BLEND},
        {.base_color = {0.1f, 0.8f, 0.2f, 0.6f},
         .roughness = 1,
         .alpha_mode = GW_ALPHA_MASK,
         .alpha_cutoff = 0.5f},
        {.base_color = {0.9f, 0.1f, 0.1f, 0.4f},
         .roughness = 1,
         .alpha_mode = GW_ALPHA_MASK,
         .alpha_cutoff = 0.5f},
        {.base_color = {0.1f, 0.1f, 0.1f, 1},
         .roughness = 0.4f,
         .metalness = 1,
         .emissive = {0.4f, 0.3f, 0.1f}},
        {.base_color = {0.9f, 0.9f, 0.9f, 1}, .roughness = 0, .metalness = 1}};
    enum { COUNT = sizeof materials / sizeof materials[0] };
    static const gw_light lights[] = {
        {.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.4, -0.8, -0.5}, .color = {2, 2, 1.5f}},
        {.kind = GW_LIGHT_POINT, .vector = {0.7, 0.9, 1.2}, .color = {1, 1.5f, 2}}};
    void *memory = NULL;
    free(scene->materials);
    check_ok(gw_allocate(&memory, COUNT, sizeof *scene->materials, "materials", &error));
    scene->materials = memory;
    scene->material_count = COUNT;
    for (uint32_t m = 0; m < COUNT; ++m) {
        scene->materials[m] = materials[m];
        scene->materials[m].base_color_texture = -1;
    }
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        scene->material_of[t] = t % 10 < 5 ? 0 : t % 10 - 4;
    check_ok(gw_allocate(&memory, 2, sizeof *scene->lights, "lights", &error));
    scene->lights = memory;
    memcpy(scene->lights, lights, sizeof lights);
    scene->light_count = 2;
}

static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    uint64_t random = 3;
    gw_mesh_add_sphere(&mesh, (const double[]){0.1, 0.1, -0.1}, 0.5, 0.15, 80, 50);
    gw_mesh_add_grid(&mesh, (const double[]){-1, -0.5, -1}, (const double[]){0, 0, 2},
                     (const double[]){2, 0, 0}, 9, 9);
    for (int i = 0; i < 400; ++i) {
        double at[3];
        for (int k = 0; k < 3; ++k)
            at[k] = 1.8 * (gw_test_random(&random) - 0.5);
        gw_mesh_add_tetrahedron(&mesh, at, 0.004 + 0.03 * gw_test_random(&random));
    }
    gw_scene *scene = gw_mesh_take(&mesh);
    furnish(scene);
    return scene;
}

static int open_stage(void **state) {
    (void)state;
    const char *given = getenv("GW_TEST_SEED");
    seed = given ? strtoull(given, NULL, 10) : seed;
    print_message("seed %llu\n", (unsigned long long)seed);
    check_ok(gw_stage_open(&stage, make_scene(), NULL,
                           (const char *const[]){"octree_depth=8", "dense_leaf=5", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    gw_renderer_options breath = {.loop_budget = 40}, all = {.force_features = GW_ALL_FEATURES};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &breath, &short_winded, &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &all, &forced, &error));
    gw_camera_look(&view, &stage, (const double[]){0.7, 0.6, 2.2}, (const double[]){0, 0, 0}, 44, SIDE);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_renderer_destroy(&short_winded);
    gw_renderer_destroy(&forced);
    gw_stage_close(&stage);
    return 0;
}

static void add_gaze(gw_camera *camera, uint64_t *random) {
    gw_camera one = view;
    gw_camera_gaze(&one, between(random, -20, SIDE + 20), between(random, -20, SIDE + 20),
                   between(random, 0, 8));
    gw_gaze *gaze = &camera->state.gazes[camera->state.gaze_count++];
    *gaze = one.state.gazes[0];
    gaze->half_width *= between(random, 0.5, 2);
    gaze->age = between(random, 0, 0.1);
    for (int k = 0; k < 3; ++k)
        gaze->eye[k] += between(random, -200, 200);
}

/* Blends are on in most: each choice is a kernel of its own, whose translation takes longer than the picture.
 */
static gw_camera random_state(uint64_t *random) {
    gw_camera camera = view;
    camera.state.tau = between(random, 0, 8);
    camera.state.tau_inside = below(random, 2) ? 0 : between(random, 0, 2);
    camera.state.gaze_blend = below(random, 4) ? between(random, 0.1, 6) : 0;
    camera.state.gaze_margin = between(random, 0, 4);
    camera.state.acuity_slope = between(random, 0, 0.2);
    camera.state.sample_block = (uint8_t)below(random, 5);
    camera.state.samples = (uint8_t)below(random, 3);
    camera.state.coarse_samples = (uint8_t)below(random, 3);
    camera.state.gaze_footprint = between(random, 0, 2);
    camera.state.strain = below(random, 3) ? 1 : between(random, 1, 8);
    camera.state.shadow_tau = between(random, 0, 2);
    camera.state.reconstruction = (uint8_t)below(random, 3);
    camera.state.rate_blend = (uint8_t)below(random, 2);
    camera.state.mirror_roughness = below(random, 2) ? 0.02f : 0;
    camera.state.separated_tau = between(random, 0, 1);
    camera.state.near_light = (uint8_t)below(random, 256);
    camera.state.voxel_flatness = between(random, 0.4, 1.2);
    camera.state.level_blend = camera.state.leaf_blend = below(random, 5) > 0;
    for (uint32_t viewers = below(random, 4); viewers > 0; --viewers)
        add_gaze(&camera, random);
    camera.state.strain = below(random, 3) ? 1 : between(random, 1, 16);
    camera.state.accumulate = below(random, 3) ? 1 : 2;
    camera.state.exposure = between(random, -2, 2);
    camera.state.tone = camera.state.dither = (uint8_t)below(random, 2);
    return camera;
}

static void expect_same(const uint8_t *wanted, const uint8_t *got, int state, const char *what) {
    for (size_t i = 0; i < PIXELS; ++i)
        if (memcmp(wanted + i * 4, got + i * 4, 4))
            fail_msg("seed %llu, state %d, %s: pixel (%zu, %zu) is %d %d %d, expected %d %d %d",
                     (unsigned long long)seed, state, what, i % SIDE, i / SIDE, got[i * 4], got[i * 4 + 1],
                     got[i * 4 + 2], wanted[i * 4], wanted[i * 4 + 1], wanted[i * 4 + 2]);
}

static void draw_part(const gw_camera *camera, int x, int y, int width, int height, uint8_t *rgba) {
    static uint8_t part[PIXELS * 4];
    const gw_rectangle r = {x, y, (uint32_t)width, (uint32_t)height};
    check_ok(gw_renderer_frame(renderer, &camera->placement, &camera->plane, &r, &camera->state, part, NULL,
                               &error));
    for (int row = 0; row < height; ++row)
        memcpy(rgba + ((size_t)(y + row) * SIDE + (size_t)x) * 4, part + (size_t)row * (size_t)width * 4,
               (size_t)width * 4);
}

/* In four pieces that meet at a random pixel. */
static uint8_t *in_pieces(const gw_camera *camera, uint64_t *random) {
    uint8_t *rgba = calloc(PIXELS, 4);
    assert_non_null(rgba);
    int x = 1 + (int)below(random, SIDE - 1), y = 1 + (int)below(random, SIDE - 1);
    draw_part(camera, 0, 0, x, y, rgba);
    draw_part(camera, x, 0, SIDE - x, y, rgba);
    draw_part(camera, 0, y, x, SIDE - y, rgba);
    draw_part(camera, x, y, SIDE - x, SIDE - y, rgba);
    return rgba;
}

static void states_give_the_same_pixels_however_they_are_drawn(void **state) {
    uint64_t random = seed;
    gw_counters counters = {0};
    (void)state;
    for (int i = 0; i < STATES; ++i) {
        const gw_camera camera = random_state(&random);
        uint8_t *whole = gw_camera_take(&camera, renderer, &counters);
        uint8_t *pieces = in_pieces(&camera, &random);
        expect_same(whole, pieces, i, "split");
        gw_renderer *other = i % 2 ? short_winded : forced;
        uint8_t *again = gw_camera_take(&camera, other, &counters);
        expect_same(whole, again, i, i % 2 ? "short loop budget" : "all effects forced");
        free(whole);
        free(pieces);
        free(again);
    }
    print_message("%llu rays suspended\n", (unsigned long long)counters.resumed);
    assert_true(counters.resumed > PIXELS);
    assert_int_equal(counters.step_cap_hits, 0);
    assert_int_equal(counters.nan_pixels, 0);
}

/* With nothing accumulated, a still gaze gives a still picture, whatever the frame's number; and after a jump
 * of the gaze the picture is that of a renderer that has drawn nothing before. */
static void still_gazes_stand_and_jumps_leave_nothing_behind(void **state) {
    uint64_t random = seed + 1;
    (void)state;
    for (int i = 0; i < 3; ++i) {
        gw_camera camera = random_state(&random), jumped = camera;
        camera.state.gaze_count = jumped.state.gaze_count = 0;
        add_gaze(&camera, &random);
        add_gaze(&jumped, &random);
        uint8_t *first = gw_camera_take(&camera, renderer, NULL);
        camera.state.frame += 7;
        uint8_t *second = gw_camera_take(&camera, renderer, NULL);
        expect_same(first, second, i, "a still gaze");
        uint8_t *after = gw_camera_take(&jumped, renderer, NULL);
        gw_renderer *cold = gw_stage_renderer(&stage);
        uint8_t *alone = gw_camera_take(&jumped, cold, NULL);
        expect_same(alone, after, i, "a gaze jump");
        assert_true(memcmp(first, after, PIXELS * 4) != 0);
        gw_renderer_destroy(&cold);
        free(first);
        free(second);
        free(after);
        free(alone);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(states_give_the_same_pixels_however_they_are_drawn),
        cmocka_unit_test(still_gazes_stand_and_jumps_leave_nothing_behind),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
