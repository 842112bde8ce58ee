/* See bench_accuracy.h: what each knob costs over all scenes of a run, as docs/ledger/knobs.md has it. */
#include "wall/bench_accuracy.h"

#include "base/file.h"
#include "wall/interrupt.h"
#include "wall/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double error_of(const gw_accuracy_row *row) {
    return row->point.errors.values[GW_METRIC_FLIP];
}

static double work_of(const gw_accuracy_row *row) {
    return row->point.costs[GW_LEDGER_WORK];
}

static const gw_accuracy_curve *curve_of(const gw_accuracy_scene *scene, const gw_knob *knob) {
    for (size_t c = 0; c < scene->curve_count; c++)
        if (scene->curves[c].knob == knob)
            return &scene->curves[c];
    return NULL;
}

/* --- the model beside what was measured */

static void put_models(FILE *page, const gw_accuracy *accuracy) {
    fputs("## Predicted and measured\n\nBy how many times FLIP by the model (the predicted error to the "
          "power 0.6) grows more than the measured one, the factor farthest from 1; empty where the model "
          "has too little to tell:\n\n| scene |",
          page);
    for (size_t i = 0; i < gw_knob_count; i++)
        if (gw_knobs[i].model)
            fprintf(page, " `%s` |", gw_knobs[i].name);
    fputs(" cost model, off by |\n|---|", page);
    for (size_t i = 0; i < gw_knob_count; i++)
        fputs(gw_knobs[i].model ? "---|" : "", page);
    fputs("---|\n", page);
    for (size_t s = 0; s < accuracy->scene_count; s++) {
        const gw_accuracy_scene *scene = &accuracy->scenes[s];
        fprintf(page, "| %s |", scene->name);
        for (size_t i = 0; i < gw_knob_count; i++) {
            const gw_accuracy_curve *curve = gw_knobs[i].model ? curve_of(scene, &gw_knobs[i]) : NULL;
            if (curve && curve->model_ratio > 0)
                fprintf(page, " %.2f |", curve->model_ratio);
            else
                fputs(gw_knobs[i].model ? " |" : "", page);
        }
        fprintf(page, " %.0f %% |\n", 100 * scene->model.error);
    }
}

/* --- a sentence for each knob */

/* "8 +59 % work, -0.0029 FLIP"; with what separates it from what stands before it. */
static void put_step(FILE *page, const gw_accuracy_row *standing, const gw_accuracy_row *row,
                     const char *before) {
    fprintf(page, "%s %s %+.0f %% work, %+.4f FLIP", before, row->value,
            100 * (work_of(row) / work_of(standing) - 1), error_of(row) - error_of(standing));
}

/* 0: nothing moves here, or what stands is at once best and cheapest. */
static int put_scene(FILE *page, const gw_accuracy_scene *scene, const gw_accuracy_curve *curve) {
    const gw_accuracy_row *rows = &scene->rows[curve->first], *standing = NULL, *best = rows,
                          *cheapest = rows;
    for (size_t i = 0; i < curve->count; i++) {
        standing = rows[i].standing ? &rows[i] : standing;
        best = error_of(&rows[i]) < error_of(best) ? &rows[i] : best;
        cheapest = work_of(&rows[i]) < work_of(cheapest) ? &rows[i] : cheapest;
    }
    if (curve->idle || !standing || (best == standing && cheapest == standing))
        return 0;
    fprintf(page, " %s:", scene->name);
    if (best != standing)
        put_step(page, standing, best, "");
    if (cheapest != standing && cheapest != best)
        put_step(page, standing, cheapest, best != standing ? ";" : "");
    fputc('.', page);
    return 1;
}

static int put_knob(FILE *page, const gw_accuracy *accuracy, const gw_knob *knob) {
    int told = 0;
    for (size_t s = 0; s < accuracy->scene_count; s++) {
        const gw_accuracy_curve *curve = curve_of(&accuracy->scenes[s], knob);
        char *text = NULL;
        size_t size = 0;
        FILE *sentence = curve ? open_memstream(&text, &size) : NULL;
        if (!sentence)
            continue;
        const int moves = put_scene(sentence, &accuracy->scenes[s], curve);
        fclose(sentence);
        if (moves && !told++) {
            char standing[64];
            gw_setting_text(&accuracy->bench->draw.settings, gw_knob_setting(knob), standing);
            fprintf(page, "- `%s` (%s)", knob->name, standing);
        }
        fputs(moves ? text : "", page);
        free(text);
    }
    fputs(told ? "\n" : "", page);
    return told;
}

static int is_measured(const gw_accuracy *accuracy, const gw_knob *knob) {
    for (size_t s = 0; s < accuracy->scene_count; s++)
        if (curve_of(&accuracy->scenes[s], knob))
            return 1;
    return 0;
}

static void put_knobs(FILE *page, const gw_accuracy *accuracy) {
    size_t idle = 0;
    char still[64 * 64];
    size_t used = 0;
    fputs("\n## What each knob costs\n\nFrom the value that stands (in brackets) to the one that errs least "
          "and to "
          "the cheapest; the scenes' pages have every value.\n\n",
          page);
    for (size_t i = 0; i < gw_knob_count; i++)
        if (is_measured(accuracy, &gw_knobs[i]) && !put_knob(page, accuracy, &gw_knobs[i]) &&
            used + 80 < sizeof still)
            used += (size_t)snprintf(still + used, sizeof still - used, "%s`%s`", idle++ ? ", " : "",
                                     gw_knobs[i].name);
    if (idle)
        fprintf(page, "\nWithout effect in these scenes, or best and cheapest as they stand: %s.\n", still);
}

gw_code gw_accuracy_digest(const gw_accuracy *accuracy, gw_error *error) {
    char *text = NULL, *path = gw_picture_path(accuracy->bench->out, "%s.md", "accuracy");
    const char *command = json_string_value(json_object_get(accuracy->bench->report, "command"));
    size_t size = 0;
    FILE *page = path ? open_memstream(&text, &size) : NULL;
    if (!page) {
        free(path);
        return gw_fail(error, GW_MACHINE, "memory is out while writing a page");
    }
    fprintf(page, "# The knobs, over all scenes\n\n`gazewall %s`\n\n", command ? command : "bench accuracy");
    put_models(page, accuracy);
    put_knobs(page, accuracy);
    fclose(page);
    gw_interrupt_hold();
    gw_code code = gw_file_write(path, text, size, error);
    gw_interrupt_release();
    free(text);
    free(path);
    return code;
}
