/* Plots as SVG, and the rock whose builds they show. */
#include "tests/support/check.h"
#include "wall/plot.h"
#include "wall/rock.h"

#include <math.h>

static char *draw(const gw_plot_series *series, size_t count, const char *title) {
    char *svg = NULL;
    size_t size = 0;
    gw_plot plot = {.title = title, .x_label = "x", .y_label = "y", .series = series, .series_count = count};
    check_ok(gw_plot_svg(&plot, &svg, &size, &error));
    assert_non_null(svg);
    assert_int_equal(size, strlen(svg));
    return svg;
}

static size_t count_of(const char *text, const char *part) {
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, part)); at++)
        count++;
    return count;
}

static void points_stand_at_their_logarithms(void **state) {
    (void)state;
    const double x[] = {10, 100, 1000}, y[] = {1, 10, 100};
    const gw_plot_series series = {.name = "curve", .x = x, .y = y, .count = 3};
    char *svg = draw(&series, 1, "t");
    /* Corners and middle of the frame: 80..540 across, 380..40 down. */
    assert_non_null(strstr(svg, "M80.0 380.0L310.0 210.0L540.0 40.0"));
    assert_int_equal(count_of(svg, "<circle"), 3);
    assert_non_null(strstr(svg, ">1k</text>"));
    assert_non_null(strstr(svg, ">curve</text>"));
    free(svg);
}

static void what_has_no_place_is_left_out(void **state) {
    (void)state;
    const double x[] = {10, 0, -5, 100, 1000}, y[] = {1, 10, 10, NAN, 100};
    const gw_plot_series series[2] = {{.name = "curve", .x = x, .y = y, .count = 5},
                                      {.name = "line", .x = x, .y = y, .count = 1, .dashed = 1}};
    char *svg = draw(series, 2, "t");
    assert_non_null(strstr(svg, "M80.0 380.0L540.0 40.0"));
    assert_int_equal(count_of(svg, "<circle"), 2);
    assert_null(strstr(svg, "nan"));
    assert_null(strstr(svg, "inf"));
    free(svg);
    svg = draw(series, 0, "nothing");
    assert_null(strstr(svg, "inf"));
    free(svg);
}

static void texts_are_escaped(void **state) {
    (void)state;
    char *svg = draw(NULL, 0, "a < b & c");
    assert_non_null(strstr(svg, ">a &lt; b &amp; c</text>"));
    free(svg);
}

static void a_rock_is_closed_and_the_same_again(void **state) {
    (void)state;
    gw_scene *rock = NULL, *again = NULL;
    check_ok(gw_rock_scene(1000, &rock, &error));
    check_ok(gw_rock_scene(1000, &again, &error));
    assert_int_equal(rock->triangle_count, 12 * 10 * 10);
    /* A closed surface without handles: vertices - triangles / 2 = 2 (Euler); the six grids join at their
     * rims. */
    assert_int_equal(rock->welded_count, 2 + rock->triangle_count / 2);
    assert_true(gw_hash_equal(rock->hash, again->hash));
    gw_scene_destroy(&again);
    gw_scene_destroy(&rock);
    check_fails(gw_rock_scene(11, &rock, &error), GW_BAD_INPUT, "12 to");
    check_fails(gw_rock_scene(UINT32_MAX, &rock, &error), GW_BAD_INPUT, "12 to");
}

/* The volume is positive: triangles turn counter-clockwise seen from outside. */
static void a_rock_looks_outwards(void **state) {
    (void)state;
    gw_scene *rock = NULL;
    double volume = 0;
    check_ok(gw_rock_scene(300, &rock, &error));
    for (uint32_t i = 0; i < rock->triangle_count; i++) {
        const float *a = rock->positions + 3 * (size_t)rock->triangles[i][0],
                    *b = rock->positions + 3 * (size_t)rock->triangles[i][1],
                    *c = rock->positions + 3 * (size_t)rock->triangles[i][2];
        double part = (double)a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) +
                      (double)a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
                      (double)a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
        assert_true(part > 0); /* star-shaped about its middle: every triangle faces away from it */
        volume += part / 6;
    }
    assert_true(volume > 0.1);
    gw_scene_destroy(&rock);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_stand_at_their_logarithms),
        cmocka_unit_test(what_has_no_place_is_left_out),
        cmocka_unit_test(texts_are_escaped),
        cmocka_unit_test(a_rock_is_closed_and_the_same_again),
        cmocka_unit_test(a_rock_looks_outwards),
    };
    return cmocka_run_group_tests_name("plot", tests, NULL, NULL);
}
