/* See bench_accuracy.h: a scene's ledger as a page of Markdown with one picture, as docs/ledger/ has them. */
#include "wall/bench_accuracy.h"

#include "base/file.h"
#include "wall/interrupt.h"
#include "wall/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { PICTURE_LIMIT = 64 << 20 };

/* --- exact, as it stands, difference: side by side */

static gw_code place(gw_image *all, const char *folder, const char *key, int difference, uint32_t x,
                     gw_error *error) {
    gw_bytes bytes = {0};
    gw_image image = {0};
    char *path = gw_picture_path(folder, "%.16s%s.png", key, difference ? "-difference" : "");
    gw_code code = path ? gw_file_read(path, PICTURE_LIMIT, &bytes, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    if (!code)
        code = gw_image_decode(bytes.data, bytes.size, path, (uint64_t)1 << 28, &image, error);
    if (!code)
        gw_image_place(all, &image, x, 0);
    gw_image_finish(&image);
    gw_bytes_finish(&bytes);
    free(path);
    return code;
}

static gw_code write_triple(const gw_accuracy_scene *scene, const char *folder, gw_error *error) {
    char *path = gw_picture_path(folder, "%s.png", "pictures");
    gw_image all = {0};
    gw_code code = path ? gw_image_create(3 * scene->size[0], scene->size[1], &all, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    if (!code)
        code = place(&all, folder, scene->exact_key, 0, 0, error);
    if (!code)
        code = place(&all, folder, scene->standing.key, 0, scene->size[0], error);
    if (!code)
        code = place(&all, folder, scene->standing.key, 1, 2 * scene->size[0], error);
    gw_interrupt_hold();
    if (!code)
        code = gw_image_write_png(path, &all, NULL, error);
    gw_interrupt_release();
    gw_image_finish(&all);
    free(path);
    return code;
}

/* --- the page */

static void put_geometry(FILE *page, const gw_ledger_point *p) {
    const double *values = p->errors.values;
    if (!isnan(values[GW_METRIC_HIT_MISMATCH]))
        fprintf(page, "Geometry: %.2f %% of the pixels hit in one frame only",
                100 * values[GW_METRIC_HIT_MISMATCH]);
    if (!isnan(values[GW_METRIC_DEPTH_95]))
        fprintf(page, "; depth %.2f px and normal %.1f degrees at the 95th percentile",
                values[GW_METRIC_DEPTH_95], values[GW_METRIC_NORMAL_95]);
    if (!isnan(values[GW_METRIC_SILHOUETTE_LARGEST]))
        fprintf(page, "; silhouettes up to %.1f px apart", values[GW_METRIC_SILHOUETTE_LARGEST]);
    fputs(".\n", page);
}

static void put_head(FILE *page, const gw_accuracy *accuracy, const gw_accuracy_scene *scene) {
    const gw_ledger_point *p = &scene->standing;
    const char *command = json_string_value(json_object_get(accuracy->bench->report, "command"));
    char model[240];
    fprintf(page,
            "# The ledger of %s\n\n`gazewall %s`\n\n%s, %u triangles; %ux%u px, %.1f px a degree where the "
            "viewer looks. "
            "Exact, as the settings stand, and their difference (FLIP):\n\n![exact, as it stands, difference]"
            "(%s.png)\n\n",
            scene->name, command ? command : "bench accuracy", scene->path, scene->triangles, scene->size[0],
            scene->size[1], scene->pixels_per_degree, scene->name);
    fprintf(
        page,
        "As the settings stand: FLIP %.4f, as seen %.4f, PSNR %.1f dB, bias %+.4f; %.0f rays, %.2f million "
        "units of work, %.0f ms of %s time.\n",
        p->errors.values[GW_METRIC_FLIP], p->errors.values[GW_METRIC_SEEN_FLIP],
        p->errors.values[GW_METRIC_PSNR], p->errors.values[GW_METRIC_BIAS], p->costs[GW_LEDGER_RAYS],
        p->costs[GW_LEDGER_WORK] * 1e-6, p->costs[GW_LEDGER_MS], accuracy->clock);
    put_geometry(page, p);
    if (scene->model.samples) {
        gw_cost_describe(&scene->model, model, sizeof model);
        fprintf(page, "Cost model: %s; off by %.0f %% (root mean square).\n", model,
                100 * scene->model.error);
    }
    fprintf(page, "\n![every knob, one at a time](%s.svg)\n\n", scene->name);
}

static double work_of(const gw_ledger_point *p) {
    return p->costs[GW_LEDGER_WORK] * 1e-6;
}

static double ms_of(const gw_ledger_point *p) {
    return p->costs[GW_LEDGER_MS];
}

static double megabytes_of(const gw_ledger_point *p) {
    return (double)p->octree_bytes * 1e-6;
}

/* "0.1520..0.2369": of a metric, or of a cost (of, not NULL); nothing where none could be measured. */
static void put_span(FILE *page, const gw_accuracy_scene *scene, const gw_accuracy_curve *curve,
                     gw_metric metric, double (*of)(const gw_ledger_point *p), const char *format) {
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < curve->count; i++) {
        const gw_ledger_point *p = &scene->rows[curve->first + i].point;
        const double value = of ? of(p) : p->errors.values[metric];
        least = fmin(least, value);
        most = fmax(most, value);
    }
    fputc(' ', page);
    if (least <= most) {
        fprintf(page, format, least);
        fputs("..", page);
        fprintf(page, format, most);
    }
    fputs(" |", page);
}

/* PSNR follows FLIP, and a page is no wider than need be. */
static int is_shown(const gw_accuracy_scene *scene, size_t column) {
    return gw_accuracy_columns[column].metric != GW_METRIC_PSNR && gw_accuracy_shows(scene, column);
}

static void put_knobs(FILE *page, const gw_accuracy_scene *scene) {
    fputs("| knob | values |", page);
    for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
        if (is_shown(scene, k))
            fprintf(page, " %s |", gw_accuracy_columns[k].name);
    fputs(" work, M | ms | octree, MB |\n|---|---|", page);
    for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
        fputs(is_shown(scene, k) ? "---|" : "", page);
    fputs("---|---|---|\n", page);
    for (size_t c = 0; c < scene->curve_count; c++) {
        const gw_accuracy_curve *curve = &scene->curves[c];
        if (curve->idle)
            continue;
        fprintf(page, "| `%s` | ", curve->knob->name);
        for (size_t i = 0; i < curve->count; i++) {
            const gw_accuracy_row *row = &scene->rows[curve->first + i];
            fprintf(page, "%s%s%s%s", i ? " " : "", row->standing ? "**" : "", row->value,
                    row->standing ? "**" : "");
        }
        fputs(" |", page);
        for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
            if (is_shown(scene, k))
                put_span(page, scene, curve, gw_accuracy_columns[k].metric, NULL,
                         gw_accuracy_columns[k].format);
        put_span(page, scene, curve, 0, work_of, "%.2f");
        put_span(page, scene, curve, 0, ms_of, "%.0f");
        put_span(page, scene, curve, 0, megabytes_of, "%.0f");
        fputc('\n', page);
    }
}

static void put_sentences(FILE *page, const gw_accuracy_scene *scene) {
    char text[512];
    size_t idle = 0;
    fputs("\nWhat each knob costs:\n\n", page);
    for (size_t c = 0; c < scene->curve_count; c++) {
        if (scene->curves[c].idle)
            continue;
        gw_accuracy_sentence(scene, &scene->curves[c], text, sizeof text);
        fprintf(page, "- %s%s%s\n", text, scene->curves[c].fault[0] ? " FAULT: " : "",
                scene->curves[c].fault);
    }
    for (size_t c = 0; c < scene->curve_count; c++)
        if (scene->curves[c].idle)
            fprintf(page, "%s`%s`",
                    idle++ ? ", " : "\nWithout effect in this scene: ", scene->curves[c].knob->name);
    fputs(idle ? ".\n" : "", page);
}

static gw_code write_page(const gw_accuracy *accuracy, const gw_accuracy_scene *scene, const char *folder,
                          gw_error *error) {
    char *text = NULL, *path = gw_picture_path(folder, "%s.md", "ledger");
    size_t size = 0;
    FILE *page = path ? open_memstream(&text, &size) : NULL;
    if (!page) {
        free(path);
        return gw_fail(error, GW_MACHINE, "memory is out while writing a page");
    }
    put_head(page, accuracy, scene);
    put_knobs(page, scene);
    put_sentences(page, scene);
    fclose(page);
    gw_interrupt_hold();
    gw_code code = gw_file_write(path, text, size, error);
    gw_interrupt_release();
    free(text);
    free(path);
    return code;
}

gw_code gw_accuracy_sheet(const gw_accuracy *accuracy, const gw_accuracy_scene *scene, gw_error *error) {
    char *folder = gw_path_join(accuracy->bench->out, scene->name);
    gw_code code = folder ? write_triple(scene, folder, error)
                          : gw_fail(error, GW_MACHINE, "memory is out while naming a folder");
    if (!code)
        code = write_page(accuracy, scene, folder, error);
    free(folder);
    return code;
}
