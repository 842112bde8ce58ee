/* See bench_accuracy.h: one page that stands alone, with curves, pictures and numbers together. Pictures are
 * inside as data; what several knobs share stands in it once, as a style. */
#include "wall/bench_accuracy.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/version.h"
#include "wall/base64.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURE_LIMIT = 64 << 20 };

static const char style[] =
    "body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1180px;color:#222;padding:0 1em}"
    "h1,h2,h3{line-height:1.2}h2{border-top:2px solid #222;padding-top:.6em}h3{margin-top:2.2em}"
    "table{border-collapse:collapse;font-size:13px}td,th{padding:.15em "
    ".6em;text-align:right;border-bottom:1px "
    "solid #ddd}"
    "td:first-child,th:first-child{text-align:left}tr.standing{background:#eef5fb}tr.front "
    "td:first-child:after"
    "{content:' \\25cb'}"
    ".row{display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start}.fault{background:#c00;color:#fff;"
    "padding:.3em "
    ".6em}"
    "figcaption{font-size:12px;color:#555}.p{background-size:100% "
    "100%;image-rendering:pixelated;"
    "width:100%}figure{margin:0;flex:1 1 30%;max-width:384px}"
    "nav a{margin-right:.7em;white-space:nowrap}svg{max-width:100%;height:auto}code{background:#f3f3f3}\n";

static void put_text(FILE *page, const char *text) {
    for (const char *c = text; *c; c++)
        if (*c == '<' || *c == '>' || *c == '&' || *c == '"')
            fprintf(page, "&#%d;", *c);
        else
            fputc(*c, page);
}

/* --- pictures */

/* url(data:...) of a point's picture; nothing when it is not there. */
static int put_data(FILE *page, const gw_accuracy *accuracy, const gw_accuracy_scene *scene, const char *key,
                    int difference) {
    gw_bytes bytes = {0};
    char *folder = gw_path_join(accuracy->bench->out, scene->name);
    char *path = folder ? gw_picture_path(folder, "%.16s%s.png", key, difference ? "-difference" : "") : NULL;
    const int there = path && !gw_file_read(path, PICTURE_LIMIT, &bytes, NULL);
    if (there) {
        fputs("url(data:image/png;base64,", page);
        gw_base64_write(page, bytes.data, bytes.size);
        fputc(')', page);
    }
    gw_bytes_finish(&bytes);
    free(folder);
    free(path);
    return there;
}

static void put_class(FILE *page, const gw_accuracy *accuracy, const gw_accuracy_scene *scene,
                      const char *key, int difference, size_t number) {
    fprintf(page, ".s%zu%c%.16s{background-image:", number, difference ? 'd' : 'p', key);
    if (!put_data(page, accuracy, scene, key, difference))
        fputs("none", page);
    fputs("}\n", page);
}

static void put_figure(FILE *page, const gw_accuracy_scene *scene, size_t number, const char *key,
                       int difference, const char *caption) {
    fprintf(page,
            "<figure><div class=\"p s%zu%c%.16s\" style=\"aspect-ratio:%u/%u\" role=\"img\"></div>"
            "<figcaption>",
            number, difference ? 'd' : 'p', key, scene->size[0], scene->size[1]);
    put_text(page, caption);
    fputs("</figcaption></figure>\n", page);
}

/* The value that looks worst. */
static const gw_accuracy_row *worst_of(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve) {
    const gw_accuracy_row *worst = &scene->rows[curve->first];
    for (size_t i = 1; i < curve->count; i++) {
        const gw_accuracy_row *row = &scene->rows[curve->first + i];
        if (row->point.errors.values[GW_METRIC_FLIP] > worst->point.errors.values[GW_METRIC_FLIP])
            worst = row;
    }
    return worst;
}

static void put_styles(FILE *page, const gw_accuracy *accuracy) {
    for (size_t s = 0; s < accuracy->scene_count; s++) {
        const gw_accuracy_scene *scene = &accuracy->scenes[s];
        put_class(page, accuracy, scene, scene->exact_key, 0, s);
        put_class(page, accuracy, scene, scene->standing.key, 0, s);
        put_class(page, accuracy, scene, scene->standing.key, 1, s);
        for (size_t c = 0; c < scene->curve_count; c++) {
            const char *key = worst_of(scene, &scene->curves[c])->point.key;
            if (scene->curves[c].idle || !strcmp(key, scene->standing.key))
                continue;
            put_class(page, accuracy, scene, key, 0, s);
            put_class(page, accuracy, scene, key, 1, s);
        }
    }
}

/* --- numbers */

static void put_number(FILE *page, double value, const char *format) {
    fputs("<td>", page);
    if (isfinite(value))
        fprintf(page, format, value);
    fputs("</td>", page);
}

static void put_table(FILE *page, const gw_accuracy_scene *scene, const gw_accuracy_curve *curve) {
    fputs("<table><tr><th>value</th>", page);
    for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
        if (gw_accuracy_shows(scene, k))
            fprintf(page, "<th>%s</th>", gw_accuracy_columns[k].name);
    fputs("<th>by "
          "itself</th><th>SSIM</th><th>bias</th><th>rays</th><th>loads</th><th>tests</th><th>voxels</"
          "th><th>MB</th><th>ms</th><th>predicted</th></"
          "tr>\n",
          page);
    for (size_t i = 0; i < curve->count; i++) {
        const gw_accuracy_row *row = &scene->rows[curve->first + i];
        const gw_ledger_point *p = &row->point;
        fprintf(page, "<tr class=\"%s%s\"><td>", row->standing ? "standing " : "", row->front ? "front" : "");
        put_text(page, row->value);
        fputs("</td>", page);
        for (size_t k = 0; k < GW_ACCURACY_COLUMNS; k++)
            if (gw_accuracy_shows(scene, k))
                put_number(page, p->errors.values[gw_accuracy_columns[k].metric],
                           gw_accuracy_columns[k].format);
        put_number(page, p->own, "%.4f");
        put_number(page, p->errors.values[GW_METRIC_SSIM], "%.4f");
        put_number(page, p->errors.values[GW_METRIC_BIAS], "%+.4f");
        put_number(page, p->costs[GW_LEDGER_RAYS], "%.0f");
        put_number(page, (double)p->counters.node_loads, "%.0f");
        put_number(page, (double)p->counters.triangle_tests, "%.0f");
        put_number(page, (double)p->counters.voxels, "%.0f");
        put_number(page, p->costs[GW_LEDGER_BYTES] * 1e-6, "%.1f");
        put_number(page, p->costs[GW_LEDGER_MS], "%.1f");
        put_number(page, p->predicted, "%.2f");
        fputs("</tr>\n", page);
    }
    fputs("</table>\n", page);
}

static gw_code put_plot(FILE *page, const gw_accuracy_scene *scene, const gw_accuracy_curve *curve,
                        gw_error *error) {
    char *svg = NULL;
    size_t size = 0;
    gw_code code = gw_accuracy_plot(scene, curve, &svg, &size, NULL, error);
    if (!code)
        fwrite(svg, 1, size, page);
    free(svg);
    return code;
}

static gw_code put_curve(FILE *page, const gw_accuracy_scene *scene, size_t number,
                         const gw_accuracy_curve *curve, gw_error *error) {
    const gw_setting_row *setting = gw_knob_setting(curve->knob);
    const gw_accuracy_row *worst = worst_of(scene, curve);
    char sentence[512], caption[160];
    gw_accuracy_sentence(scene, curve, sentence, sizeof sentence);
    fprintf(page, "<h3 id=\"s%zu-%s\">%s</h3>\n<p>", number, curve->knob->name, curve->knob->name);
    put_text(page, setting->help);
    fputs(". Trades ", page);
    put_text(page, setting->trades);
    fputs("; reference: ", page);
    put_text(page, setting->reference);
    if (curve->knob->with) {
        fputs("; with <code>", page);
        put_text(page, curve->knob->with);
        fputs("</code>", page);
    }
    fputs(".</p>\n<p><b>", page);
    put_text(page, sentence);
    fputs("</b></p>\n", page);
    if (curve->fault[0]) {
        fputs("<p class=\"fault\">", page);
        put_text(page, curve->fault);
        fputs("</p>\n", page);
    }
    fputs("<div class=\"row\">", page);
    gw_code code = put_plot(page, scene, curve, error);
    fputs("</div><div class=\"row\">", page);
    put_figure(page, scene, number, scene->exact_key, 0, "exact");
    snprintf(caption, sizeof caption, "%s=%.40s, which looks worst", curve->knob->name, worst->value);
    put_figure(page, scene, number, worst->point.key, 0, caption);
    put_figure(page, scene, number, worst->point.key, 1, "their difference (FLIP: black 0 to white 1)");
    fputs("</div>\n", page);
    put_table(page, scene, curve);
    return code;
}

/* --- the page */

static void put_links(FILE *page, const gw_accuracy_scene *scene, size_t number) {
    fputs("<nav>", page);
    for (size_t c = 0; c < scene->curve_count; c++)
        if (!scene->curves[c].idle)
            fprintf(page, "<a href=\"#s%zu-%s\">%s</a>\n", number, scene->curves[c].knob->name,
                    scene->curves[c].knob->name);
    size_t idle = 0;
    fputs("</nav>\n", page);
    for (size_t c = 0; c < scene->curve_count; c++)
        if (scene->curves[c].idle)
            fprintf(page, "%s %s",
                    idle++ ? "" : "<p>Without effect in this scene:", scene->curves[c].knob->name);
    fputs(idle ? ".</p>\n" : "", page);
}

static gw_code put_scene(FILE *page, const gw_accuracy *accuracy, size_t number, gw_error *error) {
    const gw_accuracy_scene *scene = &accuracy->scenes[number];
    char text[400];
    fputs("<h2>", page);
    put_text(page, scene->name);
    snprintf(text, sizeof text, "%.300s, %u triangles, %ux%u px, %.1f px a degree where the viewer looks",
             scene->path, scene->triangles, scene->size[0], scene->size[1], scene->pixels_per_degree);
    fputs("</h2>\n<p>", page);
    put_text(page, text);
    fputs(".</p>\n", page);
    const char *found = json_string_value(json_object_get(scene->found_profile, "sentence"));
    if (found) {
        fputs("<p><b>", page);
        put_text(page, found);
        fputs("</b></p>\n", page);
    }
    if (scene->model.samples) {
        gw_cost_describe(&scene->model, text, sizeof text);
        fputs("<p>Cost model of a frame: ", page);
        put_text(page, text);
        fprintf(page, "; off by %.0f %% (root mean square), %s time%s.</p>\n", 100 * scene->model.error,
                accuracy->clock, accuracy->counted ? " of kernels that count" : "");
    }
    fputs("<div class=\"row\">", page);
    put_figure(page, scene, number, scene->exact_key, 0, "exact");
    put_figure(page, scene, number, scene->standing.key, 0, "as the settings stand");
    put_figure(page, scene, number, scene->standing.key, 1, "their difference (FLIP: black 0 to white 1)");
    fputs("</div>\n", page);
    gw_code code = put_plot(page, scene, NULL, error);
    put_links(page, scene, number);
    for (size_t c = 0; c < scene->curve_count && !code; c++)
        if (!scene->curves[c].idle)
            code = put_curve(page, scene, number, &scene->curves[c], error);
    return code;
}

gw_code gw_accuracy_page(const gw_accuracy *accuracy, gw_error *error) {
    char *text = NULL, *path = gw_picture_path(accuracy->bench->out, "%s.html", "accuracy");
    size_t size = 0;
    FILE *page = path ? open_memstream(&text, &size) : NULL;
    if (!page) {
        free(path);
        return gw_fail(error, GW_MACHINE, "memory is out while writing a page");
    }
    const char *command = json_string_value(json_object_get(accuracy->bench->report, "command"));
    fprintf(page,
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>What accuracy "
            "costs</title>\n"
            "<style>%s",
            style);
    put_styles(page, accuracy);
    fputs("</style></head><body>\n<h1>What accuracy costs</h1>\n<p>Gazewall " GW_VERSION ", <code>gazewall ",
          page);
    put_text(page, command ? command : "bench accuracy");
    fputs("</code>. Each knob at several values, all others as they stand, against a frame without any "
          "approximation. Circles: the front, which no other value of the knob beats in both error and work. "
          "Work: "
          "rays, "
          "node loads, voxels and triangle tests, added up. As seen: behind the acuity of the viewer. "
          "Geometry: hits "
          "is the share of pixels of which one frame hits and the other does not, depth and normal (degrees) "
          "the "
          "95th percentile, edge the Hausdorff distance of the silhouettes.</p>\n",
          page);
    gw_code code = GW_OK;
    for (size_t s = 0; s < accuracy->scene_count && !code; s++)
        code = put_scene(page, accuracy, s, error);
    fputs("</body></html>\n", page);
    if (fclose(page) && !code)
        code = gw_fail(error, GW_MACHINE, "memory is out while writing a page");
    gw_interrupt_hold();
    if (!code)
        code = gw_file_write(path, text, size, error);
    gw_interrupt_release();
    free(text);
    free(path);
    return code;
}
