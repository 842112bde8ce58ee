/* `gazewall bench accuracy`: the ledger. Each knob of each scene is swept, all others as they stand; points
 * that an earlier run left in the folder are taken over. */
#include "wall/bench_accuracy.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/suggest.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* --- which knobs */

static gw_code check_names(const gw_bench *bench, gw_error *error) {
    for (size_t i = 0; i < bench->knob_count; i++) {
        const char *name = bench->knobs[i], *names[128];
        size_t count = 0;
        for (; count < gw_knob_count && count < sizeof names / sizeof *names; count++)
            names[count] = gw_knobs[count].name;
        const gw_knob *knob = gw_knob_find(name);
        const char *near = knob ? NULL : gw_suggest(name, names, count);
        if (!knob)
            return gw_fail(error, GW_BAD_INPUT, "--knob '%s' is none%s%s%s", name,
                           near ? "; did you mean '" : "; 'gazewall settings' lists them", near ? near : "",
                           near ? "'?" : "");
        if (gw_knob_setting(knob)->stage == GW_SETTING_TRACK)
            return gw_fail(
                error, GW_BAD_INPUT,
                "--knob %s acts on what trackers say, not on a frame; gazewall bench tracking measures it",
                name);
    }
    return GW_OK;
}

static int wants(const gw_bench *bench, const gw_knob *knob) {
    if (gw_knob_setting(knob)->stage == GW_SETTING_TRACK)
        return 0;
    for (size_t i = 0; i < bench->knob_count; i++)
        if (!strcmp(bench->knobs[i], knob->name))
            return 1;
    return !bench->knob_count && (knob->quick || !bench->quick);
}

/* --- sweeping */

static gw_code add_row(gw_accuracy_scene *scene, const gw_accuracy_row *row, gw_error *error) {
    gw_code code = gw_grow((void **)&scene->rows, &scene->row_capacity, scene->row_count + 1, sizeof *row,
                           "rows", error);
    if (!code)
        scene->rows[scene->row_count++] = *row;
    return code;
}

/* The frame of a knob's exact value, all others as they stand; 0 when it has none. */
static int own_frame(const gw_knob *knob, const gw_settings *base, gw_ledger_frame *out) {
    char assignment[2 * GW_KNOB_TEXT];
    *out = (gw_ledger_frame){.settings = *base, .age = knob->age};
    snprintf(assignment, sizeof assignment, "%s=%s", knob->name, knob->exact ? knob->exact : "");
    return knob->exact && !gw_settings_assign(&out->settings, assignment, NULL);
}

static gw_code measure_value(gw_accuracy_scene *scene, gw_ledger *ledger, const gw_knob *knob,
                             const gw_settings *base, const char *value, gw_error *error) {
    const gw_setting_row *setting = gw_knob_setting(knob);
    gw_accuracy_row row = {.knob = knob};
    gw_ledger_question question = {.frame = {.settings = *base, .age = knob->age}};
    gw_ledger_frame own;
    char assignment[2 * GW_KNOB_TEXT];
    snprintf(row.value, sizeof row.value, "%s", value);
    snprintf(assignment, sizeof assignment, "%s=%s", knob->name, value);
    question.own = own_frame(knob, base, &own) ? &own : NULL;
    gw_code code = gw_settings_assign(&question.frame.settings, assignment, error);
    if (!code)
        code = gw_ledger_exact(base, knob, &question.exact, error);
    if (!code)
        code = gw_ledger_measure(ledger, &question, &row.point, error);
    row.standing = gw_setting_value(&question.frame.settings, setting) == gw_setting_value(base, setting);
    return code ? code : add_row(scene, &row, error);
}

/* The value that stands is tried, too, where the command line says another than the table. */
static size_t values_of(const gw_knob *knob, const gw_settings *base,
                        char values[GW_KNOB_VALUES + 1][GW_KNOB_TEXT]) {
    char standing[64];
    size_t count = gw_knob_values(knob, values);
    gw_setting_text(base, gw_knob_setting(knob), standing);
    for (size_t i = 0; i < count; i++)
        if (!strcmp(values[i], standing))
            return count;
    memcpy(values[count], standing, sizeof standing);
    return count + 1;
}

static gw_code sweep(gw_accuracy_scene *scene, gw_ledger *ledger, const gw_knob *knob, double begin,
                     double share, gw_error *error) {
    char values[GW_KNOB_VALUES + 1][GW_KNOB_TEXT];
    gw_settings base = ledger->bench->draw.settings;
    gw_accuracy_curve curve = {.knob = knob, .first = scene->row_count};
    gw_code code = knob->with ? gw_settings_assign_all(&base, knob->with, error) : GW_OK;
    const size_t count = values_of(knob, &base, values);
    for (size_t i = 0; i < count && !code; i++) {
        gw_log_progress(&ledger->bench->console.log, "measuring what accuracy costs",
                        begin + share * (double)i / (double)count);
        code = measure_value(scene, ledger, knob, &base, values[i], error);
        if (code)
            return gw_context(error, "%s=%s of %s", knob->name, values[i], scene->name);
    }
    curve.count = scene->row_count - curve.first;
    if (!code)
        code = gw_grow((void **)&scene->curves, &scene->curve_capacity, scene->curve_count + 1, sizeof curve,
                       "curves", error);
    if (!code) {
        gw_accuracy_judge(scene, &curve);
        scene->curves[scene->curve_count++] = curve;
    }
    return code;
}

/* What a frame costs by its work, from all points; without it where nothing was timed. */
static void fit_model(gw_accuracy_scene *scene) {
    gw_cost_sample *samples = NULL;
    size_t count = 0;
    if (gw_allocate((void **)&samples, scene->row_count, sizeof *samples, "samples", NULL))
        return;
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->rows[i].point.costs[GW_LEDGER_MS] > 0)
            samples[count++] =
                gw_cost_of_frame(&scene->rows[i].point.counters, scene->rows[i].point.costs[GW_LEDGER_MS]);
    if (!count || gw_cost_fit(GW_COST_TIME, samples, count, &scene->model, NULL))
        scene->model = (gw_cost_model){0};
    free(samples);
}

/* --- scenes */

static void describe(gw_accuracy_scene *scene, const gw_ledger *ledger) {
    const gw_scene *imported = ledger->bench->model.scene;
    memcpy(scene->size, ledger->size, sizeof scene->size);
    snprintf(scene->path, sizeof scene->path, "%s", ledger->path ? ledger->path : "demo");
    scene->triangles = imported->triangle_count;
    gw_hash_text(imported->hash, scene->hash);
    scene->pixels_per_degree = gw_pixels_per_degree(&ledger->views[0].view.plane, ledger->views[0].gaze_eye,
                                                    ledger->size[0], ledger->size[1]);
}

static gw_code measure_standing(gw_accuracy_scene *scene, gw_ledger *ledger, gw_error *error) {
    gw_ledger_question question = {.frame = {.settings = ledger->bench->draw.settings}};
    gw_code code = gw_ledger_exact(&question.frame.settings, NULL, &question.exact, error);
    if (!code)
        code = gw_ledger_measure(ledger, &question, &scene->standing, error);
    if (!code)
        gw_ledger_frame_key(ledger, &question.exact, scene->exact_key);
    return code;
}

static gw_code measure_choice(void *context, const gw_settings *settings, gw_ledger_point *out,
                              gw_error *error) {
    gw_ledger *ledger = context;
    gw_ledger_question question = {.frame = {.settings = *settings}};
    gw_code code = gw_ledger_exact(&ledger->bench->draw.settings, NULL, &question.exact, error);
    return code ? code : gw_ledger_measure(ledger, &question, out, error);
}

static gw_code search_scene(gw_accuracy_scene *scene, gw_ledger *ledger, gw_error *error) {
    const gw_accuracy_instrument instrument = {measure_choice, ledger};
    return gw_accuracy_search(scene, ledger->bench, &instrument, error);
}

static gw_code measure_scene(gw_accuracy *accuracy, gw_accuracy_scene *scene, const char *path, double begin,
                             double share, gw_error *error) {
    gw_bench *bench = accuracy->bench;
    gw_ledger ledger;
    size_t wanted = 0, done = 0;
    gw_code code = gw_ledger_open(&ledger, bench, path, scene->name, error);
    if (!code) {
        describe(scene, &ledger);
        code = measure_standing(scene, &ledger, error);
    }
    for (size_t i = 0; i < gw_knob_count; i++)
        wanted += (size_t)wants(bench, &gw_knobs[i]);
    for (size_t i = 0; i < gw_knob_count && !code; i++)
        if (wants(bench, &gw_knobs[i])) {
            code = sweep(scene, &ledger, &gw_knobs[i], begin + share * (double)done / (double)wanted,
                         share / (double)wanted, error);
            done++;
        }
    if (!code) {
        gw_accuracy_mark_fronts(scene);
        fit_model(scene);
    }
    if (!code && (bench->bound_count || bench->max_cost))
        code = search_scene(scene, &ledger, error);
    scene->measured = ledger.measured;
    scene->found = ledger.found;
    gw_ledger_close(&ledger);
    return code;
}

/* Of the file, without folders and what folders' names should not hold; with a number when it is taken. */
static void name_scene(gw_accuracy *accuracy, size_t which, const char *path) {
    gw_accuracy_scene *scene = &accuracy->scenes[which];
    char stem[40];
    snprintf(stem, sizeof stem, "%s", path ? gw_path_name(path) : "demo");
    char *dot = strchr(stem, '.');
    if (dot && dot != stem)
        *dot = '\0';
    for (char *c = stem; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_')
            *c = '-';
    int taken = 0;
    for (size_t i = 0; i < which; i++)
        taken |= !strcmp(accuracy->scenes[i].name, stem);
    if (taken)
        snprintf(scene->name, sizeof scene->name, "%s-%zu", stem, which + 1);
    else
        snprintf(scene->name, sizeof scene->name, "%s", stem);
}

static void finish(gw_accuracy *accuracy) {
    for (size_t i = 0; i < accuracy->scene_count; i++) {
        free(accuracy->scenes[i].rows);
        free(accuracy->scenes[i].curves);
        json_decref(accuracy->scenes[i].found_profile);
    }
    free(accuracy->scenes);
}

static gw_code tell(const gw_accuracy *accuracy, gw_error *error) {
    gw_code code = gw_accuracy_write(accuracy, error);
    if (!code && accuracy->bench->out)
        code = gw_accuracy_digest(accuracy, error);
    return code || !accuracy->bench->out ? code : gw_accuracy_page(accuracy, error);
}

gw_code gw_bench_accuracy(gw_bench *bench, gw_error *error) {
    const size_t count = bench->scene_count ? bench->scene_count : 1;
    const int software = gw_gl_limits_of(bench->model.device)->software;
    gw_accuracy accuracy = {
        .bench = bench, .clock = software ? "processor" : "wall", .counted = software || bench->quick};
    gw_code code = check_names(bench, error);
    if (!code)
        code = gw_accuracy_check_goal(bench, error);
    if (!code && bench->save_profile && count > 1)
        code = gw_fail(error, GW_BAD_INPUT, "--save-profile writes one profile: give one scene");
    if (!code)
        code = gw_file_writable(bench->save_profile, error);
    if (!code)
        code = gw_allocate((void **)&accuracy.scenes, count, sizeof *accuracy.scenes, "scenes", error);
    for (size_t i = 0; i < count && !code; i++) {
        const char *path = bench->scene_count ? bench->scenes[i] : bench->draw.scene;
        name_scene(&accuracy, i, path);
        accuracy.scene_count = i + 1;
        code = measure_scene(&accuracy, &accuracy.scenes[i], path, (double)i / (double)count,
                             1.0 / (double)count, error);
        /* What is there so far, so that a long run that is ended has told something. */
        if (!code)
            code = tell(&accuracy, error);
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        gw_accuracy_print(&accuracy);
    }
    finish(&accuracy);
    return code;
}
