/* From light to the codes of the screen: exposure, curve and dither by their formulas, in any split; the
 * light of the tiles adds up to that of the whole; a still view is toned anew without tracing. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE, KINDS = 2, CHANNELS = 3 };

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera cameras[KINDS]; /* a ray for each pixel; sparse samples round a gaze */

static const gw_features toning =
    GW_FEATURE_TONE | GW_FEATURE_EXPOSURE | GW_FEATURE_DITHER | GW_FEATURE_METERING;

/* With everything compiled in, whatever a state calls for: so there are few kernels. */
static gw_renderer *toning_renderer(void) {
    gw_renderer *out = NULL;
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree,
                                &(gw_renderer_options){.force_features = toning}, &out, &error));
    return out;
}

static int open_stage(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.5, 0.2, 40, 20);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->background[0] = 0.207f;
    scene->background[1] = 0.5f;
    scene->background[2] = 0.0123f;
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=6", "acuity_slope=0.2", "gaze_margin=0",
                                                 "geometry=triangles", "sample_block=2",
                                                 "reconstruction=cubic", NULL},
                           &error));
    renderer = toning_renderer();
    for (int i = 0; i < KINDS; ++i)
        gw_camera_look(&cameras[i], &stage, (const double[]){0.3, 0.4, 2}, (const double[]){0, 0, 0}, 50,
                       SIDE);
    gw_camera_gaze(&cameras[1], 20, 30, 4.0);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static gw_camera toned(const gw_camera *from, float exposure, int tone, int dither) {
    gw_camera camera = *from;
    camera.state.exposure = exposure;
    camera.state.tone = (uint8_t)tone;
    camera.state.dither = (uint8_t)dither;
    return camera;
}

static const gw_rectangle splits[][6] = {
    {{0, 0, 64, 64}},
    {{0, 0, 37, 22}, {37, 0, 27, 22}, {0, 22, 37, 42}, {37, 22, 27, 42}},
    {{0, 0, 21, 33}, {21, 0, 22, 33}, {43, 0, 21, 33}, {0, 33, 21, 31}, {21, 33, 22, 31}, {43, 33, 21, 31}},
};

/* Pixels and counts of a picture that is drawn in tiles. */
static void draw_split(const gw_camera *camera, size_t split, uint8_t *whole, gw_luminance *luminance) {
    static uint8_t tile[PIXELS * 4];
    memset(luminance, 0, sizeof *luminance);
    for (int t = 0; t < 6 && splits[split][t].width; ++t) {
        const gw_rectangle *r = &splits[split][t];
        gw_luminance own;
        check_ok(gw_renderer_frame(renderer, &camera->placement, &camera->plane, r, &camera->state, tile,
                                   NULL, &error));
        gw_renderer_take_luminance(renderer, &own);
        gw_luminance_add(luminance, &own);
        for (uint32_t y = 0; y < r->height; ++y)
            memcpy(whole + (((size_t)r->y + y) * SIDE + (size_t)r->x) * 4, tile + (size_t)y * r->width * 4,
                   (size_t)r->width * 4);
    }
}

static void tiles_of_any_split_make_and_count_the_same(void **state) {
    static uint8_t wanted[PIXELS * 4], pixels[PIXELS * 4];
    (void)state;
    for (int kind = 0; kind < KINDS; ++kind) {
        gw_camera camera = toned(&cameras[kind], 0.7f, GW_TONE_FILMIC, 1);
        camera.state.metering = 1;
        gw_luminance all, sum;
        draw_split(&camera, 0, wanted, &all);
        assert_int_equal(gw_luminance_pixels(&all), PIXELS / 16);
        for (size_t split = 1; split < sizeof splits / sizeof splits[0]; ++split) {
            draw_split(&camera, split, pixels, &sum);
            assert_memory_equal(pixels, wanted, sizeof wanted);
            assert_memory_equal(&sum, &all, sizeof all);
        }
        /* What is counted is light before exposure. */
        camera.state.exposure = -3;
        draw_split(&camera, 0, pixels, &sum);
        assert_memory_equal(&sum, &all, sizeof all);
        assert_true(memcmp(pixels, wanted, sizeof wanted) != 0);
        /* The background alone: two thirds of the pixels are in its bin. */
        double mean;
        assert_int_equal(gw_luminance_mean(&all, &mean), 1);
        print_message("# mean of the light 2^%.2f\n", mean);
        assert_true(mean > -3 && mean < 0);
    }
}

static double filmic(double x) {
    return fmin(1, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

static void exposure_and_curve_follow_their_formulas(void **state) {
    (void)state;
    const gw_camera brighter = toned(&cameras[0], 1.0f, GW_TONE_LINEAR, 0),
                    curved = toned(&cameras[0], -0.5f, GW_TONE_FILMIC, 0);
    uint8_t *plain = gw_camera_take(&cameras[0], renderer, NULL),
            *bright = gw_camera_take(&brighter, renderer, NULL),
            *film = gw_camera_take(&curved, renderer, NULL);
    int worst = 0, clipped = 0;
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        if (i % 4 == 3 || plain[i] == 255 || plain[i] < 32) /* a code says too little there */
            continue;
        const double light = gw_srgb_code_to_linear(plain[i]);
        const int far = abs(gw_srgb_code_from_linear(2 * light) - bright[i]),
                  off = abs(gw_srgb_code_from_linear(filmic(light * sqrt(0.5))) - film[i]);
        worst = far > worst ? far : worst;
        worst = off > worst ? off : worst;
        clipped += bright[i] == 255;
    }
    assert_true(worst <= 2);
    assert_true(clipped > 0);
    free(plain);
    free(bright);
    free(film);
}

/* The shade of a wall of one colour, mean over 64 x 64 pixels, in codes: dithered it is what was meant,
 * rounded it is not. Black and white stay what they are. */
static void dither_keeps_the_mean(void **state) {
    (void)state;
    gw_camera away = cameras[0];
    gw_camera_look(&away, &stage, (const double[]){0, 0, 3}, (const double[]){0, 0, 9}, 50, SIDE);
    const gw_camera dithered = toned(&away, 0, GW_TONE_LINEAR, 1),
                    white = toned(&away, 24, GW_TONE_LINEAR, 1), black = toned(&away, -24, GW_TONE_LINEAR, 1);
    uint8_t *codes = gw_camera_take(&dithered, renderer, NULL),
            *rounded = gw_camera_take(&away, renderer, NULL);
    double naive = 0;
    for (int c = 0; c < CHANNELS; ++c) {
        const double meant = 255 * gw_srgb_from_linear((double)stage.scene->background[c]);
        double sum = 0;
        for (size_t i = 0; i < PIXELS; ++i) {
            sum += codes[4 * i + (size_t)c];
            assert_true(fabs(codes[4 * i + (size_t)c] - meant) < 1);
        }
        assert_true(fabs(sum / PIXELS - meant) <= 1.0 / 64);
        naive = fmax(naive, fabs(rounded[c] - meant));
    }
    assert_true(naive > 0.3);
    free(codes);
    free(rounded);
    codes = gw_camera_take(&white, renderer, NULL);
    rounded = gw_camera_take(&black, renderer, NULL);
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        assert_int_equal(codes[i], 255);
        assert_int_equal(rounded[i], i % 4 == 3 ? 255 : 0);
    }
    free(codes);
    free(rounded);
}

/* Exposure, curve and dither do not belong to the samples: what is kept of a view is shown anew, bit for bit
 * as if it were drawn so from the beginning, and its light is known without counting again. */
static void a_still_view_is_toned_anew_without_rays(void **state) {
    (void)state;
    gw_renderer *fresh = toning_renderer();
    for (int kind = 0; kind < KINDS; ++kind) {
        gw_camera first = cameras[kind];
        first.state.epoch = 1;
        first.state.accumulate = 3;
        first.state.metering = 1;
        gw_camera second = toned(&first, 0.4f, GW_TONE_FILMIC, 1);
        gw_counters none = {0};
        gw_luminance before, after, other;
        gw_renderer_take_luminance(renderer, &before);
        gw_renderer_take_luminance(fresh, &before);
        free(gw_camera_take(&first, renderer, NULL));
        gw_renderer_take_luminance(renderer, &before);
        uint8_t *again = gw_camera_take(&second, renderer, &none),
                *wanted = gw_camera_take(&second, fresh, NULL);
        gw_renderer_take_luminance(renderer, &after);
        gw_renderer_take_luminance(fresh, &other);
        assert_int_equal(none.rays, 0);
        assert_memory_equal(again, wanted, PIXELS * 4);
        assert_int_equal(gw_luminance_pixels(&before), PIXELS / 16);
        assert_memory_equal(&before, &after, sizeof before);
        assert_memory_equal(&before, &other, sizeof before);
        free(again);
        free(wanted);
        /* One sample more, and back to what it was. */
        second.state.accumulate = 4;
        again = gw_camera_take(&second, renderer, NULL);
        wanted = gw_camera_take(&second, fresh, NULL);
        assert_memory_equal(again, wanted, PIXELS * 4);
        free(again);
        free(wanted);
    }
    gw_renderer_destroy(&fresh);
}

/* Compiled in without need: the same bits. */
static void forced_without_need_it_changes_nothing(void **state) {
    (void)state;
    gw_renderer *plain = gw_stage_renderer(&stage);
    for (int kind = 0; kind < KINDS; ++kind) {
        uint8_t *wanted = gw_camera_take(&cameras[kind], plain, NULL),
                *same = gw_camera_take(&cameras[kind], renderer, NULL);
        assert_memory_equal(wanted, same, PIXELS * 4);
        free(wanted);
        free(same);
    }
    gw_renderer_destroy(&plain);
    gw_frame_state called = cameras[0].state;
    assert_true((gw_features_of_frame(&called, 0, 0) & toning) == 0);
    called.metering = called.dither = called.tone = 1;
    assert_true((gw_features_of_frame(&called, 0, 0) & toning) == toning);
    called.debug = GW_DEBUG_LEVELS; /* colours there are numbers */
    assert_true((gw_features_of_frame(&called, 0, 0) & toning) == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_of_any_split_make_and_count_the_same),
        cmocka_unit_test(exposure_and_curve_follow_their_formulas),
        cmocka_unit_test(dither_keeps_the_mean),
        cmocka_unit_test(a_still_view_is_toned_anew_without_rays),
        cmocka_unit_test(forced_without_need_it_changes_nothing),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
