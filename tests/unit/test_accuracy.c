/* The ledger's instrument without a device: planted errors are flagged, fronts hold what nothing beats, kept
 * points come back, and profiles are read as they were written and refused when they are none. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/fuzz/profile_entry.h"
#include "tests/support/mangle.h"
#include "wall/bench_accuracy.h"
#include "wall/profile.h"

#include <math.h>
#include <unistd.h>

enum { ROWS = 4 };

/* A curve of tau with these errors and works. */
static void make_curve(gw_accuracy_scene *scene, gw_accuracy_row rows[ROWS], gw_accuracy_curve *curve,
                       const double errors[ROWS], const double works[ROWS]) {
    static const char *const values[ROWS] = {"0", "0.5", "1", "2"};
    *scene = (gw_accuracy_scene){.rows = rows, .row_count = ROWS, .curves = curve, .curve_count = 1};
    *curve = (gw_accuracy_curve){.knob = gw_knob_find("tau"), .count = ROWS};
    for (size_t i = 0; i < ROWS; i++) {
        rows[i] = (gw_accuracy_row){.knob = curve->knob, .standing = i == 2};
        snprintf(rows[i].value, sizeof rows[i].value, "%s", values[i]);
        rows[i].point.errors.values[GW_METRIC_FLIP] = 0.1 + errors[i];
        rows[i].point.own = errors[i];
        rows[i].point.predicted = i < 2 ? 1 : i == 2 ? 1.5 : 3;
        rows[i].point.costs[GW_LEDGER_WORK] = works[i];
    }
}

static void a_planted_error_is_flagged(void **state) {
    (void)state;
    gw_accuracy_scene scene;
    gw_accuracy_row rows[ROWS];
    gw_accuracy_curve curve;
    const double sound[ROWS] = {0, 0.02, 0.04, 0.08}, planted[ROWS] = {0, 0.05, 0.04, 0.08},
                 works[ROWS] = {4e6, 3e6, 2e6, 1e6};
    char sentence[512];
    make_curve(&scene, rows, &curve, sound, works);
    gw_accuracy_judge(&scene, &curve);
    assert_string_equal(curve.fault, "");
    assert_false(curve.idle);
    /* From 1.5 to 3 FLIP by the model grows 2^0.6 times, and has grown twice; below 1.25 nothing is told. */
    assert_float_equal(curve.model_ratio, pow(2, 0.6) / 2, 1e-9);
    gw_accuracy_sentence(&scene, &curve, sentence, sizeof sentence);
    assert_non_null(strstr(sentence, "2 is cheapest with 0.1800 for 50.0 % less work"));
    make_curve(&scene, rows, &curve, planted, works);
    gw_accuracy_judge(&scene, &curve);
    assert_non_null(strstr(curve.fault, "tau: its error rises from 0.0400 to 0.0500 FLIP"));
    make_curve(&scene, rows, &curve, sound, works);
    rows[1].point.counters.nan_pixels = 3;
    gw_accuracy_judge(&scene, &curve);
    assert_non_null(strstr(curve.fault, "tau=0.5: 3 pixels are no numbers"));
    make_curve(&scene, rows, &curve, sound, works);
    rows[3].point.errors.values[GW_METRIC_FLIP] = (double)NAN;
    gw_accuracy_judge(&scene, &curve);
    assert_non_null(strstr(curve.fault, "tau=2: the error is no number"));
}

static void a_knob_without_effect_is_idle(void **state) {
    (void)state;
    gw_accuracy_scene scene;
    gw_accuracy_row rows[ROWS];
    gw_accuracy_curve curve;
    const double errors[ROWS] = {0, 0, 0, 0}, works[ROWS] = {1e6, 1e6, 1e6, 1e6};
    make_curve(&scene, rows, &curve, errors, works);
    gw_accuracy_judge(&scene, &curve);
    assert_true(curve.idle);
}

static void fronts_hold_what_nothing_beats(void **state) {
    (void)state;
    gw_accuracy_scene scene;
    gw_accuracy_row rows[ROWS];
    gw_accuracy_curve curve;
    const double errors[ROWS] = {0.01, 0.05, 0.04, 0.08}, works[ROWS] = {4e6, 3e6, 2e6, 2e6};
    make_curve(&scene, rows, &curve, errors, works);
    gw_accuracy_mark_fronts(&scene);
    const int wanted[ROWS] = {1, 0, 1, 0};
    for (size_t i = 0; i < ROWS; i++)
        assert_int_equal(rows[i].front, wanted[i]);
}

/* A frame whose sharpness off the gaze costs nothing until triangles are exact: what gains most at first
 * leaves no room for what would gain more. */
static gw_code measure_trap(void *context, const gw_settings *settings, gw_ledger_point *out,
                            gw_error *wrong) {
    (void)wrong;
    const int sharp = settings->acuity_slope == 0 || settings->gaze_half_width > 80,
              exact = settings->tau == 0, blunt = !sharp && settings->acuity_slope > 0.05;
    *out = (gw_ledger_point){0};
    gw_metrics_clear(&out->errors);
    ++*(size_t *)context;
    out->errors.values[GW_METRIC_FLIP] = out->errors.values[GW_METRIC_SEEN_FLIP] = exact
                                                                                       ? (sharp ? 0.04 : 0.05)
                                                                                   : sharp ? 0.09
                                                                                   : blunt ? 0.5
                                                                                           : 0.1;
    out->errors.values[GW_METRIC_DEPTH_95] = exact ? 0 : 2;
    out->costs[GW_LEDGER_WORK] = exact ? (sharp ? 130 : 80) : blunt ? 20 : 100;
    return GW_OK;
}

/* Two curves of the trap; the second has the values of tau. */
static void sweep_trap(gw_accuracy_scene *scene, gw_accuracy_row rows[2 * ROWS], gw_accuracy_curve curves[2],
                       const gw_settings *base, size_t *frames) {
    static const char *const names[2] = {"acuity_slope", "tau"}, *const values[2][3] = {
                                                                     {"0", "0.022", "0.088"},
                                                                     {"0", "1", "2"}};
    *scene = (gw_accuracy_scene){.name = "trap", .rows = rows, .curves = curves, .curve_count = 2};
    check_ok(measure_trap(frames, base, &scene->standing, &error));
    for (size_t c = 0; c < 2; c++) {
        curves[c] =
            (gw_accuracy_curve){.knob = gw_knob_find(names[c]), .first = scene->row_count, .count = 3};
        for (size_t i = 0; i < 3; i++) {
            gw_settings settings = *base;
            char assignment[96];
            gw_accuracy_row *row = &rows[scene->row_count++];
            *row = (gw_accuracy_row){.knob = curves[c].knob, .standing = i == 1};
            snprintf(row->value, sizeof row->value, "%s", values[c][i]);
            snprintf(assignment, sizeof assignment, "%s=%s", names[c], values[c][i]);
            check_ok(gw_settings_assign(&settings, assignment, &error));
            check_ok(measure_trap(frames, &settings, &row->point, &error));
            row->point.own = (double)NAN;
        }
        gw_accuracy_judge(scene, &curves[c]);
    }
    gw_accuracy_mark_fronts(scene);
}

static double found_figure(const gw_accuracy_scene *scene, const char *of, const char *name) {
    return json_number_value(
        json_object_get(json_object_get(json_object_get(scene->found_profile, "point"), of), name));
}

/* The search never comes to something worse than one knob's value that it has seen, and holds every bound. */
static void the_search_is_no_worse_than_one_knob(void **state) {
    (void)state;
    static gw_bench bench;
    gw_accuracy_scene scene;
    gw_accuracy_row rows[2 * ROWS];
    gw_accuracy_curve curves[2];
    size_t frames = 0;
    const gw_accuracy_instrument instrument = {measure_trap, &frames};
    gw_settings_init(&bench.draw.settings);
    sweep_trap(&scene, rows, curves, &bench.draw.settings, &frames);
    bench.max_cost = "work=100";
    check_ok(gw_accuracy_search(&scene, &bench, &instrument, &error));
    assert_float_equal(found_figure(&scene, "errors", "seen_flip"), 0.05, 1e-12);
    assert_true(json_is_true(json_object_get(scene.found_profile, "met")));
    /* As little work as FLIP allows is not exact in depth: both hold, or it says so. */
    bench.max_cost = NULL;
    bench.max_errors[bench.bound_count++] = "flip=0.1";
    check_ok(gw_accuracy_search(&scene, &bench, &instrument, &error));
    assert_float_equal(found_figure(&scene, "costs", "work"), 80, 1e-12);
    bench.max_errors[0] = "flip=0.045";
    bench.max_errors[bench.bound_count++] = "depth_95=1";
    check_ok(gw_accuracy_search(&scene, &bench, &instrument, &error));
    assert_float_equal(found_figure(&scene, "costs", "work"), 130, 1e-12);
    bench.max_errors[1] = "normal=1";
    check_fails(gw_accuracy_search(&scene, &bench, &instrument, &error), GW_BAD_INPUT,
                "normal cannot be measured");
    bench.max_errors[1] = "flicker=1";
    check_fails(gw_accuracy_check_goal(&bench, &error), GW_BAD_INPUT, "add --frames");
    json_decref(scene.found_profile);
}

static gw_ledger_point some_point(const char *key) {
    gw_ledger_point point = {.own = 1.0 / 3, .spread_ms = 0.5, .predicted = 1.25, .worst = 2, .nodes = 77};
    gw_metrics_clear(&point.errors);
    snprintf(point.key, sizeof point.key, "%s", key);
    point.errors.values[GW_METRIC_FLIP] = 0.1;
    point.counters.triangle_tests = 123456789012;
    point.costs[GW_LEDGER_WORK] = 5e9 / 7;
    return point;
}

/* Points that were kept come back to the bit; a line that was cut is passed over, and the next one begins
 * anew. */
static void kept_points_come_back(void **state) {
    (void)state;
    char folder[512], path[600];
    gw_bytes bytes;
    scratch_path(folder, "ledger");
    check_ok(gw_make_directories(folder, &error));
    snprintf(path, sizeof path, "%s/points.jsonl", folder);
    unlink(path);
    static const char first[] = "0123456789abcdef0123456789abcdef",
                      second[] = "1123456789abcdef0123456789abcdef";
    const gw_ledger_point points[2] = {some_point(first), some_point(second)};
    gw_ledger writer = {.folder = folder}, reader = {.folder = folder};
    check_ok(gw_ledger_keep(&writer, &points[0], &error));
    check_ok(gw_ledger_keep(&writer, &points[1], &error));
    free(writer.known);
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    check_ok(gw_file_write(path, bytes.data, bytes.size - 40, &error)); /* killed while it wrote */
    gw_bytes_finish(&bytes);
    check_ok(gw_ledger_load(&reader, &error));
    assert_int_equal(reader.known_count, 1);
    const gw_ledger_point *found = gw_ledger_find(&reader, first);
    assert_non_null(found);
    assert_null(gw_ledger_find(&reader, second));
    assert_true(found->own == points[0].own &&
                found->costs[GW_LEDGER_WORK] == points[0].costs[GW_LEDGER_WORK]);
    assert_true(found->counters.triangle_tests == points[0].counters.triangle_tests && found->nodes == 77);
    assert_true(isnan(found->errors.values[GW_METRIC_SSIM]));
    check_ok(gw_ledger_keep(&reader, &points[1], &error));
    gw_ledger again = {.folder = folder};
    check_ok(gw_ledger_load(&again, &error));
    assert_int_equal(again.known_count, 2);
    free(reader.known);
    free(again.known);
}

static void profiles_come_back(void **state) {
    (void)state;
    char path[512];
    gw_profile written, read;
    gw_settings settings;
    gw_settings_init(&settings);
    gw_profile_init(&written);
    snprintf(written.name, sizeof written.name, "mine");
    snprintf(written.about, sizeof written.about, "a \"quoted\" \\ word: # and more");
    written.settings.tau = 1.0 / 3;
    written.settings.samples = 2;
    written.settings.geometry = GW_GEOMETRY_TRIANGLES;
    written.figure_count = 1;
    snprintf(written.figures[0].name, sizeof written.figures[0].name, "flip");
    written.figures[0].value = 0.125;
    scratch_path(path, "mine.yaml");
    check_ok(gw_profile_write(path, &written, &error));
    check_ok(gw_profile_apply(path, &settings, &read, &error));
    assert_string_equal(read.name, "mine");
    assert_string_equal(read.about, written.about);
    assert_memory_equal(&settings, &written.settings, sizeof settings);
    assert_true(read.figures[0].value == 0.125);
    settings.tau = 2;
    json_t *told = gw_profile_json(&read, &settings);
    assert_int_equal(json_array_size(json_object_get(told, "changed")), 1);
    assert_string_equal(json_string_value(json_object_get(told, "file")), path);
    json_decref(told);
}

static void what_is_no_profile_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } table[] = {
        {"", "there is nothing in it"},
        {"[1]", "profile"},
        {"profile: x\n", "key 'settings' is missing"},
        {"settings: {tau: 1}\n", "key 'profile' is missing"},
        {"profile: x\nsettings: {tua: 1}\n",
         "p.yaml:2: key 'settings': unknown setting 'tua'; did you mean 'tau'?"},
        {"profile: x\nsettings: {tau: 99}\n", "99 is outside 0 to 64"},
        {"profile: x\nsettings: {tau: [1]}\n", "p.yaml:2"},
        {"profile: x\nsettings: 5\n", "p.yaml:2"},
        {"profile: x\nsettings: {tau: 1}\nmeasured: {flip: low}\n", "p.yaml:3"},
        {"profile: x\nsettings: {tau: 1}\ntau: 1\n", "p.yaml:3"},
    };
    gw_settings settings, untouched;
    gw_profile profile;
    gw_settings_init(&settings);
    untouched = settings;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        check_fails(
            gw_profile_parse(table[i].text, strlen(table[i].text), "p.yaml", &settings, &profile, &error),
            GW_BAD_INPUT, table[i].message);
        assert_memory_equal(&settings, &untouched, sizeof settings);
    }
}

static void mangled_profiles_never_break_the_reader(void **state) {
    (void)state;
    static const char good[] = "profile: \"mine\"\nabout: \"a\"\nmeasured_by: \"b\"\nmeasured:\n  flip: 0.2\n"
                               "settings:\n  tau: 0.25\n  sample_block: 1\n  tone: filmic\n";
    mangle(fuzz_profile, (const uint8_t *)good, sizeof good - 1, 500);
}

/* Those inside the program: each is read, and stands in the report by its name. */
static void named_profiles_are_there(void **state) {
    (void)state;
    static const char *const names[] = {"draft", "show", "study", "exact"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        gw_settings settings;
        gw_profile profile;
        gw_settings_init(&settings);
        check_ok(gw_profile_apply(names[i], &settings, &profile, &error));
        assert_string_equal(profile.name, names[i]);
        assert_true(profile.measured_by[0] && profile.figure_count);
    }
    gw_settings settings;
    gw_profile profile;
    gw_settings_init(&settings);
    check_fails(gw_profile_apply("shwo", &settings, &profile, &error), GW_BAD_INPUT,
                "neither a file nor one of");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planted_error_is_flagged),
        cmocka_unit_test(a_knob_without_effect_is_idle),
        cmocka_unit_test(fronts_hold_what_nothing_beats),
        cmocka_unit_test(the_search_is_no_worse_than_one_knob),
        cmocka_unit_test(kept_points_come_back),
        cmocka_unit_test(profiles_come_back),
        cmocka_unit_test(what_is_no_profile_is_refused),
        cmocka_unit_test(mangled_profiles_never_break_the_reader),
        cmocka_unit_test(named_profiles_are_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
