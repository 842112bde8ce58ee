/* The wall's layout: splits, bezels, site files, the point under a pixel, assembled pictures. */
#include "tests/support/check.h"

#include "base/file.h"
#include "wall/layout.h"
#include "wall/picture.h"
#include "wall/sim_options.h"
#include "wall/site.h"

static void splits_are_even_and_complete(void **state) {
    (void)state;
    for (uint32_t pixels = 1; pixels < 200; pixels++) {
        for (uint32_t count = 1; count <= pixels && count <= 16; count++) {
            uint32_t parts[16], sum = 0, least = pixels, most = 0;
            gw_split_evenly(pixels, count, parts);
            for (uint32_t i = 0; i < count; i++) {
                sum += parts[i];
                least = parts[i] < least ? parts[i] : least;
                most = parts[i] > most ? parts[i] : most;
            }
            assert_int_equal(sum, pixels);
            assert_true(least >= 1 && most - least <= 1);
        }
    }
    uint32_t parts[3];
    gw_split_evenly(10, 3, parts);
    assert_int_equal(parts[0], 3);
    assert_int_equal(parts[1], 3);
    assert_int_equal(parts[2], 4);
}

static gw_layout layout_of(uint32_t columns, uint32_t rows, uint32_t width, uint32_t height, double bezel) {
    gw_wall_options options;
    gw_layout layout;
    gw_wall_options_init(&options, columns, rows);
    options.size[0] = width;
    options.size[1] = height;
    options.bezel = bezel;
    check_ok(gw_wall_layout(&options, &layout, &error));
    return layout;
}

/* Every split shares the numbers of the one plane, so that a pixel's ray cannot depend on the tile. */
static void a_split_is_one_plane(void **state) {
    (void)state;
    gw_layout whole = layout_of(1, 1, 1001, 503, 0), split = layout_of(7, 3, 1001, 503, 0);
    assert_int_equal(split.tile_count, 21);
    assert_memory_equal(&whole.size, &split.size, sizeof whole.size);
    assert_memory_equal(&whole.centre, &split.centre, sizeof whole.centre);
    uint64_t area = 0;
    for (uint32_t i = 0; i < split.tile_count; i++) {
        const gw_tile *tile = &split.tiles[i];
        assert_memory_equal(&tile->plane, &whole.tiles[0].plane, sizeof tile->plane);
        assert_int_equal(tile->rectangle.x, (int)tile->picture[0]);
        assert_int_equal(tile->rectangle.y, (int)tile->picture[1]);
        area += (uint64_t)tile->rectangle.width * tile->rectangle.height;
    }
    assert_int_equal(area, 1001 * 503);
    assert_string_equal(split.tiles[0].name, "c0r0");
    assert_string_equal(split.tiles[8].name, "c1r1");
    assert_true(whole.size[0] == 2000.0);
    assert_true(whole.eye[2] == 1800.0);
}

static void bezels_are_gaps_between_planes(void **state) {
    (void)state;
    /* 2000 mm over 200 px: 10 mm a pixel; 30 mm bezels are 3 px. */
    gw_layout layout = layout_of(2, 1, 200, 100, 30);
    const gw_tile *left = &layout.tiles[0], *right = &layout.tiles[1];
    assert_int_equal(layout.picture[0], 200);
    assert_int_equal(layout.picture[1], 100);
    assert_int_equal(layout.framed[0], 212);
    assert_int_equal(layout.framed[1], 106);
    assert_int_equal(left->framed[0], 3);
    assert_int_equal(right->framed[0], 3 + 100 + 6);
    assert_int_equal(right->framed[1], 3);
    assert_int_equal(right->rectangle.x, 0);
    assert_true(right->plane.corner[0] - left->plane.corner[0] == 1060.0);
    assert_true(layout.size[0] == 2060.0 && layout.size[1] == 1000.0);
    assert_true(left->plane.corner[0] == -1030.0);
}

static void a_pixel_has_a_point(void **state) {
    (void)state;
    gw_layout layout = layout_of(2, 2, 200, 100, 0);
    double point[3];
    check_ok(gw_layout_point(&layout, (const double[2]){100, 50}, point, &error));
    assert_true(point[0] == 0 && point[1] == 0 && point[2] == 0);
    check_ok(gw_layout_point(&layout, (const double[2]){0, 0}, point, &error));
    assert_true(point[0] == -1000 && point[1] == 500);
    check_ok(gw_layout_point(&layout, (const double[2]){200, 100}, point, &error));
    assert_true(point[0] == 1000 && point[1] == -500);
    check_fails(gw_layout_point(&layout, (const double[2]){200.5, 50}, point, &error), GW_BAD_INPUT,
                "is on no tile; the wall has 200x100 pixels");
}

static const char curved_site[] = "version: 1\n"
                                  "eye: [0, 1600, 2000]\n"
                                  "tiles:\n"
                                  "  - {name: left, pixels: [40, 30], place: [0, 0],\n"
                                  "     corners: [[-800, 2000, 300], [0, 2000, 0], [-800, 1400, 300]]}\n"
                                  "  - {name: right, pixels: [40, 30], place: [40, 0],\n"
                                  "     corners: [[0, 2000, 0], [800, 2000, 300], [0, 1400, 0]]}\n";

static void measured_corners_are_kept(void **state) {
    (void)state;
    char path[512];
    gw_site site;
    const gw_layout *layout = &site.layout;
    scratch_path(path, "curved.yaml");
    check_ok(gw_file_write(path, curved_site, sizeof curved_site - 1, &error));
    check_ok(gw_site_load(path, &site, &error));
    remove(path);
    assert_int_equal(layout->tile_count, 2);
    const gw_plane *plane = &layout->tiles[1].plane;
    assert_true(plane->corner[0] == 0 && plane->corner[1] == 2000 && plane->corner[2] == 0);
    assert_true(plane->step_x[0] == 20 && plane->step_x[1] == 0 && plane->step_x[2] == 7.5);
    assert_true(plane->step_y[0] == 0 && plane->step_y[1] == -20 && plane->step_y[2] == 0);
    assert_int_equal(layout->picture[0], 80);
    assert_true(layout->size[0] == 1600 && layout->size[1] == 600);
    assert_true(layout->centre[0] == 0 && layout->centre[1] == 1700 && layout->centre[2] == 150);
    assert_true(layout->eye[1] == 1600);
}

static void shipped_sites_load(void **state) {
    (void)state;
    gw_site site;
    const gw_layout *layout = &site.layout;
    check_ok(gw_site_load("configs/sites/desktop.yaml", &site, &error));
    assert_int_equal(layout->tile_count, 1);
    check_ok(gw_site_load("configs/sites/2x2.yaml", &site, &error));
    assert_int_equal(layout->tile_count, 4);
    assert_int_equal(layout->framed[0], layout->picture[0]);
    check_ok(gw_site_load("configs/sites/3x2-bezels.yaml", &site, &error));
    assert_int_equal(layout->tile_count, 6);
    assert_true(layout->framed[0] > layout->picture[0] && layout->framed[1] > layout->picture[1]);
}

static const char driven_site[] =
    "version: 1\n"
    "eye_distance: 65\n"
    "tracker: vrpn:Head@10.0.0.9:3883\n"
    "navigation: {fly_speed: 1.5}\n"
    "network: {address: 10.0.0.1}\n"
    "times: {load: 30, frame: 0.1, death: 3, refresh: 120}\n"
    "panel: {gamma: 2.2, display: ':0'}\n"
    "hosts:\n"
    "  - {name: one, tiles: [c0r*], panel: {display: ':1.1', brightness: 0.5}}\n"
    "  - {name: two, tiles: [c1r0]}\n"
    "panels:\n"
    "  c0r1: {monitor: DP-2, window: [-5, 7], white: [1, 0.5, 0.25]}\n"
    "  c1r1: {gpu: 3, stereo: row-interlace, gamma: srgb}\n"
    "grid: {columns: 2, rows: 2,\n"
    "       tile: {width: 400, height: 300, pixels: [40, 30]}}\n";

static void panels_are_laid_over_each_other(void **state) {
    (void)state;
    char path[512];
    gw_site site;
    const gw_panel *panels = site.panels;
    scratch_path(path, "driven.yaml");
    check_ok(gw_file_write(path, driven_site, sizeof driven_site - 1, &error));
    check_ok(gw_site_load(path, &site, &error));
    remove(path);
    assert_true(site.eye_distance == 65 && site.fly_speed == 1.5);
    assert_string_equal(site.tracker, "vrpn:Head@10.0.0.9:3883");
    assert_string_equal(site.address, "10.0.0.1");
    assert_true(site.times.load == 30 && site.times.frame == 0.1 && site.times.death == 3 &&
                site.times.refresh == 120);
    assert_string_equal(panels[0].host, "one");
    assert_string_equal(panels[1].host, "two");
    assert_string_equal(panels[2].host, "one");
    assert_string_equal(panels[3].host, "");
    assert_string_equal(panels[0].display, ":1.1");
    assert_string_equal(panels[1].display, ":0");
    assert_true(panels[0].brightness == 0.5 && panels[1].brightness == 1 && panels[2].brightness == 0.5);
    assert_string_equal(panels[2].monitor, "DP-2");
    assert_true(panels[2].window[0] == -5 && panels[2].window[1] == 7 && panels[2].white[2] == 0.25);
    assert_true(panels[2].gamma == 2.2 && panels[3].gamma == 0 && panels[3].gpu == 3 && panels[0].gpu == -1);
    assert_int_equal(panels[3].stereo, GW_STEREO_ROW_INTERLACE);
    assert_int_equal(panels[0].stereo, GW_STEREO_MONO);
}

static void pictures_are_assembled(void **state) {
    (void)state;
    gw_layout layout = layout_of(2, 1, 8, 4, 500); /* 250 mm a pixel: bezels of 2 px */
    uint8_t left[4 * 4 * 4], right[4 * 4 * 4];
    memset(left, 10, sizeof left);
    memset(right, 20, sizeof right);
    right[0] = 99;
    const uint8_t *both[2] = {left, right}, *one[2] = {left, NULL};
    gw_image image;
    check_ok(gw_picture_assemble(&layout, both, 0, &image, &error));
    assert_int_equal(image.width, 8);
    assert_int_equal(image.rgba[3 * 4], 10);
    assert_int_equal(image.rgba[4 * 4], 99);
    assert_int_equal(image.rgba[5 * 4], 20);
    gw_image_finish(&image);
    check_ok(gw_picture_assemble(&layout, both, 1, &image, &error));
    assert_int_equal(image.width, 16);
    assert_int_equal(image.height, 8);
    assert_int_equal(image.rgba[(2 * 16 + 10) * 4], 99);
    assert_int_equal(image.rgba[(2 * 16 + 5) * 4], 10);
    assert_int_equal(image.rgba[(2 * 16 + 6) * 4], image.rgba[0]); /* the gap is bezel, like the rim */
    gw_image_finish(&image);
    check_ok(gw_picture_assemble(&layout, one, 0, &image, &error));
    assert_int_equal(image.rgba[3 * 4], 10);
    assert_true(image.rgba[4 * 4] > 64 && image.rgba[4 * 4 + 1] == 0); /* missing: dark red */
    gw_image_finish(&image);
}

static void tiles_are_named_as_far_as_there_is_room(void **state) {
    (void)state;
    const gw_layout layout = layout_of(4, 2, 64, 32, 0);
    char text[40];
    gw_layout_names(&layout, 0, text, sizeof text);
    assert_string_equal(text, "");
    gw_layout_names(&layout, 2 | 32, text, sizeof text);
    assert_string_equal(text, "c1r0, c1r1");
    gw_layout_names(&layout, 255, text, sizeof text);
    assert_string_equal(text, "c0r0, c1r0, c2r0, c3r0 and 4 more");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(splits_are_even_and_complete),
        cmocka_unit_test(a_split_is_one_plane),
        cmocka_unit_test(bezels_are_gaps_between_planes),
        cmocka_unit_test(a_pixel_has_a_point),
        cmocka_unit_test(measured_corners_are_kept),
        cmocka_unit_test(shipped_sites_load),
        cmocka_unit_test(panels_are_laid_over_each_other),
        cmocka_unit_test(pictures_are_assembled),
        cmocka_unit_test(tiles_are_named_as_far_as_there_is_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
