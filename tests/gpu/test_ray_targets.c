/* How few rays a foveated frame takes: counts of the lists that frames are traced from, rims included. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"
#include "tests/support/sample_lists.h"
#include "wall/frames.h"
#include "wall/site.h"

#include <math.h>

static gw_stage stage;
static gw_renderer *renderer;

/* Lists know nothing of the scene. */
static int open_stage(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0, 0, 0}, 1);
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL, (const char *const[]){"octree_depth=2", NULL},
                           &error));
    renderer = gw_stage_renderer(&stage);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static gw_settings settings_of(const char *const *assignments) {
    gw_settings settings = stage.settings;
    for (; *assignments; ++assignments)
        check_ok(gw_settings_assign(&settings, *assignments, &error));
    return settings;
}

/* Rays of all tiles over their pixels, the viewer looking at the wall's centre. */
static double share_of_rays(const gw_layout *layout, const gw_settings *settings) {
    const gw_similarity placement = {.scale = 1000, .rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    uint64_t rays = 0, pixels = 0;
    gw_frame_state state;
    gw_frame_begin(&state, 0, settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&state, layout->eye, layout->centre, settings);
    for (uint32_t i = 0; i < layout->tile_count; ++i) {
        const gw_tile *tile = &layout->tiles[i];
        check_ok(gw_renderer_count_rays(renderer, &placement, &tile->plane, &tile->rectangle, &state, &rays,
                                        &error));
        pixels += (uint64_t)tile->rectangle.width * tile->rectangle.height;
    }
    return (double)rays / (double)pixels;
}

/* One tile of 1024 x 1024 pixels: sharp in a circle whose diameter is 15 % of the width, margin included;
 * squares of 2 x 2 to twice its radius, of 4 x 4 beyond. The acuity that does so: pixels of 1/192 degree, so
 * that the finest period of 1/48 degree takes four and two pixels can share a ray from the circle on; the
 * period doubles once more over the circle's radius. */
static void a_tile_takes_an_eighth_of_its_rays(void **state) {
    enum { SIDE = 1024 };
    const double radius = 0.075 * SIDE, degrees = radius / 192;
    char slope[64], width[64], height[64];
    (void)state;
    snprintf(slope, sizeof slope, "acuity_slope=%.6f", 1.0 / 48 / degrees);
    snprintf(width, sizeof width, "gaze_half_width=%.6f", degrees / 2);
    snprintf(height, sizeof height, "gaze_half_height=%.6f", degrees / 2);
    char margin[64];
    snprintf(margin, sizeof margin, "gaze_margin=%.6f", degrees / 2);
    gw_settings settings =
        settings_of((const char *const[]){slope, width, height, margin, "sample_block=4", "samples=1", NULL});
    const double pixel = 1.0, away = pixel * 192 / tan(acos(-1) / 180);
    gw_layout layout;
    gw_grid grid = {.columns = 1,
                    .rows = 1,
                    .widths = {SIDE},
                    .heights = {SIDE},
                    .pitch = {pixel, pixel},
                    .eye = {0, 0, away}};
    check_ok(gw_layout_grid(&grid, &layout, &error));
    double share = share_of_rays(&layout, &settings);
    print_message("# %s %s %s %s sample_block=4, eye at %.0f pixels: %.2f %% of the rays\n", slope, width,
                  height, margin, away, 100 * share);

    /* The circles are where they should be. */
    gw_frame_state frame;
    gw_frame_begin(&frame, 0, &settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&frame, layout.eye, layout.centre, &settings);
    gw_camera camera = {.plane = layout.tiles[0].plane,
                        .state = frame,
                        .side = SIDE,
                        .placement = {.scale = 1000, .rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    gw_sample_list list = gw_sample_list_take(&camera, renderer, layout.tiles[0].rectangle);
    for (int y = 0; y < SIDE / 8; ++y)
        for (int x = 0; x < SIDE / 8; ++x) {
            double nearest =
                hypot(fmax(fabs(x * 8 + 4.0 - SIDE / 2) - 4, 0), fmax(fabs(y * 8 + 4.0 - SIDE / 2) - 4, 0));
            uint32_t rate = GW_BLOCK_RATE(gw_sample_list_block(&list, x, y));
            uint32_t wanted = nearest < radius - 3                               ? 0
                              : nearest > 2 * radius + 3                         ? 2
                              : nearest > radius + 3 && nearest < 2 * radius - 3 ? 1
                                                                                 : rate;
            assert_int_equal(rate, wanted);
        }
    gw_sample_list_finish(&list);
    assert_true(share <= 0.12);
    assert_true(share > 0.08); /* what circles without blocks would take is 8.9 % */
}

/* 35 panels of 55 inches, 72 megapixels, the viewer at 2 m. */
static void a_wall_of_35_panels_takes_a_twentyfifth(void **state) {
    static const char *const blocks[] = {"sample_block=1", "sample_block=2", "sample_block=4",
                                         "sample_block=8", "sample_block=16"};
    double share[5];
    gw_site site;
    const gw_layout *layout = &site.layout;
    (void)state;
    check_ok(gw_site_load("configs/sites/35-panels.yaml", &site, &error));
    assert_int_equal(layout->tile_count, 35);
    for (int i = 0; i < 5; ++i) {
        gw_settings settings = settings_of((const char *const[]){
            "gaze_half_width=2.5", "gaze_half_height=2.5", "gaze_margin=5", "samples=1", blocks[i], NULL});
        share[i] = share_of_rays(layout, &settings);
        print_message("# %s: %.2f %% of the rays\n", blocks[i], 100 * share[i]);
    }
    assert_true(share[0] == 1.0);
    assert_true(share[3] <= 0.04);
    assert_true(share[4] < 0.8 * share[3]);
    gw_settings settings = settings_of((const char *const[]){NULL});
    print_message("# defaults: %.2f %%\n", 100 * share_of_rays(layout, &settings));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tile_takes_an_eighth_of_its_rays),
        cmocka_unit_test(a_wall_of_35_panels_takes_a_twentyfifth),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
