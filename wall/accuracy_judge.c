/* See bench_accuracy.h: what the points of a sweep say. */
#include "wall/bench_accuracy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An error may rise by so much on the way to the exact value: share, and FLIP. */
static const double rise_share = 0.05, rise_least = 1e-3;
/* FLIP grows as this power of the predicted error, from here on; fitted to the scenes of docs/ledger. */
static const double model_power = 0.6, model_least = 1.25;
/* Below it, values differ by nothing: shares of work, and FLIP. */
static const double same_share = 1e-6, same_error = 1e-6;

static double error_of(const gw_accuracy_row *row) {
    return row->point.errors.values[GW_METRIC_FLIP];
}

/* Of the knob alone, where it has an exact value. */
static double own_of(const gw_accuracy_row *row) {
    return isfinite(row->point.own) ? row->point.own : error_of(row);
}

static double work_of(const gw_accuracy_row *row) {
    return row->point.costs[GW_LEDGER_WORK];
}

/* 1 when no row of [first, end) is as good in both and better in one; of equal rows the first stands. */
static int is_front(const gw_accuracy_scene *scene, size_t which, size_t first, size_t end) {
    const gw_accuracy_row *me = &scene->rows[which];
    for (size_t i = first; i < end; i++) {
        const gw_accuracy_row *other = &scene->rows[i];
        const int no_worse = error_of(other) <= error_of(me) && work_of(other) <= work_of(me);
        const int equal = error_of(other) == error_of(me) && work_of(other) == work_of(me);
        if (i != which && no_worse && (!equal || i < which))
            return 0;
    }
    return 1;
}

void gw_accuracy_mark_fronts(gw_accuracy_scene *scene) {
    for (size_t c = 0; c < scene->curve_count; c++) {
        const gw_accuracy_curve *curve = &scene->curves[c];
        for (size_t i = 0; i < curve->count; i++) {
            gw_accuracy_row *row = &scene->rows[curve->first + i];
            row->front = is_front(scene, curve->first + i, curve->first, curve->first + curve->count);
            /* Curves with something set beside them, or against a reference of their own, are other frames.
             */
            row->best_front = !curve->knob->with && curve->knob->reference == GW_KNOB_EXACT &&
                              curve->knob->age == 0 && row->front &&
                              is_front(scene, curve->first + i, 0, scene->row_count);
        }
    }
}

/* Where a value stands on the setting's scale. */
static double place_of(const gw_knob *knob, const char *value) {
    char assignment[2 * GW_KNOB_TEXT];
    gw_settings settings;
    gw_settings_init(&settings);
    snprintf(assignment, sizeof assignment, "%s=%s", knob->name, value);
    return gw_settings_assign(&settings, assignment, NULL)
               ? (double)NAN
               : gw_setting_value(&settings, gw_knob_setting(knob));
}

/* Rows stand in ascending order; the exact value lies at one of their ends or beyond it. Told is the first
 * step towards it at which the error rises. */
static void judge_direction(const gw_accuracy_scene *scene, gw_accuracy_curve *curve) {
    const gw_accuracy_row *rows = &scene->rows[curve->first];
    if (!curve->knob->exact || curve->count < 2)
        return;
    const double exact = place_of(curve->knob, curve->knob->exact);
    const int descending = exact <= place_of(curve->knob, rows[0].value);
    if (!descending && exact < place_of(curve->knob, rows[curve->count - 1].value))
        return;
    for (size_t k = 1; k < curve->count; k++) {
        const gw_accuracy_row *before = &rows[descending ? curve->count - k : k - 1],
                              *after = &rows[descending ? curve->count - 1 - k : k];
        if (own_of(after) > own_of(before) * (1 + rise_share) + rise_least) {
            snprintf(
                curve->fault, sizeof curve->fault,
                "%s: its error rises from %.4f to %.4f FLIP on the way to the exact value %s, from %.24s to "
                "%.24s",
                curve->knob->name, own_of(before), own_of(after), curve->knob->exact, before->value,
                after->value);
            return;
        }
    }
}

static void judge_counts(const gw_accuracy_scene *scene, gw_accuracy_curve *curve) {
    for (size_t i = 0; i < curve->count; i++) {
        const gw_accuracy_row *row = &scene->rows[curve->first + i];
        const gw_counters *c = &row->point.counters;
        if (c->nan_pixels || c->step_cap_hits)
            snprintf(curve->fault, sizeof curve->fault,
                     "%s=%.24s: %.0f pixels are no numbers, %.0f rays were cut off", curve->knob->name,
                     row->value, (double)c->nan_pixels, (double)c->step_cap_hits);
        if (!isfinite(error_of(row)))
            snprintf(curve->fault, sizeof curve->fault, "%s=%.24s: the error is no number", curve->knob->name,
                     row->value);
    }
}

/* The model tells how many times too coarse a frame is, the metric how different it looks: only their growth
 * from value to value can be compared, and FLIP grows more slowly than coarseness: pictures have the less
 * contrast the finer it is, and FLIP has a ceiling. Below model_least the frame as a whole is as good as
 * exact: the mean over all places hides what some of them have. */
static void judge_model(const gw_accuracy_scene *scene, gw_accuracy_curve *curve) {
    const gw_accuracy_row *rows = &scene->rows[curve->first], *from = NULL;
    if (!curve->knob->model)
        return;
    /* From the least value on of which the model says anything. */
    for (size_t i = 0; i < curve->count && !from; i++)
        if (rows[i].point.predicted > model_least && own_of(&rows[i]) > 0)
            from = &rows[i];
    double farthest = 0;
    for (size_t i = 0; i < curve->count && from; i++) {
        const double told = pow(rows[i].point.predicted / from->point.predicted, model_power),
                     measured = own_of(&rows[i]) / own_of(from);
        const double ratio = measured > 0 ? told / measured : INFINITY;
        if (&rows[i] > from && fabs(log(ratio)) >= fabs(farthest)) {
            farthest = log(ratio);
            curve->model_ratio = ratio;
        }
    }
}

void gw_accuracy_judge(const gw_accuracy_scene *scene, gw_accuracy_curve *curve) {
    const gw_accuracy_row *rows = &scene->rows[curve->first];
    double standing = 0;
    curve->fault[0] = '\0';
    curve->model_ratio = 0;
    curve->least_work = curve->least_error = INFINITY;
    curve->most_work = curve->most_error = -INFINITY;
    for (size_t i = 0; i < curve->count; i++) {
        if (rows[i].standing)
            standing = work_of(&rows[i]);
        curve->least_work = fmin(curve->least_work, work_of(&rows[i]));
        curve->most_work = fmax(curve->most_work, work_of(&rows[i]));
        curve->least_error = fmin(curve->least_error, error_of(&rows[i]));
        curve->most_error = fmax(curve->most_error, error_of(&rows[i]));
    }
    curve->idle = curve->most_work <= curve->least_work * (1 + same_share) &&
                  curve->most_error <= curve->least_error + same_error;
    if (standing > 0) {
        curve->least_work /= standing;
        curve->most_work /= standing;
    }
    judge_model(scene, curve);
    judge_direction(scene, curve);
    judge_counts(scene, curve);
}

size_t gw_accuracy_faults(const gw_accuracy *accuracy) {
    size_t faults = 0;
    for (size_t s = 0; s < accuracy->scene_count; s++)
        for (size_t c = 0; c < accuracy->scenes[s].curve_count; c++)
            faults += accuracy->scenes[s].curves[c].fault[0] != '\0';
    return faults;
}

/* --- what a knob costs, in a sentence */

/* "12 % less", "as much", "2.3 times as much". */
static void share_text(double share, char *text, size_t size) {
    if (fabs(share - 1) < 0.0005)
        snprintf(text, size, "the same");
    else if (share >= 2)
        snprintf(text, size, "%.1f times the", share);
    else
        snprintf(text, size, "%.1f %% %s", 100 * fabs(share - 1), share < 1 ? "less" : "more");
}

void gw_accuracy_sentence(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve, char *text,
                          size_t size) {
    const gw_accuracy_row *rows = &scene->rows[curve->first], *standing = NULL, *best = rows,
                          *cheapest = rows;
    char best_text[32], cheapest_text[32];
    for (size_t i = 0; i < curve->count; i++) {
        standing = rows[i].standing ? &rows[i] : standing;
        best = error_of(&rows[i]) < error_of(best) ? &rows[i] : best;
        cheapest = work_of(&rows[i]) < work_of(cheapest) ? &rows[i] : cheapest;
    }
    if (curve->idle || !standing) {
        snprintf(text, size, "%s changes nothing here.", curve->knob->name);
        return;
    }
    share_text(work_of(best) / work_of(standing), best_text, sizeof best_text);
    share_text(work_of(cheapest) / work_of(standing), cheapest_text, sizeof cheapest_text);
    snprintf(text, size,
             "%s: %s (as it stands) errs by %.4f FLIP; %.24s is best with %.4f for %s work, %.24s is "
             "cheapest with "
             "%.4f for %s work.",
             curve->knob->name, standing->value, error_of(standing), best->value, error_of(best), best_text,
             cheapest->value, error_of(cheapest), cheapest_text);
}
