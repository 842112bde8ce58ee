/* The report's keys, and the statistics in it. */
#include "tests/support/check.h"

#include "wall/report.h"

static json_t *new_report(void) {
    static char program[] = "gazewall", verb[] = "sim", bytes[] = "\xff\xfe";
    char *words[] = {program, verb, bytes};
    json_t *report = NULL;
    check_ok(gw_report_create(2, words, &report, &error));
    assert_string_equal(json_string_value(json_object_get(report, "command")), "gazewall sim");
    json_decref(report);
    check_ok(gw_report_create(3, words, &report, &error));
    assert_true(json_is_null(json_object_get(report, "command"))); /* not UTF-8 */
    return report;
}

static void keys_are_all_there_and_null(void **state) {
    (void)state;
    static const char *const keys[] = {"device",       "scene",
                                       "octree",       "memory",
                                       "tiles",        "frames",
                                       "ended",        "frame_ms",
                                       "counters",     "effects",
                                       "profile",      "settings",
                                       "latency_ms",   "predicted_error",
                                       "tracking",     "build",
                                       "swap_skew_ms", "float_environment",
                                       "image",        "gate",
                                       "site_reloads", "lights"};
    json_t *report = new_report();
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        assert_true(json_is_null(json_object_get(report, keys[i])));
    assert_int_equal(json_object_size(report), 2 + sizeof keys / sizeof keys[0]);
    json_decref(report);
}

/* A section that could not be put together would stay null without a word. */
static void sections_are_filled(void **state) {
    (void)state;
    json_t *report = new_report();
    char path[] = "made.obj", note[] = "no light: one was put in";
    char *notes[] = {note};
    gw_scene scene = {.path = path, .triangle_count = 3, .vertex_count = 9, .note_count = 1, .notes = notes};
    scene.dropped.zero_area = 5;
    gw_octree octree = {.depth = 4, .node_count = 10, .reference_count = 6};
    octree.statistics.leaves = 7;
    octree.statistics.inner = 3;
    gw_gl_limits limits = {.vendor = "v", .renderer = "r", .version = "4.5", .software = 1};
    gw_counters counters = {.rays = 1234567890123, .loop_iterations = 77};
    gw_recording track = {.name = path, .duration = 2000000000, .damage = {1, 24, 1, "cut"}};
    gw_settings settings;
    gw_settings_init(&settings);
    gw_profile profile;
    gw_profile_init(&profile);
    gw_layout layout = {.tile_count = 2};
    const gw_tile_record tiles[] = {
        {.state = "live"},
        {.state = "lost", .late = 1, .skipped = 2, .lost = 1, .lost_frame = 17, .fault = "its process died"}};
    const double times[] = {5, 1, 3};
    uint8_t pixels[2 * 1 * 4] = {1, 2, 3, 4, 5, 6, 7, 8};
    const gw_image image = {2, 1, pixels};

    gw_report_device(report, &limits);
    gw_report_scene(report, &scene, 12.5);
    gw_report_octree(report, &octree, &scene, &limits, 3.5, 0);
    gw_report_settings(report, &settings, &profile);
    gw_report_counters(report, &counters);
    gw_report_recording(report, &track, NULL);
    gw_report_tiles(report, &layout, tiles);
    gw_report_frames(report, times, 3, 5);
    gw_report_ended(report, 1);
    gw_report_image(report, NULL, &image);

    assert_int_equal(json_integer_value(json_object_get(json_object_get(report, "scene"), "triangles")), 3);
    const json_t *dropped = json_object_get(json_object_get(report, "scene"), "dropped");
    assert_int_equal(json_integer_value(json_object_get(dropped, "zero_area")), 5);
    assert_int_equal(json_array_size(json_object_get(json_object_get(report, "scene"), "notes")), 1);
    const json_t *tree = json_object_get(report, "octree");
    assert_int_equal(json_integer_value(json_object_get(tree, "leaves")), 7);
    assert_true(json_real_value(json_object_get(tree, "references_per_triangle")) == 2.0);
    const json_t *bytes = json_object_get(tree, "bytes");
    assert_int_equal(json_integer_value(json_object_get(bytes, "nodes")) +
                         json_integer_value(json_object_get(bytes, "leaves")),
                     10 * (json_int_t)sizeof(gw_node));
    assert_int_equal(json_integer_value(json_object_get(json_object_get(report, "counters"), "rays")),
                     1234567890123);
    assert_int_equal(
        json_integer_value(json_object_get(json_object_get(report, "counters"), "loop_iterations")), 77);
    assert_int_equal(json_object_size(json_object_get(report, "settings")), gw_setting_count);
    const json_t *tile = json_array_get(json_object_get(report, "tiles"), 1);
    assert_string_equal(json_string_value(json_object_get(tile, "state")), "lost");
    assert_int_equal(json_integer_value(json_object_get(tile, "lost_frame")), 17);
    assert_int_equal(json_integer_value(json_object_get(tile, "skipped")), 2);
    assert_string_equal(json_string_value(json_object_get(tile, "fault")), "its process died");
    assert_true(
        json_is_null(json_object_get(json_array_get(json_object_get(report, "tiles"), 0), "lost_frame")));
    assert_true(json_real_value(json_object_get(json_object_get(report, "frame_ms"), "median")) == 3);
    assert_true(json_real_value(json_object_get(json_object_get(report, "frame_ms"), "max")) == 5);
    assert_int_equal(json_integer_value(json_object_get(report, "frames")), 5);
    assert_string_equal(json_string_value(json_object_get(report, "ended")), "interrupted");
    assert_true(json_is_object(json_object_get(report, "device")));
    const json_t *damage = json_object_get(json_object_get(report, "tracking"), "damage");
    assert_int_equal(json_integer_value(json_object_get(damage, "offset")), 24);
    assert_true(json_is_object(json_object_get(report, "build")));
    const json_t *picture = json_object_get(report, "image");
    assert_true(json_is_null(json_object_get(picture, "file")));
    assert_int_equal(strlen(json_string_value(json_object_get(picture, "hash"))), 32);
    json_decref(report);
}

static void spreads(void **state) {
    (void)state;
    const double odd[] = {9, 1, 5}, even[] = {4, 1, 3, 2};
    double hundred[100];
    for (int i = 0; i < 100; i++)
        hundred[i] = 100 - i;
    assert_true(gw_spread_of(odd, 3).median == 5);
    assert_true(gw_spread_of(even, 4).median == 2.5);
    assert_true(gw_spread_of(hundred, 100).p95 == 95);
    assert_true(gw_spread_of(hundred, 100).minimum == 1 && gw_spread_of(hundred, 100).maximum == 100);
    assert_true(gw_spread_of(NULL, 0).maximum == 0);
    assert_true(odd[0] == 9); /* not sorted in place */
}

static void an_image_hash_sees_size_and_pixels(void **state) {
    (void)state;
    uint8_t pixels[2 * 3 * 4] = {0};
    const gw_image wide = {3, 2, pixels}, high = {2, 3, pixels};
    gw_hash before = gw_image_hash(&wide);
    assert_false(gw_hash_equal(before, gw_image_hash(&high)));
    pixels[23] = 1;
    assert_false(gw_hash_equal(before, gw_image_hash(&wide)));
}

static char warnings[1024];

static void keep_warning(void *context, gw_log_level level, const char *text) {
    (void)context;
    assert_int_equal(level, GW_LOG_WARNING);
    strncat(warnings, text, sizeof warnings - strlen(warnings) - 1);
}

static void faults_are_warned_of(void **state) {
    (void)state;
    const gw_log log = {.threshold = GW_LOG_WARNING, .line = keep_warning};
    warnings[0] = '\0';
    gw_report_faults(&log, &(gw_counters){.rays = 5});
    assert_string_equal(warnings, "");
    gw_report_faults(&log, &(gw_counters){.nan_pixels = 3, .step_cap_hits = 4});
    assert_non_null(strstr(warnings, "3 pixels came to no number"));
    assert_non_null(strstr(warnings, "4 rays were cut off"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_all_there_and_null),
        cmocka_unit_test(sections_are_filled),
        cmocka_unit_test(spreads),
        cmocka_unit_test(an_image_hash_sees_size_and_pixels),
        cmocka_unit_test(faults_are_warned_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
