/* What is made of few rays: the table "Sparse samples" of docs/performance.md. A piece of the demo scene on a
 * wall of 3840 x 2160 pixels, 60 a degree, 13 to 17 degrees from a gaze at the wall's middle, by settings,
 * against 16 exact rays a pixel: FLIP, FLIP behind the viewer's acuity, root mean square in linear light,
 * rays. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/demo_scene.h"
#include "render/acuity_filter.h"
#include "render/flip.h"
#include "render/frame_block.h"
#include "tests/support/renders.h"

#include <math.h>

enum { WALL_WIDE = 3840, WALL_HIGH = 2160, WIDE = 256, HIGH = 144 };
static const gw_rectangle piece = {2700, 1080, WIDE, HIGH};

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera;
static gw_image exact, exact_seen;

static gw_image take(const gw_camera *from, gw_counters *counters) {
    gw_image image;
    check_ok(gw_image_create(WIDE, HIGH, &image, &error));
    check_ok(gw_renderer_frame(renderer, &from->placement, &from->plane, &piece, &from->state, image.rgba,
                               counters, &error));
    return image;
}

/* The filter counts pixels from the picture's first. */
static gw_image seen(const gw_image *picture) {
    gw_camera viewer = camera;
    gw_frame_block block;
    gw_image out;
    for (int k = 0; k < 3; ++k)
        viewer.plane.corner[k] += piece.x * viewer.plane.step_x[k] + piece.y * viewer.plane.step_y[k];
    check_ok(gw_frame_block_fill(stage.scene, stage.octree, &viewer.placement, &viewer.plane, &viewer.state,
                                 &block, NULL, &error));
    check_ok(gw_acuity_filter(picture, &block, &out, &error));
    return out;
}

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=11", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    const double degree = acos(-1) / 180, fov = 2 * atan(WALL_WIDE / 2.0 * tan(degree / 60)) / degree;
    gw_camera_look(&camera, &stage, view->eye, view->look_at, fov, WALL_WIDE);
    for (int k = 0; k < 3; ++k)
        camera.plane.corner[k] += (WALL_WIDE - WALL_HIGH) / 2.0 * camera.plane.step_y[k];
    gw_camera_gaze(&camera, WALL_WIDE / 2.0, WALL_HIGH / 2.0, 8);
    camera.state.gazes[0].half_height = 6;
    gw_camera full = camera;
    full.state.gaze_count = 0;
    full.state.samples = 4;
    exact = take(&full, NULL);
    exact_seen = seen(&exact);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_image_finish(&exact);
    gw_image_finish(&exact_seen);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

typedef struct quality {
    double rays, flip, seen, rms; /* rays a pixel */
} quality;

static quality quality_of(const char *const *assignments) {
    gw_settings settings = stage.settings;
    gw_camera drawn = camera;
    gw_counters counters = {0};
    quality out = {0};
    char name[256] = "";
    for (const char *const *a = assignments; *a; ++a) {
        check_ok(gw_settings_assign(&settings, *a, &error));
        snprintf(name + strlen(name), sizeof name - strlen(name), " %s", *a);
    }
    gw_frame_state_apply(&drawn.state, &settings);
    gw_image picture = take(&drawn, &counters), filtered = seen(&picture);
    check_ok(gw_flip(&exact, &picture, 60, NULL, &out.flip, &error));
    check_ok(gw_flip(&exact_seen, &filtered, 60, NULL, &out.seen, &error));
    for (size_t i = 0; i < WIDE * HIGH * 4; ++i) {
        const double d = gw_srgb_code_to_linear(picture.rgba[i]) - gw_srgb_code_to_linear(exact.rgba[i]);
        out.rms += i % 4 < 3 ? d * d / (3.0 * WIDE * HIGH) : 0;
    }
    out.rms = sqrt(out.rms);
    out.rays = (double)counters.rays / (WIDE * HIGH);
    print_message("# %s: rays %.3f, FLIP %.3f, seen %.3f, error %.3f\n", *name ? name : " defaults", out.rays,
                  out.flip, out.seen, out.rms);
    gw_image_finish(&picture);
    gw_image_finish(&filtered);
    return out;
}

static void few_rays_are_well_spent(void **state) {
    (void)state;
    const quality widest = quality_of((const char *const[]){"reconstruction=bilinear", "rate_blend=off",
                                                            "gaze_footprint=1", NULL}),
                  tents =
                      quality_of((const char *const[]){"reconstruction=bilinear", "rate_blend=off", NULL}),
                  cubics = quality_of((const char *const[]){"reconstruction=cubic", "rate_blend=off", NULL}),
                  edges = quality_of((const char *const[]){"rate_blend=off", NULL}),
                  defaults = quality_of((const char *const[]){NULL}),
                  pairs = quality_of((const char *const[]){"coarse_samples=2", NULL}),
                  finer = quality_of((const char *const[]){"acuity_slope=0.0155", NULL}),
                  every = quality_of((const char *const[]){"sample_block=1", NULL}),
                  seed = quality_of((const char *const[]){"gaze_rule=seed", NULL}),
                  near = quality_of((const char *const[]){"gaze_rule=seed", "seed_distance=50", NULL});
    assert_true(defaults.rays < 0.4 && every.rays == 1);
    assert_true(widest.seen > tents.seen && tents.seen > edges.seen && cubics.seen > edges.seen);
    assert_true(defaults.seen < 1.1 * edges.seen); /* what hiding borders costs */
    assert_true(finer.seen < defaults.seen && every.seen < 0.7 * defaults.seen);
    assert_true(pairs.rays > 1.5 * defaults.rays && pairs.seen > finer.seen);
    assert_true(near.seen > 1.2 * seed.seen);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(few_rays_are_well_spent)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
