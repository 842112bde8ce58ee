/* gaze_rule = seed: exact inside the ellipse on the wall, voxels that grow with the distance from it, a ray
 * for every pixel, transitions blurred; and a pure function of the wall like everything else. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 120, PIXELS = SIDE * SIDE };

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera;

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(
        &stage, scene, NULL,
        (const char *const[]){"octree_depth=8", "gaze_rule=seed", "seed_distance=150", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&camera, &stage, view->eye, view->look_at, 60, SIDE);
    gw_camera_gaze(&camera, 30, 40, 8.0);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

/* Distance on the wall, mm, from the ellipse towards its centre: the rule in double. */
static double distance_of(const gw_camera *from, double x, double y) {
    const gw_gaze *gaze = &from->state.gazes[0];
    double point[3], towards = 0, along_gaze = 0, square = 0;
    for (int i = 0; i < 3; ++i) {
        point[i] = from->plane.corner[i] + x * from->plane.step_x[i] + y * from->plane.step_y[i] -
                   (double)gaze->eye[i];
        along_gaze += point[i] * (double)gaze->direction[i];
        square += point[i] * point[i];
    }
    /* The gaze axis meets the wall at pixel (30, 40); along the line from there the angle is found by
     * halving. */
    double inside = 0, outside = 1, limit = tan((double)gaze->half_width * acos(-1) / 180);
    if (sqrt(fmax(square - along_gaze * along_gaze, 0)) <= limit * along_gaze)
        return 0;
    for (int step = 0; step < 60; ++step) {
        double half = (inside + outside) / 2, z = 0, all = 0;
        for (int i = 0; i < 3; ++i) {
            double p = from->plane.corner[i] + (30 + half * (x - 30)) * from->plane.step_x[i] +
                       (40 + half * (y - 40)) * from->plane.step_y[i] - (double)gaze->eye[i];
            z += p * (double)gaze->direction[i];
            all += p * p;
        }
        if (sqrt(fmax(all - z * z, 0)) <= limit * z)
            inside = half;
        else
            outside = half;
    }
    for (int i = 0; i < 3; ++i)
        towards += pow((x - 30) * from->plane.step_x[i] + (y - 40) * from->plane.step_y[i], 2);
    return (1 - inside) * sqrt(towards);
}

/* Inside the ellipse the bits of exact triangles; the map of footprints shows log2(1 + d / seed_distance)
 * outside. */
static void voxels_grow_with_the_distance_on_the_wall(void **state) {
    gw_camera exact = camera, map = camera, plain = camera;
    gw_counters counters = {0};
    size_t inside = 0, outside = 0;
    (void)state;
    exact.state.gaze_count = 0;
    plain.state.rate_blend = map.state.rate_blend = 0;
    plain.state.sample_block = map.state.sample_block = 0;
    map.state.debug = GW_DEBUG_FOOTPRINT;
    uint8_t *sharp = gw_camera_take(&exact, renderer, NULL),
            *ruled = gw_camera_take(&plain, renderer, &counters);
    uint8_t *shown = gw_camera_take(&map, renderer, NULL);
    assert_int_equal(counters.rays, PIXELS); /* a ray for each */
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            double d = distance_of(&camera, x + 0.5, y + 0.5), levels = log2(1 + d / 150);
            if (d == 0) {
                assert_memory_equal(ruled + at, sharp + at, 4);
                inside++;
            }
            /* heat(1 - levels / 4): red falls and blue rises at known places. */
            int warmth = shown[at] - shown[at + 2];
            if (levels < 0.3)
                assert_true(warmth > 0);
            if (levels > 2.8) {
                assert_true(warmth < 0);
                outside++;
            }
        }
    print_message("# %zu pixels inside, %zu far outside\n", inside, outside);
    assert_true(inside > 200 && outside > 100);
    assert_true(memcmp(ruled, sharp, PIXELS * 4) != 0);
    free(sharp);
    free(ruled);
    free(shown);
}

/* The smaller seed_distance is, the coarser; far from the ellipse it decides, near it nothing changes. */
static void a_shorter_distance_is_coarser(void **state) {
    gw_camera near = camera, exact = camera;
    double difference[3];
    static const float distances[] = {1e6f, 300, 30};
    (void)state;
    exact.state.gaze_count = 0;
    uint8_t *sharp = gw_camera_take(&exact, renderer, NULL);
    for (int i = 0; i < 3; ++i) {
        near.state.seed_distance = distances[i];
        uint8_t *rgba = gw_camera_take(&near, renderer, NULL);
        difference[i] = gw_mean_difference(rgba, sharp, PIXELS);
        free(rgba);
    }
    print_message("# difference to exact: %.2f %.2f %.2f\n", difference[0], difference[1], difference[2]);
    assert_true(difference[1] > 1.1 * difference[0] && difference[2] > 1.1 * difference[1]);
    free(sharp);
}

static void splits_agree(void **state) {
    static const int cuts[] = {0, 37, 64, 120};
    gw_camera two = camera, other = camera;
    (void)state;
    gw_camera_gaze(&other, 100, 90, 5.0);
    two.state.gazes[1] = other.state.gazes[0];
    two.state.gaze_count = 2;
    uint8_t *whole = gw_camera_take(&two, renderer, NULL), *piece = calloc(PIXELS, 4);
    assert_non_null(piece);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            gw_rectangle part = {cuts[i], cuts[j], (uint32_t)(cuts[i + 1] - cuts[i]),
                                 (uint32_t)(cuts[j + 1] - cuts[j])};
            check_ok(gw_renderer_frame(renderer, &two.placement, &two.plane, &part, &two.state, piece, NULL,
                                       &error));
            for (uint32_t y = 0; y < part.height; ++y)
                assert_memory_equal(piece + (size_t)y * part.width * 4,
                                    whole + ((size_t)(cuts[j] + (int)y) * SIDE + (size_t)cuts[i]) * 4,
                                    (size_t)part.width * 4);
        }
    free(piece);
    free(whole);
}

/* Where voxels begin the picture is blurred, and nowhere inside. */
static void transitions_are_blurred(void **state) {
    gw_camera abrupt = camera;
    size_t changed = 0;
    (void)state;
    abrupt.state.rate_blend = 0;
    uint8_t *plain = gw_camera_take(&abrupt, renderer, NULL),
            *blurred = gw_camera_take(&camera, renderer, NULL);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            int differs = memcmp(plain + at, blurred + at, 4) != 0;
            assert_true(!differs || distance_of(&camera, x + 0.5, y + 0.5) > 0);
            changed += (size_t)differs;
        }
    assert_true(changed > PIXELS / 10);
    free(plain);
    free(blurred);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(voxels_grow_with_the_distance_on_the_wall),
        cmocka_unit_test(a_shorter_distance_is_coarser),
        cmocka_unit_test(splits_agree),
        cmocka_unit_test(transitions_are_blurred),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
