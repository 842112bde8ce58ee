/* Accumulation of a still view: equal (view, number of samples) gives equal pictures in any history and any
 * split, and more samples come closer to the true picture. Without it, a frame knows nothing of the one
 * before.
 */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/demo_scene.h"
#include "render/features.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 80, PIXELS = SIDE * SIDE, KINDS = 3, SAMPLES = 5 };

static gw_stage stage;
/* Sparse samples, several rays in sharp pixels, and a ray for each pixel. */
static gw_camera cameras[KINDS];
static gw_renderer *first_tile, *other_tile, *suspending; /* the last with rays that are suspended early */

static gw_renderer *renderer_of(uint32_t loop_budget, uint32_t forced) {
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.loop_budget = loop_budget, .force_features = forced};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &renderer, &error));
    return renderer;
}

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=8", "acuity_slope=0.2", "gaze_margin=0", NULL},
                           &error));
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    for (int i = 0; i < KINDS; ++i) {
        gw_camera_look(&cameras[i], &stage, view->eye, view->look_at, 60, SIDE);
        gw_camera_gaze(&cameras[i], 30, 40, 5.0);
        cameras[i].state.epoch = 1;
    }
    cameras[1].state.samples = 1;
    cameras[2].state.gaze_count = 0;
    first_tile = renderer_of(0, 0);
    other_tile = renderer_of(0, 0);
    suspending = renderer_of(40, 0);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&first_tile);
    gw_renderer_destroy(&other_tile);
    gw_renderer_destroy(&suspending);
    gw_stage_close(&stage);
    return 0;
}

static uint8_t *samples_of(const gw_camera *from, uint16_t samples, gw_renderer *by, gw_counters *counters) {
    gw_camera camera = *from;
    camera.state.accumulate = samples;
    camera.state.frame += samples;
    return gw_camera_take(&camera, by, counters);
}

static void check_same(uint8_t *a, const uint8_t *b) {
    assert_memory_equal(a, b, PIXELS * 4);
    free(a);
}

/* Another view of the same epoch and number: what is kept must not be taken for it. */
static void look_elsewhere(const gw_camera *from, uint16_t samples, gw_renderer *by) {
    gw_camera other = *from;
    other.state.eye[0] += 30.0;
    free(samples_of(&other, samples, by, NULL));
}

/* Walked one by one, with samples left out, backwards, from the middle, after another view: the same bits;
 * and each frame traces only the samples that are lacking. */
static void any_history_gives_the_same_picture(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; ++kind) {
        const gw_camera *from = &cameras[kind];
        uint8_t *wanted[SAMPLES + 1] = {0};
        uint64_t rays = 0;
        for (uint16_t n = 1; n <= SAMPLES; ++n) {
            gw_counters counters = {0};
            wanted[n] = samples_of(from, n, first_tile, &counters);
            assert_true(n == 1 || counters.rays == rays);
            assert_true(n == 1 || memcmp(wanted[n], wanted[n - 1], PIXELS * 4) != 0);
            rays = counters.rays;
        }
        gw_counters none = {0}, all = {0}, suspended = {0};
        check_same(samples_of(from, SAMPLES, first_tile, &none), wanted[SAMPLES]);
        assert_int_equal(none.rays, 0);
        check_same(samples_of(from, 2, first_tile, NULL), wanted[2]);
        check_same(samples_of(from, 4, first_tile, NULL), wanted[4]);
        look_elsewhere(from, 3, first_tile);
        check_same(samples_of(from, 4, first_tile, NULL), wanted[4]);
        check_same(samples_of(from, 3, other_tile, NULL), wanted[3]);
        check_same(samples_of(from, SAMPLES, other_tile, NULL), wanted[SAMPLES]);
        look_elsewhere(from, SAMPLES, other_tile);
        check_same(samples_of(from, SAMPLES, other_tile, &all), wanted[SAMPLES]);
        assert_int_equal(all.rays, SAMPLES * rays);
        assert_int_equal(all.step_cap_hits + all.nan_pixels, 0);
        check_same(samples_of(from, SAMPLES, suspending, &suspended), wanted[SAMPLES]);
        assert_true(suspended.resumed > 0);
        for (int n = 0; n <= SAMPLES; ++n)
            free(wanted[n]);
    }
}

/* One of four tiles, drawn sample by sample; it is started again after so many of them, if any. */
static void check_tile(const gw_camera *from, const gw_rectangle *r, uint16_t restart, const uint8_t *whole) {
    gw_camera camera = *from;
    gw_renderer *fresh = NULL;
    uint8_t *piece = calloc((size_t)r->width * r->height, 4);
    assert_non_null(piece);
    for (uint16_t n = 1; n <= 4; ++n) {
        if (n == restart)
            fresh = renderer_of(0, 0);
        camera.state.accumulate = n;
        check_ok(gw_renderer_frame(fresh ? fresh : other_tile, &camera.placement, &camera.plane, r,
                                   &camera.state, piece, NULL, &error));
    }
    for (uint32_t y = 0; y < r->height; ++y)
        assert_memory_equal(piece + (size_t)y * r->width * 4,
                            whole + (((size_t)r->y + y) * SIDE + (size_t)r->x) * 4, (size_t)r->width * 4);
    free(piece);
    gw_renderer_destroy(&fresh);
}

/* Four uneven tiles, of which one is started again on the way, and one process for all. */
static void any_split_gives_the_same_picture(void **state) {
    static const gw_rectangle parts[4] = {{0, 0, 37, 56}, {37, 0, 43, 56}, {0, 56, 37, 24}, {37, 56, 43, 24}};
    (void)state;
    for (int kind = 0; kind < KINDS; ++kind) {
        uint8_t *whole = samples_of(&cameras[kind], 4, first_tile, NULL);
        for (int part = 0; part < 4; ++part)
            check_tile(&cameras[kind], &parts[part], part == kind ? 3 : 0, whole);
        free(whole);
    }
}

/* A rectangle of several chunks: each has sums of its own. */
static void chunks_keep_their_own_sums(void **state) {
    enum { WIDE = 400, HIGH = 360 }; /* more rays than a chunk has on software GL */
    const gw_rectangle all = {0, 0, WIDE, HIGH}, end = {0, HIGH - 20, WIDE, 20};
    gw_camera camera = cameras[2];
    uint8_t *whole = calloc((size_t)WIDE * HIGH, 4), *piece = calloc((size_t)WIDE * 20, 4);
    (void)state;
    assert_true(whole && piece);
    for (int i = 0; i < 3; ++i) {
        camera.plane.step_x[i] *= (double)SIDE / WIDE;
        camera.plane.step_y[i] *= (double)SIDE / WIDE;
    }
    for (uint16_t n = 1; n <= 3; ++n) {
        camera.state.accumulate = n;
        check_ok(gw_renderer_frame(first_tile, &camera.placement, &camera.plane, &all, &camera.state, whole,
                                   NULL, &error));
    }
    check_ok(gw_renderer_frame(other_tile, &camera.placement, &camera.plane, &end, &camera.state, piece, NULL,
                               &error));
    assert_memory_equal(whole + (size_t)(HIGH - 20) * WIDE * 4, piece, (size_t)WIDE * 20 * 4);
    free(whole);
    free(piece);
}

/* The first sample is the picture without accumulation, and nothing is kept for frames without it. */
static void one_sample_is_the_plain_picture(void **state) {
    (void)state;
    gw_renderer *plain = renderer_of(0, 0), *forced = renderer_of(0, GW_FEATURE_ACCUMULATE);
    for (int kind = 0; kind < KINDS; ++kind) {
        gw_camera camera = cameras[kind];
        camera.state.epoch = 0;
        uint8_t *off = samples_of(&camera, 1, plain, NULL);
        check_same(samples_of(&cameras[kind], 1, first_tile, NULL), off);
        check_same(samples_of(&camera, 1, forced, NULL), off);
        check_same(samples_of(&camera, 0, plain, NULL), off);
        free(off);
    }
    assert_true(gw_renderer_bytes(forced) > gw_renderer_bytes(plain));
    gw_renderer_destroy(&plain);
    gw_renderer_destroy(&forced);
}

/* Off: a still gaze gives a still picture, and after a jump nothing is left of what was before. */
static void without_it_frames_stand_alone(void **state) {
    gw_camera here = cameras[0], there = cameras[0];
    (void)state;
    here.state.epoch = there.state.epoch = 0;
    gw_camera_gaze(&there, 80, 70, 5.0);
    gw_renderer *cold = renderer_of(0, 0);
    uint8_t *first = samples_of(&here, 1, first_tile, NULL), *second = samples_of(&there, 1, cold, NULL);
    check_same(samples_of(&here, 1, first_tile, NULL), first);
    check_same(samples_of(&there, 1, first_tile, NULL), second);
    assert_memory_not_equal(first, second, PIXELS * 4);
    free(first);
    free(second);
    gw_renderer_destroy(&cold);
}

/* The view with four times the pixels and 16 rays in each: 64 rays for every pixel, in linear light. */
static double *reference_of(const gw_camera *from, gw_renderer *by) {
    gw_camera fine = *from;
    const gw_rectangle all = {0, 0, 2 * SIDE, 2 * SIDE};
    uint8_t *rgba = calloc((size_t)4 * PIXELS, 4);
    double *mean = calloc((size_t)PIXELS * 3, sizeof *mean);
    assert_true(rgba && mean);
    for (int i = 0; i < 3; ++i) {
        fine.plane.step_x[i] /= 2;
        fine.plane.step_y[i] /= 2;
    }
    fine.state.gaze_count = fine.state.epoch = 0;
    fine.state.samples = 4;
    fine.state.accumulate = 1;
    check_ok(gw_renderer_frame(by, &fine.placement, &fine.plane, &all, &fine.state, rgba, NULL, &error));
    for (size_t y = 0; y < 2 * SIDE; ++y)
        for (size_t x = 0; x < 2 * SIDE; ++x)
            for (size_t c = 0; c < 3; ++c)
                mean[(y / 2 * SIDE + x / 2) * 3 + c] +=
                    gw_srgb_code_to_linear(rgba[(y * 2 * SIDE + x) * 4 + c]) / 4;
    free(rgba);
    return mean;
}

/* Root mean square over squares of `block` pixels, whose means are compared in linear light. */
static double error_of(const double *reference, const uint8_t *rgba, size_t block) {
    const size_t side = SIDE / block;
    double sum = 0;
    for (size_t i = 0; i < side * side * 3; ++i) {
        double difference = 0;
        for (size_t p = 0; p < block * block; ++p) {
            size_t x = i / 3 % side * block + p % block, y = i / 3 / side * block + p / block;
            difference += gw_srgb_code_to_linear(rgba[(y * SIDE + x) * 4 + i % 3]) -
                          reference[(y * SIDE + x) * 3 + i % 3];
        }
        sum += difference * difference / (double)(block * block * block * block);
    }
    return sqrt(sum / (double)(side * side * 3));
}

/* With a ray for each pixel the error falls to nothing. Sparse blocks stay blurred as their size has it, but
 * their means lose what the place of a single ray made wrong. */
static void more_samples_come_closer(void **state) {
    static const double left[KINDS] = {0.5, 0.5, 0.4};
    double *reference = reference_of(&cameras[2], first_tile);
    (void)state;
    for (int kind = 0; kind < KINDS; ++kind) {
        gw_camera exact = cameras[kind];
        double first = 0, last = 0;
        exact.state.tau = 0;
        for (uint16_t n = 1; n <= 16; n = (uint16_t)(2 * n)) {
            uint8_t *rgba = samples_of(&exact, n, first_tile, NULL);
            double error = error_of(reference, rgba, kind < 2 ? 8 : 1);
            print_message("# kind %d, %d samples: error %.5f\n", kind, n, error);
            assert_true(n == 1 || error < 1.1 * last);
            first = n == 1 ? error : first;
            last = error;
            free(rgba);
        }
        assert_true(last < left[kind] * first);
    }
    free(reference);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_history_gives_the_same_picture),
        cmocka_unit_test(any_split_gives_the_same_picture),
        cmocka_unit_test(chunks_keep_their_own_sums),
        cmocka_unit_test(one_sample_is_the_plain_picture),
        cmocka_unit_test(without_it_frames_stand_alone),
        cmocka_unit_test(more_samples_come_closer),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
