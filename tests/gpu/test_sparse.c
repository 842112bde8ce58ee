/* Sparse samples: rates by eccentricity, lists without gaps, and pictures that stay pure functions of the
 * wall. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/demo_scene.h"
#include "render/features.h"
#include "tests/support/renders.h"
#include "tests/support/sample_lists.h"

#include <math.h>

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

static gw_sample_list list_of(const gw_camera *from, gw_rectangle rectangle) {
    return gw_sample_list_take(from, renderer, rectangle);
}

static const gw_rectangle whole_square = {0, 0, SIDE, SIDE};

/* 1 at the gaze, never finer farther out along a row, up to the cap. */
static void rates_fall_with_eccentricity(void **state) {
    static const uint32_t reached[] = {0, 1, 2, 3, 4};
    (void)state;
    for (uint8_t most = 0; most < 5; ++most) {
        gw_camera wide = camera;
        uint32_t last = 0;
        wide.state.sample_block = most;
        wide.state.samples = 1; /* so that the cap of a pixel makes a list, too */
        gw_sample_list list = list_of(&wide, (gw_rectangle){0, 0, 40 * 8, SIDE});
        assert_int_equal(GW_BLOCK_RATE(gw_sample_list_block(&list, 30 / 8, 40 / 8)), 0);
        for (int x = 30 / 8; x < 40; ++x) {
            uint32_t rate = GW_BLOCK_RATE(gw_sample_list_block(&list, x, 40 / 8));
            assert_true(rate >= last);
            last = rate;
        }
        assert_int_equal(last, reached[most]);
        gw_sample_list_finish(&list);
    }
}

/* As the same rule in double, but for blocks within rounding of a threshold. */
static void check_rates(const gw_camera *from, size_t *compared, size_t *borderline) {
    gw_sample_list list = list_of(from, (gw_rectangle){-77, 13, 800, 600});
    for (int i = 0; i < list.block.list[3]; ++i) {
        int x = list.block.list[0] / 8 + i % list.block.list[2], near = 0;
        int y = list.block.list[1] / 8 + i / list.block.list[2];
        uint32_t wanted = gw_sample_rate(&list.block, x, y, from->state.sample_block, &near);
        uint32_t got = GW_BLOCK_RATE(list.blocks[i]);
        *compared += 1;
        if (near) {
            *borderline += 1;
            assert_true(abs((int)got - (int)wanted) <= 1);
        } else {
            assert_int_equal(got, wanted);
        }
    }
    gw_sample_list_finish(&list);
}

static void rates_are_those_of_the_rule_in_double(void **state) {
    gw_camera two = camera, second = camera, wide = camera;
    size_t compared = 0, borderline = 0;
    (void)state;
    gw_camera_gaze(&second, 700, 290, 2.0);
    two.state.gazes[1] = second.state.gazes[0];
    two.state.gazes[1].half_width = 9;
    two.state.gaze_count = 2;
    check_rates(&camera, &compared, &borderline);
    check_rates(&two, &compared, &borderline);
    wide.state.sample_block = 4;
    check_rates(&wide, &compared, &borderline);
    two.state.sample_block = 4;
    two.plane.step_x[2] = two.plane.step_x[0]; /* turned away: pixels are narrower than high */
    check_rates(&two, &compared, &borderline);
    print_message("# %zu of %zu blocks within 1e-4 of a threshold\n", borderline, compared);
    assert_true(borderline < compared / 100);
}

/* The sharper of two viewers decides. */
static void every_viewer_counts(void **state) {
    gw_camera two = camera, second = camera;
    (void)state;
    gw_camera_gaze(&second, 100, 90, 5.0);
    two.state.gazes[1] = second.state.gazes[0];
    two.state.gaze_count = 2;
    gw_sample_list both = list_of(&two, whole_square), first = list_of(&camera, whole_square),
                   other = list_of(&second, whole_square);
    for (int i = 0; i < both.block.list[3]; ++i) {
        uint32_t a = GW_BLOCK_RATE(first.blocks[i]), b = GW_BLOCK_RATE(other.blocks[i]);
        assert_int_equal(GW_BLOCK_RATE(both.blocks[i]), a < b ? a : b);
    }
    gw_sample_list_finish(&both);
    gw_sample_list_finish(&first);
    gw_sample_list_finish(&other);
}

static int in_chunk(const gw_sample_list *list, int column, int row) {
    const int32_t *chunk = list->block.chunk, *grid = list->block.list;
    column -= (chunk[0] - grid[0]) / 8;
    row -= (chunk[1] - grid[1]) / 8;
    return column >= 0 && row >= 0 && column < chunk[2] && row < chunk[3] / chunk[2];
}

/* The block at a column and row of the grid lies in the chunk, or pixels of one there read it. */
static int is_read(const gw_sample_list *list, int column, int row) {
    if (in_chunk(list, column, row))
        return 1;
    for (int v = row - 4; v <= row + 4; ++v)
        for (int u = column - 4; u <= column + 4; ++u) {
            if (!in_chunk(list, u, v))
                continue;
            uint32_t word = list->blocks[v * list->block.list[2] + u];
            int reach = GW_BLOCK_RATE(word) == 4 ? 4 : GW_BLOCK_RATE(word) == 0 ? 1 : 2;
            assert_true((word & GW_BLOCK_REACHES) || GW_BLOCK_RATE(word) == 0);
            if ((word & GW_BLOCK_REACHES) && abs(u - column) <= reach && abs(v - row) <= reach)
                return 1;
        }
    return 0;
}

/* Every pixel of the chunk lies in exactly one sample's square, as do those of the rim that are read; blocks
 * point at their own samples. */
static void check_cover(uint8_t most) {
    enum { MOST_WIDE = 256, MOST_HIGH = 256 };
    static uint8_t covered[MOST_HIGH][MOST_WIDE];
    gw_camera from = camera;
    from.state.sample_block = most;
    gw_sample_list list = list_of(&from, (gw_rectangle){24, -16, 9 * 8, 7 * 8});
    const int32_t columns = list.block.list[2], rows = list.block.list[3] / columns;
    assert_true(columns * 8 <= MOST_WIDE && rows * 8 <= MOST_HIGH && list.coarse > 0);
    memset(covered, 0, sizeof covered);
    for (size_t i = 0; i < (size_t)list.groups * 64; ++i) {
        uint32_t word = list.samples[i], side = 1u << GW_SAMPLE_RATE(word);
        assert_int_equal(word == GW_NO_SAMPLE, i >= list.total);
        for (uint32_t y = 0; y < side && word != GW_NO_SAMPLE; ++y)
            for (uint32_t x = 0; x < side; ++x)
                covered[GW_SAMPLE_Y(word) + y][GW_SAMPLE_X(word) + x]++;
    }
    for (int b = 0; b < columns * rows; ++b) {
        int column = b % columns, row = b / columns, wanted = is_read(&list, column, row);
        uint32_t rate = GW_BLOCK_RATE(list.blocks[b]), owner = list.blocks[b];
        if (rate == 4) { /* the whole square is sampled where one of its blocks is read */
            owner = list.blocks[(row & ~1) * columns + (column & ~1)];
            for (int i = 0; i < 4; ++i)
                wanted |= is_read(&list, (column & ~1) + (i & 1), (row & ~1) + (i >> 1));
        }
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                assert_int_equal(covered[row * 8 + y][column * 8 + x], wanted);
        if (!wanted)
            continue;
        uint32_t word = list.samples[GW_BLOCK_FIRST(owner)];
        assert_int_equal(GW_SAMPLE_X(word), rate == 4 ? column * 8 & ~15 : column * 8);
        assert_int_equal(GW_SAMPLE_Y(word), rate == 4 ? row * 8 & ~15 : row * 8);
        assert_int_equal(GW_SAMPLE_RATE(word), rate);
    }
    gw_sample_list_finish(&list);
}

static void lists_cover_every_pixel_once(void **state) {
    (void)state;
    check_cover(3);
    check_cover(4);
}

/* Whole and in uneven pieces: the same bits, rims and all. */
static void check_splits(const gw_camera *from) {
    static const int cuts[] = {0, 1, 37, 64, 120};
    uint8_t *whole = picture(from, renderer, NULL), *piece = calloc(PIXELS, 4);
    assert_non_null(piece);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            gw_rectangle part = {cuts[i], cuts[j], (uint32_t)(cuts[i + 1] - cuts[i]),
                                 (uint32_t)(cuts[j + 1] - cuts[j])};
            check_ok(gw_renderer_frame(renderer, &from->placement, &from->plane, &part, &from->state, piece,
                                       NULL, &error));
            for (uint32_t y = 0; y < part.height; ++y)
                assert_memory_equal(piece + (size_t)y * part.width * 4,
                                    whole + ((size_t)(cuts[j] + (int)y) * SIDE + (size_t)cuts[i]) * 4,
                                    (size_t)part.width * 4);
        }
    free(piece);
    free(whole);
}

static void splits_give_the_same_pixels(void **state) {
    gw_camera several = camera;
    (void)state;
    check_splits(&camera);
    several.state.samples = 2;
    check_splits(&several);
    several.state.samples = 0;
    several.state.coarse_samples = 1;
    several.state.sample_block = 4;
    check_splits(&several);
}

/* The same view with four times the pixels, 16 rays each: the mean of 64 rays for each pixel of `from`. */
static double *reference_of(const gw_camera *from) {
    gw_camera fine = *from;
    const gw_rectangle whole = {0, 0, 2 * SIDE, 2 * SIDE};
    uint8_t *rgba = calloc(4 * PIXELS, 4);
    double *mean = calloc((size_t)PIXELS * 3, sizeof *mean);
    assert_true(rgba && mean);
    for (int i = 0; i < 3; ++i) {
        fine.plane.step_x[i] /= 2;
        fine.plane.step_y[i] /= 2;
    }
    fine.state.samples = 4;
    check_ok(
        gw_renderer_frame(renderer, &fine.placement, &fine.plane, &whole, &fine.state, rgba, NULL, &error));
    for (size_t y = 0; y < 2 * SIDE; ++y)
        for (size_t x = 0; x < 2 * SIDE; ++x)
            for (size_t c = 0; c < 3; ++c)
                mean[(y / 2 * SIDE + x / 2) * 3 + c] +=
                    gw_srgb_code_to_linear(rgba[(y * 2 * SIDE + x) * 4 + c]) / 4;
    free(rgba);
    return mean;
}

static double error_against(const double *reference, const uint8_t *rgba) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS; ++i)
        for (size_t c = 0; c < 3; ++c) {
            double d = gw_srgb_code_to_linear(rgba[i * 4 + c]) - reference[i * 3 + c];
            sum += d * d;
        }
    return sqrt(sum / (3.0 * PIXELS));
}

/* Several rays a pixel come closer to 64 of them, the more the closer, and cost what they promise. */
static void more_rays_come_closer(void **state) {
    double errors[5];
    gw_camera blind = camera;
    (void)state;
    blind.state.gaze_count = 0;
    double *reference = reference_of(&blind);
    for (uint8_t i = 0; i < 5; ++i) {
        gw_counters counters = {0};
        blind.state.samples = i;
        uint8_t *rgba = picture(&blind, renderer, &counters);
        errors[i] = error_against(reference, rgba);
        assert_int_equal(counters.rays, (uint64_t)PIXELS << i);
        assert_int_equal(counters.step_cap_hits + counters.nan_pixels, 0);
        free(rgba);
    }
    print_message("# error of 1, 2, 4, 8, 16 rays a pixel: %.4f %.4f %.4f %.4f %.4f\n", errors[0], errors[1],
                  errors[2], errors[3], errors[4]);
    for (int i = 1; i < 5; ++i)
        assert_true(errors[i] < 0.9 * errors[i - 1]);
    free(reference);
}

static double difference_of(const uint8_t *a, const uint8_t *b) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        double d = gw_srgb_code_to_linear(a[i]) - gw_srgb_code_to_linear(b[i]);
        sum += d * d;
    }
    return sqrt(sum / (3.0 * PIXELS));
}

/* Several rays a coarse square come closer to the mean of eight, and leave sharp blocks alone. */
static void more_rays_a_square_come_closer(void **state) {
    double errors[3];
    uint64_t rays[3];
    gw_camera several = camera;
    const uint32_t at = (40 * SIDE + 30) * 4; /* the gaze */
    (void)state;
    several.state.coarse_samples = 3;
    uint8_t *reference = picture(&several, renderer, NULL);
    for (uint8_t i = 0; i < 3; ++i) {
        gw_counters counters = {0};
        several.state.coarse_samples = i;
        uint8_t *rgba = picture(&several, renderer, &counters);
        errors[i] = difference_of(reference, rgba);
        rays[i] = counters.rays;
        assert_memory_equal(reference + at, rgba + at, 4);
        free(rgba);
    }
    print_message("# difference to 8 of 1, 2, 4 rays a square: %.4f %.4f %.4f\n", errors[0], errors[1],
                  errors[2]);
    assert_true(errors[1] < 0.9 * errors[0] && errors[2] < 0.8 * errors[1]);
    /* Squares, then squares twice: what is not a square's has one ray. */
    assert_true(rays[2] - rays[1] == 2 * (rays[1] - rays[0]) && rays[1] > rays[0]);
    free(reference);
}

/* Outside the gaze a ray serves many pixels, whatever a sharp pixel has: blocks that touch no sharp one keep
 * their bits. */
static void coarse_blocks_stay_as_they_are(void **state) {
    gw_camera several = camera;
    gw_counters one = {0}, many = {0};
    size_t kept = 0;
    (void)state;
    several.state.samples = 3;
    uint8_t *plain = picture(&camera, renderer, &one), *finer = picture(&several, renderer, &many);
    gw_frame_block block = block_of(&camera);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            int sharp_near = 0;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    sharp_near |= gw_sample_rate(&block, x / 8 + i, y / 8 + j, 3, NULL) == 0;
            size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            if (sharp_near)
                continue;
            assert_memory_equal(plain + at, finer + at, 4);
            kept++;
        }
    assert_true(kept > PIXELS / 2);
    assert_true(many.rays > 2 * one.rays && many.rays < 8 * one.rays);
    free(plain);
    free(finer);
}

/* Red minus blue of a pixel: warm where a map says sharp. */
static int warmth(const uint8_t *rgba, int x, int y) {
    const uint8_t *pixel = rgba + ((size_t)y * SIDE + (size_t)x) * 4;
    return pixel[0] - pixel[2];
}

/* Maps over the picture are warm at the gaze and cold far from it, and pure functions of the wall like it. */
static void maps_show_where_it_is_sharp(void **state) {
    static const uint8_t views[] = {GW_DEBUG_RATES, GW_DEBUG_ECCENTRICITY, GW_DEBUG_FOOTPRINT};
    uint8_t *plain = picture(&camera, renderer, NULL);
    (void)state;
    for (size_t i = 0; i < sizeof views; ++i) {
        gw_camera map = camera, blind = camera;
        map.state.debug = blind.state.debug = views[i];
        check_splits(&map);
        uint8_t *shown = picture(&map, renderer, NULL);
        assert_true(warmth(shown, 30, 40) - warmth(plain, 30, 40) > 30);
        assert_true(warmth(shown, 118, 118) - warmth(plain, 118, 118) < -30);
        blind.state.gaze_count = 0;
        free(picture(&blind, renderer, NULL));
        free(shown);
    }
    free(plain);
}

/* A tile of one block's width and more rows than a sample's word could count. */
static void a_tall_tile_is_drawn_in_pieces(void **state) {
    enum { TALL = 9000, FROM = 8400 };
    const gw_rectangle column = {0, 0, 8, TALL}, end = {0, FROM, 8, TALL - FROM};
    uint8_t *whole = calloc(8 * TALL, 4), *piece = calloc(8 * (TALL - FROM), 4);
    gw_camera tall = camera;
    (void)state;
    assert_true(whole && piece);
    tall.state.samples = 1;
    check_ok(
        gw_renderer_frame(renderer, &tall.placement, &tall.plane, &column, &tall.state, whole, NULL, &error));
    check_ok(
        gw_renderer_frame(renderer, &tall.placement, &tall.plane, &end, &tall.state, piece, NULL, &error));
    assert_memory_equal(whole + (size_t)8 * FROM * 4, piece, (size_t)8 * (TALL - FROM) * 4);
    free(whole);
    free(piece);
}

/* Where a block has a ray per pixel and its sharpness has not begun to fall, sparse and full pictures agree
 * to the bit; elsewhere they differ little on average, and far fewer rays were traced. */
static void check_sharp_blocks(const gw_camera *from, size_t least_sharp) {
    gw_camera full = *from;
    gw_counters few = {0}, every = {0};
    size_t sharp = 0;
    full.state.sample_block = 0;
    uint8_t *sparse = picture(from, renderer, &few), *dense = picture(&full, renderer, &every);
    gw_sample_list list = list_of(from, whole_square);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            uint32_t word = gw_sample_list_block(&list, x / 8, y / 8);
            if (GW_BLOCK_RATE(word) > 0 || (word & GW_BLOCK_REACHES))
                continue;
            assert_memory_equal(sparse + at, dense + at, 4);
            sharp++;
        }
    double difference = gw_mean_difference(sparse, dense, PIXELS);
    print_message("# %zu sharp pixels, %llu rays for %d pixels, mean difference %.2f/255\n", sharp,
                  (unsigned long long)few.rays, PIXELS, difference);
    assert_true(sharp >= least_sharp && sharp < PIXELS / 2);
    assert_int_equal(every.rays, PIXELS);
    assert_true(few.rays < 3 * PIXELS / 4);
    assert_true(difference > 0.1 && difference < 20);
    gw_sample_list_finish(&list);
    free(sparse);
    free(dense);
}

static void sharp_blocks_are_those_of_the_full_picture(void **state) {
    gw_camera abrupt = camera, wide = camera;
    (void)state;
    abrupt.state.rate_blend = 0;
    check_sharp_blocks(&abrupt, 200);
    wide.state.gazes[0].half_width = wide.state.gazes[0].half_height = 12;
    check_sharp_blocks(&wide, 200);
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

/* What stands in the buffers of another frame, of more rays, is no ray of this one. */
static void rays_that_are_skipped_cast_no_shadows(void **state) {
    gw_renderer *fresh = gw_stage_renderer(&stage);
    gw_camera many = camera;
    gw_counters first = {0}, again = {0};
    (void)state;
    many.state.gaze_count = 0;
    many.state.samples = 2;
    free(picture(&camera, fresh, &first));
    free(picture(&many, fresh, NULL));
    free(picture(&camera, fresh, &again));
    assert_true(first.shadow_rays > 0 && first.shadow_rays < 2 * first.rays);
    assert_int_equal(first.shadow_rays, again.shadow_rays);
    gw_renderer_destroy(&fresh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_fall_with_eccentricity),
        cmocka_unit_test(rates_are_those_of_the_rule_in_double),
        cmocka_unit_test(every_viewer_counts),
        cmocka_unit_test(lists_cover_every_pixel_once),
        cmocka_unit_test(splits_give_the_same_pixels),
        cmocka_unit_test(more_rays_come_closer),
        cmocka_unit_test(more_rays_a_square_come_closer),
        cmocka_unit_test(coarse_blocks_stay_as_they_are),
        cmocka_unit_test(maps_show_where_it_is_sharp),
        cmocka_unit_test(a_tall_tile_is_drawn_in_pieces),
        cmocka_unit_test(sharp_blocks_are_those_of_the_full_picture),
        cmocka_unit_test(forced_without_need_changes_nothing),
        cmocka_unit_test(rays_that_are_skipped_cast_no_shadows),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
