/* See bench_accuracy.h: tables, plots, and what is printed. */
#include "wall/bench_accuracy.h"

#include "base/file.h"
#include "wall/interrupt.h"
#include "wall/picture.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --- columns */

const gw_accuracy_column gw_accuracy_columns[GW_ACCURACY_COLUMNS] = {
    {GW_METRIC_FLIP, "FLIP", "%.4f"},
    {GW_METRIC_SEEN_FLIP, "as seen", "%.4f"},
    {GW_METRIC_PSNR, "PSNR dB", "%.2f"},
    {GW_METRIC_HIT_MISMATCH, "hits", "%.4f"},
    {GW_METRIC_DEPTH_95, "depth px", "%.2f"},
    {GW_METRIC_NORMAL_95, "normal", "%.1f"},
    {GW_METRIC_SILHOUETTE_LARGEST, "edge px", "%.1f"},
    {GW_METRIC_FLICKER, "flicker", "%.4f"},
    {GW_METRIC_POP, "pop", "%.4f"},
};

int gw_accuracy_shows(const gw_accuracy_scene *scene, size_t column) {
    const gw_metric metric = gw_accuracy_columns[column].metric;
    return metric < GW_METRIC_FLICKER || isfinite(scene->standing.errors.values[metric]);
}

/* --- CSV */

static void write_heading(FILE *csv) {
    fputs("scene,knob,value,standing,front,best_front", csv);
    for (size_t i = 0; i < GW_LEDGER_COSTS; i++)
        fprintf(csv, ",%s", gw_ledger_cost_names[i]);
    fputs(",own_flip,spread_ms,predicted_error,predicted_worst,octree_bytes,nodes,pairs,pixel_rays,shadow_"
          "rays,mirror_"
          "rays,"
          "refracted_rays,steps,node_loads,triangle_tests,voxels",
          csv);
    for (size_t i = 0; i < GW_METRIC_COUNT; i++)
        fprintf(csv, ",%s", gw_metric_table[i].name);
    fputc('\n', csv);
}

static void write_row(FILE *csv, const gw_accuracy_scene *scene, const gw_accuracy_row *row) {
    const gw_ledger_point *p = &row->point;
    const gw_counters *c = &p->counters;
    fprintf(csv, "%s,%s,%s,%d,%d,%d", scene->name, row->knob->name, row->value, row->standing, row->front,
            row->best_front);
    for (size_t i = 0; i < GW_LEDGER_COSTS; i++)
        fprintf(csv, ",%.12g", p->costs[i]);
    if (isfinite(p->own))
        fprintf(csv, ",%.6g", p->own);
    else
        fputc(',', csv);
    fprintf(csv, ",%.4g,%.6g,%.6g", p->spread_ms, p->predicted, p->worst);
    const uint64_t counts[] = {p->octree_bytes, p->nodes,          p->pairs,          c->rays,
                               c->shadow_rays,  c->mirror_rays,    c->refracted_rays, c->steps,
                               c->node_loads,   c->triangle_tests, c->voxels};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        fprintf(csv, ",%" PRIu64, counts[i]);
    for (size_t i = 0; i < GW_METRIC_COUNT; i++)
        if (isfinite(p->errors.values[i]))
            fprintf(csv, ",%.6g", p->errors.values[i]);
        else
            fputc(',', csv);
    fputc('\n', csv);
}

static gw_code write_rows(const gw_accuracy *accuracy, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *csv = open_memstream(&text, &size);
    if (!csv)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    write_heading(csv);
    for (size_t s = 0; s < accuracy->scene_count; s++)
        for (size_t i = 0; i < accuracy->scenes[s].row_count; i++)
            write_row(csv, &accuracy->scenes[s], &accuracy->scenes[s].rows[i]);
    fclose(csv);
    gw_code code = gw_bench_write(accuracy->bench, "accuracy", text, size, error);
    free(text);
    return code;
}

/* --- JSON */

static json_t *curve_json(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve) {
    char sentence[512];
    json_t *rows = json_array();
    gw_accuracy_sentence(scene, curve, sentence, sizeof sentence);
    for (size_t i = 0; i < curve->count; i++) {
        const gw_accuracy_row *row = &scene->rows[curve->first + i];
        json_array_append_new(rows, json_pack("{s:s, s:b, s:b, s:o}", "value", row->value, "standing",
                                              row->standing, "front", row->front, "point",
                                              gw_ledger_pack(&row->point)));
    }
    const gw_setting_row *setting = gw_knob_setting(curve->knob);
    return json_pack("{s:s, s:s, s:s, s:s, s:s?, s:s, s:b, s:o, s:o, s:o}", "knob", curve->knob->name, "unit",
                     setting->unit, "trades", setting->trades, "reference", setting->reference, "with",
                     curve->knob->with, "sentence", sentence, "idle", curve->idle, "model_ratio",
                     curve->model_ratio > 0 ? json_real(curve->model_ratio) : json_null(), "fault",
                     curve->fault[0] ? json_string(curve->fault) : json_null(), "rows", rows);
}

static json_t *scene_json(const gw_accuracy_scene *scene) {
    json_t *curves = json_array(), *model = scene->model.samples ? gw_cost_report(&scene->model) : NULL;
    for (size_t c = 0; c < scene->curve_count; c++)
        json_array_append_new(curves, curve_json(scene, &scene->curves[c]));
    return json_pack(
        "{s:s, s:s, s:s, s:i, s:[i,i], s:f, s:i, s:i, s:s, s:o, s:o, s:O?, s:o}", "name", scene->name, "file",
        scene->path, "hash", scene->hash, "triangles", (int)scene->triangles, "size", (int)scene->size[0],
        (int)scene->size[1], "pixels_per_degree", scene->pixels_per_degree, "measured", (int)scene->measured,
        "found", (int)scene->found, "exact", scene->exact_key, "standing", gw_ledger_pack(&scene->standing),
        "cost_model", model ? model : json_null(), "search", scene->found_profile, "curves", curves);
}

static void fill_report(const gw_accuracy *accuracy) {
    json_t *scenes = json_array();
    for (size_t s = 0; s < accuracy->scene_count; s++)
        json_array_append_new(scenes, scene_json(&accuracy->scenes[s]));
    json_object_set_new(accuracy->bench->report, "bench",
                        json_pack("{s:s, s:s, s:b, s:i, s:o}", "name", "accuracy", "clock", accuracy->clock,
                                  "counted_while_timed", accuracy->counted, "faults",
                                  (int)gw_accuracy_faults(accuracy), "scenes", scenes));
}

/* --- plots */

static gw_code write_plot(const gw_bench *bench, const gw_accuracy_scene *scene,
                          const gw_accuracy_curve *curve, gw_error *error) {
    const char *name = curve ? curve->knob->name : "front";
    char *svg = NULL, *folder = gw_path_join(bench->out, scene->name);
    char *text_path = folder ? gw_picture_path(folder, "%s.svg", name) : NULL,
         *image_path = folder ? gw_picture_path(folder, "%s.png", name) : NULL;
    size_t size = 0;
    gw_image image = {0};
    gw_code code = text_path && image_path ? gw_accuracy_plot(scene, curve, &svg, &size, &image, error)
                                           : gw_fail(error, GW_MACHINE, "memory is out while naming a plot");
    gw_interrupt_hold();
    if (!code)
        code = gw_file_write(text_path, svg, size, error);
    if (!code)
        code = gw_image_write_png(image_path, &image, NULL, error);
    gw_interrupt_release();
    gw_image_finish(&image);
    free(svg);
    free(folder);
    free(text_path);
    free(image_path);
    return code;
}

gw_code gw_accuracy_write(const gw_accuracy *accuracy, gw_error *error) {
    fill_report(accuracy);
    if (!accuracy->bench->out)
        return GW_OK;
    gw_code code = write_rows(accuracy, error);
    for (size_t s = 0; s < accuracy->scene_count && !code; s++) {
        const gw_accuracy_scene *scene = &accuracy->scenes[s];
        code = write_plot(accuracy->bench, scene, NULL, error);
        if (!code)
            code = gw_accuracy_sheet(accuracy, scene, error);
        for (size_t c = 0; c < scene->curve_count && !code; c++)
            if (!scene->curves[c].idle)
                code = write_plot(accuracy->bench, scene, &scene->curves[c], error);
    }
    return code;
}

/* --- what is printed */

/* An empty place where it could not be measured. */
static void print_number(double value, const gw_accuracy_column *column) {
    char text[32] = "";
    if (!isnan(value))
        snprintf(text, sizeof text, column->format, value);
    printf(" %9s", text);
}

static void print_curve(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve) {
    if (curve->idle)
        return;
    for (size_t i = 0; i < curve->count; i++) {
        const gw_accuracy_row *row = &scene->rows[curve->first + i];
        const gw_ledger_point *p = &row->point;
        printf("  %-20s %-12s%c%c", i ? "" : curve->knob->name, row->value, row->standing ? '*' : ' ',
               row->front ? '+' : ' ');
        for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
            if (gw_accuracy_shows(scene, k))
                print_number(p->errors.values[gw_accuracy_columns[k].metric], &gw_accuracy_columns[k]);
        printf(" %9.0f %9.2f %9.1f\n", p->costs[GW_LEDGER_RAYS], p->costs[GW_LEDGER_WORK] * 1e-6,
               p->costs[GW_LEDGER_MS]);
    }
    if (curve->fault[0])
        printf("  FAULT %s\n", curve->fault);
}

static void print_scene(const gw_accuracy *accuracy, const gw_accuracy_scene *scene) {
    char model[240];
    size_t idle = 0;
    printf(
        "The ledger of %s: %ux%u px, %.1f px a degree where the viewer looks, %zu frames measured, %zu known "
        "before; %s time%s.\n",
        scene->path, scene->size[0], scene->size[1], scene->pixels_per_degree, scene->measured, scene->found,
        accuracy->clock, accuracy->counted ? ", counting kernels" : "");
    printf("  %-20s %-14s", "knob", "value");
    for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
        if (gw_accuracy_shows(scene, k))
            printf(" %9s", gw_accuracy_columns[k].name);
    printf(" %9s %9s %9s   * as it stands, + front\n", "rays", "work/M", "ms");
    for (size_t c = 0; c < scene->curve_count; c++) {
        print_curve(scene, &scene->curves[c]);
        idle += (size_t)scene->curves[c].idle;
    }
    if (idle)
        printf("  %zu knobs change nothing here:", idle);
    for (size_t c = 0; c < scene->curve_count; c++)
        if (scene->curves[c].idle)
            printf(" %s", scene->curves[c].knob->name);
    if (idle)
        printf("\n");
    if (scene->model.samples) {
        gw_cost_describe(&scene->model, model, sizeof model);
        printf("  cost model: %s; off by %.0f %% (root mean square)\n", model, 100 * scene->model.error);
    }
    const char *found = json_string_value(json_object_get(scene->found_profile, "sentence"));
    if (found)
        printf("  %s\n", found);
}

void gw_accuracy_print(const gw_accuracy *accuracy) {
    for (size_t s = 0; s < accuracy->scene_count; s++)
        print_scene(accuracy, &accuracy->scenes[s]);
    if (gw_accuracy_faults(accuracy))
        printf("%zu FAULTS.\n", gw_accuracy_faults(accuracy));
    if (accuracy->bench->out)
        printf("look at %s/accuracy.html\n", accuracy->bench->out);
}
