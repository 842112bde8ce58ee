/* Sparse samples: rates by eccentricity, lists without gaps, and pictures that stay pure functions of the
 * wall. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "render/features.h"
#include "render/sparse.h"
#include "tests/support/renders.h"

enum { SIDE = 120, PIXELS = SIDE * SIDE };

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera; /* acuity that falls so fast that all rates occur in a small picture */

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=8", "tau=1", "acuity_slope=0.2",
                                                 "gaze_margin=0", "sample_block=8", NULL},
                           &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&camera, &stage, view->eye, view->look_at, 60, SIDE);
    gw_camera_gaze(&camera, 30, 40, 5.0);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static gw_frame_block block_of(const gw_camera *from) {
    gw_frame_block block;
    check_ok(gw_frame_block_fill(stage.scene, stage.octree, &from->placement, &from->plane, &from->state,
                                 &block, NULL, &error));
    return block;
}

static uint8_t *picture(const gw_camera *from, gw_renderer *by, gw_counters *counters) {
    uint8_t *rgba = calloc(PIXELS, 4);
    assert_non_null(rgba);
    check_ok(gw_camera_picture(from, by, rgba, counters, &error));
    return rgba;
}

/* 1 at the gaze, never finer farther out along a row, up to the cap; 1 everywhere without a gaze. */
static void rates_fall_with_eccentricity(void **state) {
    gw_frame_block block = block_of(&camera);
    uint32_t last = 0;
    (void)state;
    assert_int_equal(gw_sparse_rate(&block, 30 / 8, 40 / 8, 3), 0);
    for (int32_t x = 30 / 8; x < 40; ++x) {
        uint32_t rate = gw_sparse_rate(&block, x, 40 / 8, 3);
        assert_true(rate >= last);
        last = rate;
        for (uint32_t most = 0; most < 3; ++most)
            assert_int_equal(gw_sparse_rate(&block, x, 40 / 8, most), rate < most ? rate : most);
    }
    assert_int_equal(last, 3);
    gw_camera blind = camera;
    blind.state.gaze_count = 0;
    block = block_of(&blind);
    assert_int_equal(gw_sparse_rate(&block, 100, 5, 3), 0);
}

/* The sharper of two viewers decides. */
static void every_viewer_counts(void **state) {
    gw_camera two = camera, second = camera;
    (void)state;
    gw_camera_gaze(&second, 100, 90, 5.0);
    two.state.gazes[1] = second.state.gazes[0];
    two.state.gaze_count = 2;
    gw_frame_block both = block_of(&two), first = block_of(&camera), other = block_of(&second);
    for (int32_t y = 0; y < 15; ++y)
        for (int32_t x = 0; x < 15; ++x) {
            uint32_t a = gw_sparse_rate(&first, x, y, 3), b = gw_sparse_rate(&other, x, y, 3);
            assert_int_equal(gw_sparse_rate(&both, x, y, 3), a < b ? a : b);
        }
}

/* Every pixel of chunk and rim lies in exactly one sample's square, and blocks point at their own samples. */
static void lists_cover_every_pixel_once(void **state) {
    enum { COLUMNS = 9, ROWS = 7, WIDE = (COLUMNS + 2) * 8, HIGH = (ROWS + 2) * 8 };
    static uint8_t covered[HIGH][WIDE];
    gw_sparse sparse = {0};
    gw_frame_block block = block_of(&camera);
    (void)state;
    check_ok(gw_sparse_list(&sparse, &block, 3, -2, COLUMNS, ROWS, 3, &error));
    assert_int_equal(sparse.block_count, (COLUMNS + 2) * (ROWS + 2));
    assert_int_equal(sparse.sample_count % 64, 0);
    for (size_t i = 0; i < sparse.sample_count; ++i) {
        uint32_t word = sparse.samples[i], side = 1u << (word >> 28 & 3u);
        if (word == GW_NO_SAMPLE) {
            assert_true(i >= sparse.real_samples);
            continue;
        }
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                covered[(word >> 14 & 0x3fffu) + y][(word & 0x3fffu) + x]++;
    }
    for (int y = 0; y < HIGH; ++y)
        for (int x = 0; x < WIDE; ++x)
            assert_int_equal(covered[y][x], 1);
    for (size_t b = 0; b < sparse.block_count; ++b) {
        uint32_t word = sparse.samples[GW_BLOCK_FIRST(sparse.blocks[b])];
        assert_int_equal((word & 0x3fffu) / 8, b % (COLUMNS + 2));
        assert_int_equal((word >> 14 & 0x3fffu) / 8, b / (COLUMNS + 2));
        assert_int_equal(word >> 28 & 3u, GW_BLOCK_RATE(sparse.blocks[b]));
    }
    gw_sparse_finish(&sparse);
}

/* Whole and in uneven pieces: the same bits, rims and all. */
static void splits_give_the_same_pixels(void **state) {
    static const int cuts[] = {0, 1, 37, 64, 120};
    uint8_t *whole = picture(&camera, renderer, NULL), *piece = calloc(PIXELS, 4);
    (void)state;
    assert_non_null(piece);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            gw_rectangle part = {cuts[i], cuts[j], (uint32_t)(cuts[i + 1] - cuts[i]),
                                 (uint32_t)(cuts[j + 1] - cuts[j])};
            check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, &part, &camera.state,
                                       piece, NULL, &error));
            for (uint32_t y = 0; y < part.height; ++y)
                assert_memory_equal(piece + (size_t)y * part.width * 4,
                                    whole + ((size_t)(cuts[j] + (int)y) * SIDE + (size_t)cuts[i]) * 4,
                                    (size_t)part.width * 4);
        }
    free(piece);
    free(whole);
}

/* Where a block has a ray per pixel, sparse and full pictures agree to the bit; elsewhere they differ little
 * on average, and far fewer rays were traced. */
static void sharp_blocks_are_those_of_the_full_picture(void **state) {
    gw_camera full = camera;
    gw_counters few = {0}, all = {0};
    size_t sharp = 0;
    (void)state;
    full.state.sample_block = 0;
    uint8_t *sparse = picture(&camera, renderer, &few), *dense = picture(&full, renderer, &all);
    gw_frame_block block = block_of(&camera);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            if (gw_sparse_rate(&block, x / 8, y / 8, 3) > 0)
                continue;
            assert_memory_equal(sparse + at, dense + at, 4);
            sharp++;
        }
    double difference = gw_mean_difference(sparse, dense, PIXELS);
    print_message("%zu sharp pixels, %llu rays for %d pixels, mean difference %.2f/255\n", sharp,
                  (unsigned long long)few.rays, PIXELS, difference);
    assert_true(sharp > 200 && sharp < PIXELS / 2);
    assert_int_equal(all.rays, PIXELS);
    assert_true(few.rays < PIXELS / 2);
    assert_true(difference > 0.1 && difference < 20);
    free(sparse);
    free(dense);
}

/* A frame that calls for no sparse samples gives the same bits when they are compiled in all the same. */
static void forced_without_need_changes_nothing(void **state) {
    gw_renderer *forced = NULL;
    gw_renderer_options options = {.force_features = GW_FEATURE_SPARSE};
    gw_camera blind = camera;
    (void)state;
    blind.state.gaze_count = 0;
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &forced, &error));
    uint8_t *plain = picture(&blind, renderer, NULL), *extra = picture(&blind, forced, NULL);
    assert_memory_equal(plain, extra, PIXELS * 4);
    free(plain);
    free(extra);
    gw_renderer_destroy(&forced);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_fall_with_eccentricity),
        cmocka_unit_test(every_viewer_counts),
        cmocka_unit_test(lists_cover_every_pixel_once),
        cmocka_unit_test(splits_give_the_same_pixels),
        cmocka_unit_test(sharp_blocks_are_those_of_the_full_picture),
        cmocka_unit_test(forced_without_need_changes_nothing),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
