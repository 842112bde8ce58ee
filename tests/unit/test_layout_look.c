/* Looking at a wall: rays meet the tile that is nearest, rings lie on their cone, and every point of the
 * picture with bezels means a pixel. */
#include "tests/support/check.h"

#include "render/vector3.h"
#include "wall/layout_look.h"

#include <math.h>

/* Two tiles of 100 x 50 px at 10 mm, 20 mm of bezel on each side. */
static gw_layout make_wall(void) {
    const gw_grid grid = {.columns = 2,
                          .rows = 1,
                          .widths = {100, 100},
                          .heights = {50},
                          .pitch = {10, 10},
                          .left = 20,
                          .right = 20,
                          .top = 20,
                          .bottom = 20,
                          .eye = {0, 0, 1500}};
    gw_layout layout;
    check_ok(gw_layout_grid(&grid, &layout, &error));
    return layout;
}

static void rays_meet_what_is_there(void **state) {
    const gw_layout layout = make_wall();
    const double eye[3] = {0, 0, 1500}, ahead[3] = {0, 0, -1}, away[3] = {0, 0, 1}, beside[3] = {0, 1, 0};
    const double left[3] = {-520, 0, -1500}; /* to the middle of the left tile */
    double framed[2], distance;
    uint32_t tile = 9;
    (void)state;
    assert_false(gw_layout_meet(&layout, eye, ahead, &tile, framed, &distance)); /* between the tiles */
    assert_false(gw_layout_meet(&layout, eye, away, &tile, framed, &distance));
    assert_false(gw_layout_meet(&layout, eye, beside, &tile, framed, &distance));
    assert_true(gw_layout_meet(&layout, eye, left, &tile, framed, &distance));
    assert_int_equal(tile, 0);
    assert_true(fabs(distance - 1) < 1e-12 && fabs(framed[0] - layout.tiles[0].framed[0] - 50) < 1e-9 &&
                fabs(framed[1] - layout.tiles[0].framed[1] - 25) < 1e-9);
}

/* Of two tiles one behind the other, the near one. */
static void the_nearest_tile_counts(void **state) {
    gw_layout layout = make_wall();
    const double eye[3] = {-520, 0, 1500}, ahead[3] = {0, 0, -1};
    double framed[2], distance;
    uint32_t tile = 9;
    (void)state;
    for (int near = 0; near < 2; near++) {
        layout.tiles[1].plane = layout.tiles[0].plane;
        layout.tiles[1].rectangle = layout.tiles[0].rectangle;
        layout.tiles[0].plane.corner[2] = near ? 0 : 100;
        layout.tiles[1].plane.corner[2] = near ? 100 : 0;
        assert_true(gw_layout_meet(&layout, eye, ahead, &tile, framed, &distance));
        assert_int_equal(tile, near);
        assert_true(fabs(distance - 1400) < 1e-9);
    }
}

static void a_ring_lies_on_its_cone(void **state) {
    const gw_layout layout = make_wall();
    const gw_gaze gaze = {
        .eye = {-520, 0, 1500}, .direction = {0, 0, -1}, .up = {0, 1, 0}, .half_width = 10, .half_height = 5};
    gw_ring_point points[GW_RING_POINTS];
    double widest = 0, highest = 0;
    (void)state;
    assert_int_equal(gw_gaze_ring(&layout, &gaze, points), GW_RING_POINTS);
    for (int i = 0; i < GW_RING_POINTS; i++) {
        const double x = 10 * (points[i].framed[0] - layout.tiles[0].framed[0] - 50),
                     y = 10 * (points[i].framed[1] - layout.tiles[0].framed[1] - 25);
        const double a = 1500 * tan(10 * M_PI / 180), b = 1500 * tan(5 * M_PI / 180);
        assert_true(fabs(x * x / (a * a) + y * y / (b * b) - 1) < 1e-5);
        widest = fmax(widest, x / a);
        highest = fmax(highest, y / b);
    }
    assert_true(widest > 0.999 && highest > 0.999);
    gw_gaze behind = gaze;
    behind.direction[2] = 1;
    assert_int_equal(gw_gaze_ring(&layout, &behind, points), 0);
}

static void every_point_means_a_pixel(void **state) {
    const gw_layout layout = make_wall();
    const gw_tile *right = &layout.tiles[1];
    double pixel[2];
    (void)state;
    const struct {
        double framed[2], pixel[2];
    } cases[] = {
        {{layout.tiles[0].framed[0] + 3.5, layout.tiles[0].framed[1] + 4}, {3.5, 4}},
        {{right->framed[0] + 10, right->framed[1] + 20}, {110, 20}},
        {{right->framed[0] - 1, right->framed[1] + 20}, {100, 20}}, /* bezel: the nearer tile's edge */
        {{layout.tiles[0].framed[0] + 101, right->framed[1] + 7}, {100, 7}},
        {{-1000, -1000}, {0, 0}},
        {{1e6, 1e6}, {200, 50}}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        gw_layout_framed_pixel(&layout, cases[i].framed, pixel);
        assert_true(fabs(pixel[0] - cases[i].pixel[0]) < 1e-9 && fabs(pixel[1] - cases[i].pixel[1]) < 1e-9);
        double point[3];
        check_ok(gw_layout_point(&layout, pixel, point, &error));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_what_is_there),
        cmocka_unit_test(the_nearest_tile_counts),
        cmocka_unit_test(a_ring_lies_on_its_cone),
        cmocka_unit_test(every_point_means_a_pixel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
