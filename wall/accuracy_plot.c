/* See bench_accuracy.h: error against work, of a knob or of all. */
#include "wall/bench_accuracy.h"

#include "base/memory.h"
#include "wall/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Logarithmic axes have no place for 0. */
static const double least_drawn = 1e-4;

enum { LABEL = 100 };

/* What a series of rows needs; [count] each, owned. */
typedef struct drawn {
    size_t count;
    double *work, *flip, *seen;
    uint8_t *ringed;
    char (*text)[LABEL];
    const char **labels;
} drawn;

static void drop(drawn *d) {
    free(d->work);
    free(d->flip);
    free(d->seen);
    free(d->ringed);
    free(d->text);
    free(d->labels);
}

static gw_code make_room(drawn *d, size_t count, gw_error *error) {
    *d = (drawn){0};
    gw_code code = gw_allocate((void **)&d->work, count, sizeof *d->work, "a plot", error);
    if (!code)
        code = gw_allocate((void **)&d->flip, count, sizeof *d->flip, "a plot", error);
    if (!code)
        code = gw_allocate((void **)&d->seen, count, sizeof *d->seen, "a plot", error);
    if (!code)
        code = gw_allocate((void **)&d->ringed, count, sizeof *d->ringed, "a plot", error);
    if (!code)
        code = gw_allocate((void **)&d->text, count, sizeof *d->text, "a plot", error);
    return code ? code : gw_allocate((void **)&d->labels, count, sizeof *d->labels, "a plot", error);
}

static double drawable(double error) {
    return fmax(error, least_drawn); /* also of what is no number */
}

static void add(drawn *d, const gw_accuracy_row *row, double standing, int ringed, const char *label) {
    const size_t i = d->count++;
    d->work[i] = row->point.costs[GW_LEDGER_WORK] / standing;
    d->flip[i] = drawable(row->point.errors.values[GW_METRIC_FLIP]);
    d->seen[i] = drawable(row->point.errors.values[GW_METRIC_SEEN_FLIP]);
    d->ringed[i] = (uint8_t)ringed;
    snprintf(d->text[i], LABEL, "%s", label);
    d->labels[i] = d->text[i];
}

/* Of two series, the first with its values' names. */
static gw_plot errors_against_work(const char *title, const char *work, const gw_plot_series series[2]) {
    return (gw_plot){.title = title,
                     .x_label = work,
                     .y_label = "error (mean FLIP; below 0.0001 drawn there)",
                     .series = series,
                     .series_count = 2,
                     .tight = 1};
}

static gw_code draw(const gw_plot *plot, char **svg, size_t *size, gw_image *image, gw_error *error) {
    gw_code code = svg ? gw_plot_svg(plot, svg, size, error) : GW_OK;
    return code || !image ? code : gw_plot_image(plot, image, error);
}

static gw_code plot_curve(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve, char **svg,
                          size_t *size, gw_image *image, gw_error *error) {
    const gw_accuracy_row *rows = &scene->rows[curve->first];
    double standing = 1;
    char title[160];
    drawn d;
    gw_code code = make_room(&d, curve->count, error);
    for (size_t i = 0; i < curve->count; i++)
        standing = rows[i].standing ? fmax(rows[i].point.costs[GW_LEDGER_WORK], 1) : standing;
    for (size_t i = 0; i < curve->count && !code; i++)
        add(&d, &rows[i], standing, rows[i].front, rows[i].value);
    snprintf(title, sizeof title, "%s in %s: error against work; ringed: the front", curve->knob->name,
             scene->name);
    const gw_plot_series series[2] = {
        {.name = "FLIP", .x = d.work, .y = d.flip, .count = d.count, .labels = d.labels, .ringed = d.ringed},
        {.name = "as seen", .x = d.work, .y = d.seen, .count = d.count}};
    const gw_plot plot =
        errors_against_work(title, "work, as a share of that of the value that stands", series);
    if (!code)
        code = draw(&plot, svg, size, image, error);
    drop(&d);
    return code;
}

static int by_work(const void *a, const void *b) {
    const gw_accuracy_row *x = *(const gw_accuracy_row *const *)a, *y = *(const gw_accuracy_row *const *)b;
    const double p = x->point.costs[GW_LEDGER_WORK], q = y->point.costs[GW_LEDGER_WORK];
    return (p > q) - (p < q);
}

/* The front of all knobs as a line, in order of work, and every point. */
static gw_code plot_scene(const gw_accuracy_scene *scene, char **svg, size_t *size, gw_image *image,
                          gw_error *error) {
    const double standing = fmax(scene->standing.costs[GW_LEDGER_WORK], 1);
    const gw_accuracy_row **order = NULL;
    drawn all, front = {0};
    char title[120], label[LABEL];
    gw_code code = make_room(&all, scene->row_count, error);
    if (!code)
        code = make_room(&front, scene->row_count, error);
    if (!code)
        code = gw_allocate((void **)&order, scene->row_count, sizeof *order, "a plot", error);
    for (size_t i = 0; i < scene->row_count && !code; i++)
        order[i] = &scene->rows[i];
    if (!code)
        qsort(order, scene->row_count, sizeof *order, by_work);
    for (size_t i = 0; i < scene->row_count && !code; i++) {
        const gw_accuracy_row *row = order[i];
        snprintf(label, sizeof label, "%s=%.24s", row->knob->name, row->value);
        if (!row->knob->with && row->knob->reference == GW_KNOB_EXACT && row->knob->age == 0)
            add(&all, row, standing, 0, label);
        if (row->best_front)
            add(&front, row, standing, 1, label);
    }
    snprintf(title, sizeof title, "%s: every knob, one at a time; ringed: the front", scene->name);
    const gw_plot_series series[2] = {
        {.name = "all values", .x = all.work, .y = all.flip, .count = all.count, .loose = 1},
        {.name = "front",
         .x = front.work,
         .y = front.flip,
         .count = front.count,
         .labels = front.labels,
         .ringed = front.ringed}};
    const gw_plot plot =
        errors_against_work(title, "work, as a share of that of the settings that stand", series);
    if (!code)
        code = draw(&plot, svg, size, image, error);
    free(order);
    drop(&all);
    drop(&front);
    return code;
}

gw_code gw_accuracy_plot(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve, char **svg,
                         size_t *size, gw_image *image, gw_error *error) {
    return curve ? plot_curve(scene, curve, svg, size, image, error)
                 : plot_scene(scene, svg, size, image, error);
}
