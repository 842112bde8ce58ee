/* A tetrahedron of a thousandth of the scene, alone in the air, seen where a ray serves 8 x 8 pixels: with
 * the isolation rule it has a voxel of its own size, whose ancestors stand for it in every wide ray. The
 * plain rule leaves it in a leaf hundreds of times as large, which stays triangles, and most rays pass it by.
 */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

enum { WALL = 2048, REGION = 64, PLACES = 6 };

static const double speck[3] = {0.31, 0.57, 0.23};

static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    gw_mesh_add_grid(&mesh, (const double[]){-1, -1, -1}, (const double[]){0, 0, 2},
                     (const double[]){2, 0, 0}, 2, 2);
    gw_mesh_add_tetrahedron(&mesh, speck, 0.0005); /* 1 mm wide, the scene 2 m */
    scene = gw_mesh_take(&mesh);
    return scene;
}

/* Light of the region round the speck, in pixels of full light. footprint 1: voxels as wide as what the
 * viewer resolves, which no square is wider than. */
static double light_of(const gw_stage *stage, gw_renderer *renderer, double footprint, double right,
                       double up) {
    static uint8_t rgba[REGION * REGION * 4];
    const double eye[3] = {speck[0] + right, speck[1] + up, speck[2] + 1.2};
    const double target[3] = {speck[0] + right, speck[1] + up, speck[2]};
    const gw_rectangle region = {(WALL - REGION) / 2, (WALL - REGION) / 2, REGION, REGION};
    gw_counters counters = {0};
    gw_camera camera;
    gw_camera_look(&camera, stage, eye, target, 40, WALL);
    gw_camera_gaze(&camera, 40, 40, 2);
    camera.state.gaze_footprint = (float)footprint;
    check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, &region, &camera.state, rgba,
                               &counters, &error));
    assert_true(counters.rays < REGION * REGION / 16); /* a ray for 64 pixels, and the rim */
    return gw_mean_linear(rgba, REGION * REGION) * REGION * REGION;
}

/* Light at places that differ by parts of a block: the least, and the mean. */
static void look(int isolation, double footprint, double *least, double *mean) {
    gw_stage stage;
    *least = 1e9;
    *mean = 0;
    check_ok(gw_stage_open(&stage, make_scene(), NULL,
                           isolation ? (const char *const[]){"octree_depth=13", NULL}
                                     : (const char *const[]){"octree_depth=13", "isolation_rule=off", NULL},
                           &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    for (int i = 0; i < PLACES * PLACES; ++i) {
        const double pace = 0.0034 / PLACES; /* of a block of 3.4 mm at the speck */
        double light = light_of(&stage, renderer, footprint, i % PLACES * pace, i / PLACES * pace);
        *least = light < *least ? light : *least;
        *mean += light / (PLACES * PLACES);
    }
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void a_speck_is_never_lost(void **state) {
    (void)state;
    double least, mean, half_least, half_mean, plain_least, plain_mean;
    look(1, 1, &least, &mean);
    look(1, 0.5, &half_least, &half_mean);
    look(0, 0.5, &plain_least, &plain_mean);
    print_message(
        "light of the speck, least and mean of %d places: %.3f and %.3f pixels; voxels half as wide "
        "%.3f and %.3f; plain rule %.3f and %.3f\n",
        PLACES * PLACES, least, mean, half_least, half_mean, plain_least, plain_mean);
    assert_true(least > 0.25 * mean && mean > 0);
    /* The default, gaze_footprint 0.5: a speck between the rays of wide squares loses light, but never all.
     */
    assert_true(half_least > 0.2 * half_mean && half_mean > 0);
    assert_true(plain_least == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_speck_is_never_lost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
