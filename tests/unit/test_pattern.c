/* Test patterns: lines of the grid run on from tile to tile to half a pixel, whatever the pixels' sizes, the
 * bezels and the angles; greys and stripes; names. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "wall/pattern.h"

#include <math.h>

enum { MOST_LINES = 64 };

static double light_at(const gw_tile *tile, const uint8_t *pixels, uint32_t x, uint32_t y) {
    const uint8_t *pixel = pixels + ((size_t)y * tile->rectangle.width + x) * 4;
    return gw_srgb_code_to_linear(pixel[0]) + gw_srgb_code_to_linear(pixel[1]) +
           gw_srgb_code_to_linear(pixel[2]);
}

static void point(const gw_tile *tile, double x, double y, double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = tile->plane.corner[i] + (tile->rectangle.x + x) * tile->plane.step_x[i] +
                 (tile->rectangle.y + y) * tile->plane.step_y[i];
}

/* Heights (wall space's y) of the bright lines in a column of a tile: middles of their light. */
static uint32_t lines_in_column(const gw_tile *tile, const uint8_t *pixels, uint32_t column,
                                double heights[MOST_LINES]) {
    uint32_t count = 0;
    const double ground = 0.05, bright = 0.7;
    for (uint32_t y = 4; y + 4 < tile->rectangle.height; y++) {
        if (light_at(tile, pixels, column, y) < bright ||
            light_at(tile, pixels, column, y) < light_at(tile, pixels, column, y - 1) ||
            light_at(tile, pixels, column, y) <= light_at(tile, pixels, column, y + 1))
            continue;
        double sum = 0, weight = 0, at[3];
        for (uint32_t row = y - 2; row <= y + 2; row++) {
            const double light = fmax(0, light_at(tile, pixels, column, row) - ground);
            sum += light * (row + 0.5);
            weight += light;
        }
        point(tile, column + 0.5, sum / weight, at);
        assert_true(count < MOST_LINES);
        heights[count++] = at[1];
    }
    return count;
}

static gw_tile tile_of(const char *name, const double corners[3][3], uint32_t width, uint32_t height) {
    gw_tile tile = {.rectangle = {0, 0, width, height}};
    snprintf(tile.name, sizeof tile.name, "%s", name);
    for (int i = 0; i < 3; i++) {
        tile.plane.corner[i] = corners[0][i];
        tile.plane.step_x[i] = (corners[1][i] - corners[0][i]) / width;
        tile.plane.step_y[i] = (corners[2][i] - corners[0][i]) / height;
    }
    return tile;
}

/* Two tiles of other pixels, the right one 37.3 mm lower, turned towards the viewer, a bezel between. */
static gw_site uneven_site(void) {
    static gw_site site;
    gw_site_defaults(&site);
    static const double left[3][3] = {{-620, 300, 0}, {-20, 300, 0}, {-620, -300, 0}};
    static const double right[3][3] = {{20, 262.7, 0}, {540, 262.7, 300.222}, {20, -337.3, 0}};
    site.layout.tile_count = 2;
    site.layout.tiles[0] = tile_of("left", left, 600, 600);
    site.layout.tiles[1] = tile_of("right", right, 400, 400);
    site.layout.tiles[1].picture[0] = 600;
    gw_error error = {0};
    assert_int_equal(gw_layout_measure(&site.layout, &error), GW_OK);
    return site;
}

static uint8_t *draw(gw_pattern_kind kind, const gw_site *site, uint32_t tile) {
    const gw_rectangle *r = &site->layout.tiles[tile].rectangle;
    uint8_t *pixels = calloc((size_t)r->width * r->height, 4);
    assert_non_null(pixels);
    gw_pattern_draw(kind, site, tile, pixels);
    return pixels;
}

static void lines_run_on_across_a_bezel(void **state) {
    (void)state;
    const gw_site site = uneven_site();
    const gw_tile *tiles = site.layout.tiles;
    uint8_t *left = draw(GW_PATTERN_GRID, &site, 0), *right = draw(GW_PATTERN_GRID, &site, 1);
    double a[MOST_LINES], b[MOST_LINES];
    const uint32_t count_a = lines_in_column(&tiles[0], left, 596, a),
                   count_b = lines_in_column(&tiles[1], right, 3, b);
    uint32_t level = 0;
    /* The wall's diagonal crosses, too: it is no whole hundred. */
    for (uint32_t i = 0; i < count_a; i++)
        for (uint32_t j = 0; j < count_b; j++)
            level += fabs(a[i] - 100 * round(a[i] / 100)) < 0.5 && fabs(a[i] - b[j]) < 0.5;
    assert_true(level >= 5); /* -200 .. 200 on both */
    /* Rows of pixels do not run on: a grid in pixels would be seen to break. */
    double across[2][3];
    point(&tiles[0], 599.5, 200.5, across[0]);
    point(&tiles[1], 0.5, 200.5, across[1]);
    assert_true(fabs(across[0][1] - across[1][1]) > 10);
    free(left);
    free(right);
}

/* The line across a wall of 3x2 with bezels lies where the wall's corners say, on every tile that it meets.
 */
static void the_line_across_the_wall_is_straight(void **state) {
    (void)state;
    static gw_site site;
    gw_error error = {0};
    gw_grid grid = {.columns = 3,
                    .rows = 2,
                    .pitch = {1.7, 1.7},
                    .left = 9,
                    .right = 13,
                    .top = 5,
                    .bottom = 21,
                    .eye = {0, 0, 2000}};
    gw_site_defaults(&site);
    for (int i = 0; i < 3; i++)
        grid.widths[i] = 320;
    for (int i = 0; i < 2; i++)
        grid.heights[i] = 240;
    assert_int_equal(gw_layout_grid(&grid, &site.layout, &error), GW_OK);
    const gw_layout *layout = &site.layout;
    uint32_t met = 0;
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        uint8_t *pixels = draw(GW_PATTERN_GRID, &site, t);
        for (uint32_t column = 40; column < 320; column += 30) {
            double at[3], heights[MOST_LINES];
            point(tile, column + 0.5, 0, at);
            const double wanted =
                layout->centre[1] + (at[0] - layout->centre[0]) * layout->size[1] / layout->size[0];
            const double row = (tile->plane.corner[1] - wanted) / grid.pitch[1];
            /* Not where names, greys, labels or another line stand. */
            if (row < 40 || row > 200 || fabs(wanted - 100 * round(wanted / 100)) < 12 ||
                (row > 70 && row < 170) || fabs(at[0] - 100 * round(at[0] / 100)) < 6)
                continue;
            const uint32_t count = lines_in_column(tile, pixels, column, heights);
            double nearest = INFINITY;
            for (uint32_t i = 0; i < count; i++)
                nearest = fmin(nearest, fabs(heights[i] - wanted));
            assert_true(nearest < 0.5 * grid.pitch[1]);
            met++;
        }
        free(pixels);
    }
    assert_true(met >= 3);
}

/* On a wall to the viewer's side, or a floor, the grid stands on the axes that lie in it. */
static void axes_lie_in_the_tile(void **state) {
    (void)state;
    static const double side[3][3] = {{-500, 0, 500}, {-500, 0, -500}, {-500, -500, 500}};
    static const double floor_corners[3][3] = {{-500, 0, -500}, {500, 0, -500}, {-500, 0, 500}};
    gw_tile tile = tile_of("side", side, 100, 50);
    int axes[2];
    gw_pattern_axes(&tile, axes);
    assert_int_equal(axes[0], 2);
    assert_int_equal(axes[1], 1);
    tile = tile_of("floor", floor_corners, 100, 100);
    gw_pattern_axes(&tile, axes);
    assert_int_equal(axes[0], 0);
    assert_int_equal(axes[1], 2);
}

/* Where the stripes are as bright as the grey beside them, gamma is sRGB's. */
static void stripes_have_the_light_of_their_grey(void **state) {
    (void)state;
    const gw_site site = uneven_site();
    const gw_tile *tile = &site.layout.tiles[0];
    uint8_t *pixels = draw(GW_PATTERN_COLOURS, &site, 0);
    double stripes = 0;
    for (uint32_t y = 404; y < 444; y++)
        stripes += light_at(tile, pixels, 600 * 3 / 16, y) / 40;
    assert_true(fabs(stripes - light_at(tile, pixels, 30, 424)) < 0.02);
    assert_true(light_at(tile, pixels, 590, 590) > 2.99 && light_at(tile, pixels, 5, 590) < 0.01);
    free(pixels);
}

/* Every kind fills every size without leaving it; the names of two tiles differ. */
static void any_size_is_filled(void **state) {
    (void)state;
    gw_site site = uneven_site();
    static const uint32_t sizes[][2] = {{1, 1}, {3, 200}, {400, 2}, {64, 48}};
    for (size_t s = 0; s < 4; s++)
        for (int kind = GW_PATTERN_GRID; kind < GW_PATTERN_COUNT; kind++) {
            site.layout.tiles[0].rectangle = (gw_rectangle){0, 0, sizes[s][0], sizes[s][1]};
            uint8_t *pixels = draw((gw_pattern_kind)kind, &site, 0);
            for (size_t i = 3; i < (size_t)sizes[s][0] * sizes[s][1] * 4; i += 4)
                assert_int_equal(pixels[i], 255);
            free(pixels);
        }
    site = uneven_site();
    site.layout.tiles[1] = site.layout.tiles[0];
    uint8_t *one = draw(GW_PATTERN_NAMES, &site, 0);
    snprintf(site.layout.tiles[0].name, sizeof site.layout.tiles[0].name, "lefr");
    uint8_t *other = draw(GW_PATTERN_NAMES, &site, 0);
    assert_memory_not_equal(one, other, 600 * 600 * 4);
    free(one);
    free(other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_run_on_across_a_bezel), cmocka_unit_test(the_line_across_the_wall_is_straight),
        cmocka_unit_test(axes_lie_in_the_tile),        cmocka_unit_test(stripes_have_the_light_of_their_grey),
        cmocka_unit_test(any_size_is_filled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
