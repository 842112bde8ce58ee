/* Silhouettes that cross a change of levels, or from triangles to voxels, do not pop: the accepted error
 * grows by 2 % a frame through four octaves, or the eye moves away, and no frame changes the picture at once.
 */
#include "tests/support/check.h"

#include "render/flicker.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };

/* Three bars of square section, aslant. */
static void add_bars(gw_mesh *mesh) {
    static const double wide = 0.06, corners[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    for (int i = 0; i < 12; ++i) {
        const double *from = corners[i % 4], *to = corners[i % 4 + 1];
        const double corner[3] = {-0.3 + 0.3 * (i / 4) + wide * from[0], -0.9, wide * from[1]};
        const double side[3] = {wide * (to[0] - from[0]), 0, wide * (to[1] - from[1])};
        gw_mesh_add_grid(mesh, corner, side, (const double[]){0.3, 1.8, 0.1}, 2, 60);
    }
}

/* Leaves of one side each. */
static void add_leaves(gw_mesh *mesh) {
    uint64_t random = 11;
    for (int i = 0; i < 1500; ++i) {
        double at[3], u[3], v[3];
        for (int k = 0; k < 3; ++k)
            at[k] = 1.2 * gw_test_random(&random) - 0.6;
        for (int k = 0; k < 3; ++k)
            u[k] = 0.1 * (gw_test_random(&random) - 0.5);
        for (int k = 0; k < 3; ++k)
            v[k] = 0.1 * (gw_test_random(&random) - 0.5);
        gw_mesh_add_grid(mesh, at, u, v, 1, 1);
    }
}

/* White under light from everywhere before black: coverage is all that there is to see. */
static gw_scene *make(char kind) {
    gw_mesh mesh = {0};
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.93, 0.9, -0.97}, 0.001); /* moves the octree's middle */
    if (kind == 'b')
        add_bars(&mesh);
    else if (kind == 'l')
        add_leaves(&mesh);
    else
        gw_mesh_add_sphere(&mesh, (const double[]){0.03, 0.01, 0.02}, 0.4, 0, 120, 60);
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = 3;
        scene->materials[0].base_color[k] = 0.9f;
        scene->background[k] = 0;
    }
    return scene;
}

/* Where nothing moves but tau, every change is the levels' own. */
static gw_flicker_result through_levels(const gw_stage *stage, int blend) {
    enum { STEPS = 140 };
    gw_renderer *renderer = gw_stage_renderer(stage);
    gw_flicker flicker = {0};
    gw_camera camera;
    gw_camera_look(&camera, stage, (const double[]){0.15, 0.09, 3}, (const double[]){0, 0, 0}, 24, SIDE);
    uint8_t *exact = gw_camera_take(&camera, renderer, NULL);
    const gw_image reference = {SIDE, SIDE, exact};
    camera.state.level_blend = camera.state.leaf_blend = (uint8_t)blend;
    for (int i = 0; i <= STEPS; ++i) {
        camera.state.tau_inside = (float)(0.25 * pow(2, 4.0 * i / STEPS));
        uint8_t *rgba = gw_camera_take(&camera, renderer, NULL);
        const gw_image picture = {SIDE, SIDE, rgba};
        check_ok(gw_flicker_add(&flicker, &reference, &picture, &error));
        free(rgba);
    }
    gw_flicker_result result = gw_flicker_of(&flicker);
    gw_flicker_finish(&flicker);
    free(exact);
    gw_renderer_destroy(&renderer);
    return result;
}

/* Blended: no pixel jumps by more than a fifth of white (one of 100 by a twentieth), no patch by
 * more than a fiftieth. In steps: pixels go from black to white at once, and whole patches with them. */
static void levels_do_not_pop(void **state) {
    static const struct {
        char kind;
        const char *name;
        double largest, percentile, pop; /* most when blended */
    } things[] = {
        {'b', "bars", 0.2, 0.05, 0.02}, {'s', "ball", 0.2, 0.01, 0.005}, {'l', "foliage", 0.2, 0.05, 0.02}};
    (void)state;
    for (size_t i = 0; i < sizeof things / sizeof things[0]; ++i) {
        gw_stage stage;
        check_ok(gw_stage_open(&stage, make(things[i].kind), NULL,
                               (const char *const[]){"octree_depth=8", NULL}, &error));
        gw_flicker_result blended = through_levels(&stage, 1), stepped = through_levels(&stage, 0);
        print_message("%s: largest jump of a pixel %.3f, 99th of 100 %.3f, of a patch %.4f; in steps %.3f, "
                      "%.3f, %.4f\n",
                      things[i].name, blended.largest, blended.percentile, blended.pop, stepped.largest,
                      stepped.percentile, stepped.pop);
        assert_true(blended.largest <= things[i].largest && blended.percentile <= things[i].percentile);
        assert_true(blended.pop <= things[i].pop);
        assert_true(stepped.largest > 0.9 && stepped.pop > 2.5 * blended.pop); /* the naive variant fails */
        gw_stage_close(&stage);
    }
}

/* The eye moves away through more than an octave: frames change no more than 16 exact rays a pixel do. */
static void moving_away_changes_as_the_reference_does(void **state) {
    enum { STEPS = 24 };
    (void)state;
    gw_stage stage;
    check_ok(gw_stage_open(&stage, make('b'), NULL,
                           (const char *const[]){"octree_depth=8", "samples=4", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    double most[2] = {0, 0};
    uint8_t *before[2] = {NULL, NULL};
    for (int i = 0; i <= STEPS; ++i) {
        double away = 2.4 * pow(2, 1.2 * i / STEPS);
        gw_camera camera;
        gw_camera_look(&camera, &stage, (const double[]){0.05 * away, 0.03 * away, away},
                       (const double[]){0, 0, 0}, 24, SIDE);
        for (int exact = 0; exact < 2; ++exact) {
            camera.state.samples = exact ? 4 : 2;
            camera.state.tau_inside = exact ? 0 : 2; /* of rays that are half a pixel wide */
            uint8_t *now = gw_camera_take(&camera, renderer, NULL);
            if (before[exact])
                most[exact] = fmax(most[exact], gw_mean_difference(before[exact], now, PIXELS));
            free(before[exact]);
            before[exact] = now;
        }
    }
    print_message("moving away: largest step %.2f/255, of the reference %.2f\n", most[0], most[1]);
    assert_true(most[0] < 1.5 * most[1]);
    free(before[0]);
    free(before[1]);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_do_not_pop),
        cmocka_unit_test(moving_away_changes_as_the_reference_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
