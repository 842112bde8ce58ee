/* Pictures of all directions: their files, what of them becomes lights and what is blurred, against sums over
 * all texels. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/portable_math.h"
#include "build/gpu_types.h"
#include "build/import.h"
#include "build/radiance_hdr.h"
#include "render/environment.h"
#include "shaders/common/frame.h"
#include "tests/fuzz/radiance_hdr_entry.h"
#include "tests/support/mangle.h"

#include <limits.h>
#include <math.h>
#include <unistd.h>

/* --- files --- */

#define HEAD "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

static void every_coding_is_read(void **state) {
    (void)state;
    static const char flat[] = HEAD "-Y 1 +X 2\n\x10\x20\x30\x81\x40\x50\x60\x82";
    /* one pixel, then it three times more, then 2 x 256 - 4 times are too many for a width of 8 */
    static const char old[] =
        HEAD "-Y 1 +X 8\n\x10\x20\x30\x81\x01\x01\x01\x03\x40\x50\x60\x82\x01\x01\x01\x03";
    static const char rows[] =
        HEAD "-Y 1 +X 8\n\x02\x02\x00\x08\x88\x10\x84\x20\x04\x21\x22\x23\x24\x88\x30\x88\x81";
    gw_image image;
    double exposure;
    check_ok(gw_hdr_decode(flat, sizeof flat - 1, &image, &exposure, &error));
    assert_true(image.width == 2 && image.height == 1 && exposure == 1.0);
    assert_memory_equal(image.rgba, "\x10\x20\x30\x81\x40\x50\x60\x82", 8);
    gw_image_finish(&image);
    check_ok(gw_hdr_decode(old, sizeof old - 1, &image, &exposure, &error));
    for (int x = 0; x < 8; x++)
        assert_memory_equal(image.rgba + 4 * x, x < 4 ? "\x10\x20\x30\x81" : "\x40\x50\x60\x82", 4);
    gw_image_finish(&image);
    check_ok(gw_hdr_decode(rows, sizeof rows - 1, &image, &exposure, &error));
    assert_memory_equal(image.rgba, "\x10\x20\x30\x81", 4);
    assert_memory_equal(image.rgba + 28, "\x10\x24\x30\x81", 4);
    gw_image_finish(&image);
}

static void broken_pictures_are_named(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } rows[] = {
        {"PNG", "no Radiance picture"},
        {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234", "convert it to 32-bit_rle_rgbe"},
        {"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n1234", "exposure"},
        {"#?RADIANCE\n", "header does not end"},
        {HEAD "+Y 1 +X 1\n1234", "-Y height +X width"},
        {HEAD "-Y 1 +X 99999\n1234", "not 1..8192"},
        {HEAD "-Y 8000 +X 8000\n1234", "is cut"},
        {HEAD "-Y 1 +X 2\n1234", "row 0 of 1"},
        {HEAD "-Y 1 +X 1\n\x01\x01\x01\x01", "row 0 of 1"},
        {HEAD "-Y 1 +X 8\n\x02\x02", "row 0 of 1"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        gw_image image;
        double exposure;
        check_fails(gw_hdr_decode(rows[i].text, strlen(rows[i].text), &image, &exposure, &error),
                    GW_BAD_INPUT, rows[i].part);
        assert_null(image.rgba);
    }
    /* Damaged at random: an answer or an error, whatever the bytes. */
    static const char good[] =
        HEAD "-Y 2 +X 8\n\x02\x02\x00\x08\x88\x10\x84\x20\x04\x21\x22\x23\x24\x88\x30\x88\x81"
             "\x10\x20\x30\x81\x01\x01\x01\x07";
    mangle(fuzz_radiance_hdr, (const uint8_t *)good, sizeof good - 1, 5000);
}

static gw_code load_scene(const char *keys, const char *picture, size_t size, gw_scene **out,
                          gw_error *error) {
    char folder[PATH_MAX], text[PATH_MAX + 1024], path[512], file[512];
    const char *program = getenv("GAZEWALL");
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    assert_non_null(getcwd(folder, sizeof folder));
    scratch_path(file, "sky.hdr");
    scratch_path(path, "sky.yaml");
    gw_code code = gw_file_write(file, picture, size, error);
    snprintf(text, sizeof text,
             "version: 1\nmodels:\n  - file: %s/tests/data/tetra.off\nenvironment: {file: %s%s}\n", folder,
             file, keys);
    if (code == GW_OK)
        code = gw_file_write(path, text, strlen(text), error);
    if (code == GW_OK)
        code = gw_import(path, &options, out, error);
    remove(path);
    remove(file);
    return code;
}

static void scenes_name_a_picture(void **state) {
    (void)state;
    static const char sky[] = HEAD "-Y 1 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x80";
    static const char square[] = HEAD "-Y 1 +X 1\n\x80\x80\x80\x81";
    static const char dim[] = "#?RADIANCE\nEXPOSURE=4\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x80";
    gw_scene *scene = NULL;
    check_ok(load_scene(", intensity: 3, rotation: 90", sky, sizeof sky - 1, &scene, &error));
    assert_true(scene->environment.rgbe.width == 2 && scene->environment.scale == 3.0f);
    assert_true(fabs((double)scene->environment.rotation - 0.5 * GW_PI) < 1e-6);
    /* It takes the place of the default light, ambient and background. */
    assert_true(scene->light_count == 0 && scene->ambient[0] == 0.0f && scene->background[0] == 0.0f);
    gw_hash hash = scene->hash;
    gw_scene_destroy(&scene);
    check_ok(load_scene(", intensity: 3", sky, sizeof sky - 1, &scene, &error));
    assert_false(gw_hash_equal(hash, scene->hash));
    gw_scene_destroy(&scene);
    check_ok(load_scene("", dim, sizeof dim - 1, &scene, &error));
    assert_true(scene->environment.scale == 0.25f);
    gw_scene_destroy(&scene);
    check_fails(load_scene("", square, sizeof square - 1, &scene, &error), GW_BAD_INPUT,
                "twice as wide as high");
    check_fails(load_scene(", intensity: -1", sky, sizeof sky - 1, &scene, &error), GW_BAD_INPUT,
                "intensity");
    check_fails(load_scene("", "", 0, &scene, &error), GW_BAD_INPUT, "sky.hdr");
}

/* --- light --- */

enum { WIDE = 128, HIGH = WIDE / 2 };

/* A sky of `sky`, brighter towards the top, over a ground of a third; a sun of this radiance in one texel. */
static gw_radiance_map make_map(double sky, double gradient, double sun, uint32_t sun_x, uint32_t sun_y) {
    gw_radiance_map map = {WIDE, HIGH, calloc((size_t)WIDE * HIGH, 3 * sizeof(float))};
    assert_non_null(map.texels);
    for (uint32_t y = 0; y < HIGH; y++)
        for (uint32_t x = 0; x < WIDE; x++)
            for (uint32_t c = 0; c < 3; c++)
                map.texels[3 * (y * WIDE + x) + c] =
                    (float)(sky * (c + 1) *
                            (y < HIGH / 2 ? 1.0 + gradient * (1.0 - 2.0 * y / HIGH) : 1.0 / 3.0));
    for (uint32_t c = 0; c < 3; c++)
        map.texels[3 * (sun_y * WIDE + sun_x) + c] += (float)sun;
    return map;
}

static const double normals[][3] = {{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0.6, 0.64, 0.48}, {-0.48, 0.6, -0.64}};
enum { NORMALS = sizeof normals / sizeof normals[0] };

/* What lies near a pole is less than its share of texels; the plain mean of four made it twice as much. */
static void halves_keep_light(void **state) {
    (void)state;
    gw_radiance_map map = make_map(0.5, 0.4, 2000.0, 70, 0);
    double before[3], after[3];
    gw_radiance_map_mean(&map, before);
    while (map.width > 2) {
        gw_radiance_map_halve(&map);
        gw_radiance_map_mean(&map, after);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(after[c] / before[c] - 1.0) < 1e-5);
    }
    gw_radiance_map_finish(&map);
}

static void a_sun_becomes_a_light_and_no_light_is_lost(void **state) {
    (void)state;
    gw_radiance_map map = make_map(0.5, 0.4, 9000.0, 90, 14);
    double wanted[NORMALS][3], rest[3];
    gw_light lights[GW_MAXIMUM_ENVIRONMENT_LIGHTS];
    uint32_t count = 0;
    const double turn = 0.7;
    for (size_t n = 0; n < NORMALS; n++)
        gw_radiance_map_irradiance(&map, turn, normals[n], wanted[n]);
    check_ok(gw_environment_cut(&map, turn, 8, lights, &count, &error));
    assert_int_equal(count, 1);
    const double azimuth = 2.0 * GW_PI * 90.5 / WIDE - GW_PI + turn, down = GW_PI * 14.5 / HIGH;
    assert_true(fabs(lights[0].vector[1] + cos(down)) < 1e-6);
    assert_true(fabs(lights[0].vector[0] + sin(down) * sin(azimuth)) < 1e-6);
    assert_true(fabs(lights[0].vector[2] - sin(down) * cos(azimuth)) < 1e-6);
    const double texel = (cos(GW_PI * 14 / HIGH) - cos(GW_PI * 15 / HIGH)) * 2.0 * GW_PI / WIDE;
    assert_true(fabs((double)lights[0].extent - sqrt(texel / GW_PI)) < 1e-3); /* as wide as it */
    for (size_t n = 0; n < NORMALS; n++) {
        gw_radiance_map_irradiance(&map, turn, normals[n], rest);
        const double *v = lights[0].vector;
        const double cosine =
            fmax(-(v[0] * normals[n][0] + v[1] * normals[n][1] + v[2] * normals[n][2]), 0.0);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(rest[c] + cosine * (double)lights[0].color[c] - wanted[n][c]) <
                        1e-3 * wanted[n][c] + 1e-6);
    }
    gw_radiance_map_finish(&map);
}

static void what_is_even_needs_no_light(void **state) {
    (void)state;
    gw_light lights[GW_MAXIMUM_ENVIRONMENT_LIGHTS];
    uint32_t count = 1;
    gw_radiance_map map = make_map(0.5, 0.4, 0.0, 0, 0);
    check_ok(gw_environment_cut(&map, 0.0, 64, lights, &count, &error));
    assert_int_equal(count, 0);
    gw_radiance_map_finish(&map);
    map = make_map(0.5, 0.0, 9000.0, 90, 14);
    check_ok(gw_environment_cut(&map, 0.0, 0, lights, &count, &error)); /* none is wanted: nothing is taken */
    assert_true(count == 0 && map.texels[3 * (14 * WIDE + 90)] > 8999.0f);
    gw_radiance_map_finish(&map);
}

/* Two lamps and a wide bright window: with more lights the shading by them comes nearer to that by all
 * texels. */
static double error_with(uint32_t most, uint32_t *count) {
    gw_radiance_map map = make_map(0.2, 0.0, 700.0, 20, 20);
    for (uint32_t y = 18; y < 34; y++)
        for (uint32_t x = 60; x < 92; x++)
            map.texels[3 * (y * WIDE + x) + 1] += 9.0f;
    map.texels[3 * (10 * WIDE + 100)] += 900.0f;
    double worst = 0.0, wanted[NORMALS][3], rest[3];
    gw_light lights[GW_MAXIMUM_ENVIRONMENT_LIGHTS];
    for (size_t n = 0; n < NORMALS; n++)
        gw_radiance_map_irradiance(&map, 0.0, normals[n], wanted[n]);
    check_ok(gw_environment_cut(&map, 0.0, most, lights, count, &error));
    for (size_t n = 0; n < NORMALS; n++) {
        gw_radiance_map_irradiance(&map, 0.0, normals[n], rest);
        for (uint32_t i = 0; i < *count; i++)
            for (int c = 0; c < 3; c++) {
                const double *v = lights[i].vector;
                rest[c] += (double)lights[i].color[c] *
                           fmax(-(v[0] * normals[n][0] + v[1] * normals[n][1] + v[2] * normals[n][2]), 0.0);
            }
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs(rest[c] - wanted[n][c]) / wanted[n][c]);
    }
    gw_radiance_map_finish(&map);
    return worst;
}

static void more_lights_come_nearer(void **state) {
    (void)state;
    uint32_t counts[3];
    const double two = error_with(2, &counts[0]), eight = error_with(8, &counts[1]),
                 all = error_with(64, &counts[2]);
    print_message("worst irradiance off by %.3f with 2 lights, %.3f with 8, %.4f with %u\n", two, eight, all,
                  counts[2]);
    assert_true(counts[0] == 2 && counts[1] == 8 && counts[2] > 16);
    assert_true(eight < 0.5 * two && all < 0.5 * eight && all < 0.02);
}

/* The last layer is the irradiance over pi; a lobe keeps what is the same all around. */
static void blurred_layers_keep_energy(void **state) {
    (void)state;
    gw_radiance_map even = make_map(0.5, 0.0, 0.0, 0, 0), map = make_map(0.5, 1.5, 0.0, 0, 0);
    static float texels[GW_ENVIRONMENT_LAYERS][HIGH / 2][WIDE / 2][4];
    assert_int_equal(GW_ENVIRONMENT_WIDTH, WIDE / 2);
    for (uint32_t y = HIGH / 2; y < HIGH; y++)
        for (uint32_t i = 0; i < 3 * WIDE; i++)
            even.texels[3 * y * WIDE + i] = even.texels[i];
    check_ok(gw_environment_blur(&even, &texels[0][0][0][0], &error));
    for (int layer = 0; layer < GW_ENVIRONMENT_LAYERS; layer++)
        for (int y = 0; y < HIGH / 2; y++)
            assert_true(fabs((double)texels[layer][y][3][1] - 1.0) < 1e-3);
    check_ok(gw_environment_blur(&map, &texels[0][0][0][0], &error));
    const double down = GW_PI * 8.5 / (HIGH / 2), turn = 2.0 * GW_PI * 20.5 / (WIDE / 2) - GW_PI;
    const double normal[3] = {sin(down) * sin(turn), cos(down), -sin(down) * cos(turn)};
    double irradiance[3];
    gw_radiance_map_irradiance(&map, 0.0, normal, irradiance);
    const double blurred = (double)texels[GW_ENVIRONMENT_LAYERS - 1][8][20][1];
    assert_true(fabs(blurred * GW_PI - irradiance[1]) < 0.01 * irradiance[1]);
    gw_radiance_map_finish(&even);
    gw_radiance_map_finish(&map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_coding_is_read),
        cmocka_unit_test(broken_pictures_are_named),
        cmocka_unit_test(scenes_name_a_picture),
        cmocka_unit_test(halves_keep_light),
        cmocka_unit_test(a_sun_becomes_a_light_and_no_light_is_lost),
        cmocka_unit_test(what_is_even_needs_no_light),
        cmocka_unit_test(more_lights_come_nearer),
        cmocka_unit_test(blurred_layers_keep_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
