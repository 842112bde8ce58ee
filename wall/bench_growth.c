/* `gazewall bench growth`: how the octree's build and bytes grow with the number of triangles, on a rock made
 * by formula from 10 thousand to 10 million of them. */
#include "wall/bench.h"

#include "wall/report.h"
#include "wall/rock.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const uint32_t sizes[] = {10000, 30000, 100000, 300000, 1000000, 3000000, 10000000};
enum { SIZE_COUNT = sizeof sizes / sizeof *sizes, QUICK_COUNT = 4 };

/* What grows; the first three are deterministic. */
enum { OVERLAP_TESTS, NODES, BYTES, TOTAL_MS, REFINE_MS, PAYLOAD_MS, QUANTITIES };
static const struct {
    const char *key, *curve; /* in CSV and JSON; in the plots */
} quantities[QUANTITIES] = {{"overlap_tests", "overlap tests"},
                            {"nodes", "nodes"},
                            {"bytes", "all bytes"},
                            {"total_ms", "whole build"},
                            {"refinement_ms", "refinement"},
                            {"payload_ms", "payload"}};

typedef struct growth {
    size_t count;
    double triangles[SIZE_COUNT], quantities[QUANTITIES][SIZE_COUNT];
    double exponents[QUANTITIES]; /* fitted: quantity ~ triangles^exponent */
} growth;

/* Slope of the line of least squares through the logarithms. */
static double fit_exponent(const double *x, const double *y, size_t count) {
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0, n = (double)count;
    for (size_t i = 0; i < count; i++) {
        double u = log(x[i]), v = log(fmax(y[i], 1e-9));
        sum_x += u;
        sum_y += v;
        sum_xx += u * u;
        sum_xy += u * v;
    }
    double spread = n * sum_xx - sum_x * sum_x;
    return spread > 0 ? (n * sum_xy - sum_x * sum_y) / spread : 0;
}

static gw_code measure(gw_bench *bench, growth *g, gw_error *error) {
    size_t i = g->count;
    gw_scene *scene = NULL;
    gw_built built;
    /* Small builds are over in the time of a hiccup: the fastest of three. */
    uint32_t repeats = bench->repeats ? bench->repeats : sizes[i] <= 300000 && !bench->quick ? 3 : 1;
    gw_code code = gw_rock_scene(sizes[i], &scene, error);
    if (code == GW_OK)
        code = gw_bench_measure(bench, scene, &bench->draw.settings, repeats, &built, error);
    gw_scene_destroy(&scene);
    if (code != GW_OK)
        return code;
    const double *ms = built.statistics.milliseconds;
    const double values[QUANTITIES] = {
        (double)built.statistics.overlap_tests,
        (double)(built.statistics.inner + built.statistics.leaves),
        (double)(built.node_bytes + built.reference_bytes + built.payload_bytes),
        built.total_ms,
        ms[0],
        ms[1] + ms[2]};
    g->triangles[i] = built.triangles;
    for (int q = 0; q < QUANTITIES; q++)
        g->quantities[q][i] = values[q];
    g->count++;
    gw_log_progress(&bench->console.log, "growing the scene",
                    (double)(i + 1) / (bench->quick ? QUICK_COUNT : SIZE_COUNT));
    return GW_OK;
}

/* Curves of quantities first..last-1 divided by `unit`, and a straight line through the first point of the
 * first, as FOLDER/NAME.svg. */
static gw_code write_plot(const gw_bench *bench, const growth *g, const char *name, const char *y_label,
                          int first, int last, double unit, gw_error *error) {
    double scaled[QUANTITIES][SIZE_COUNT], straight[SIZE_COUNT];
    gw_plot_series series[QUANTITIES + 1];
    size_t at = 0;
    for (int q = first; q < last; q++, at++) {
        for (size_t i = 0; i < g->count; i++)
            scaled[at][i] = g->quantities[q][i] / unit;
        series[at] = (gw_plot_series){
            .name = quantities[q].curve, .x = g->triangles, .y = scaled[at], .count = g->count};
    }
    for (size_t i = 0; i < g->count; i++)
        straight[i] = scaled[0][0] * g->triangles[i] / g->triangles[0];
    series[at++] = (gw_plot_series){
        .name = "in proportion", .x = g->triangles, .y = straight, .count = g->count, .dashed = 1};
    const gw_plot plot = {.title = "Octree build of a rock",
                          .x_label = "triangles",
                          .y_label = y_label,
                          .series = series,
                          .series_count = at};
    return gw_bench_plot(bench, name, &plot, error);
}

static gw_code write_results(gw_bench *bench, const growth *g, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *csv = open_memstream(&text, &size);
    if (!csv)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("triangles", csv);
    for (int q = 0; q < QUANTITIES; q++)
        fprintf(csv, ",%s", quantities[q].key);
    for (size_t i = 0; i < g->count; i++) {
        fprintf(csv, "\n%.0f", g->triangles[i]);
        for (int q = 0; q < QUANTITIES; q++)
            fprintf(csv, q < TOTAL_MS ? ",%.0f" : ",%.3f", g->quantities[q][i]);
    }
    fputc('\n', csv);
    fclose(csv);
    gw_code code = gw_bench_write(bench, "growth", text, size, error);
    free(text);
    if (code == GW_OK && bench->out)
        code = write_plot(bench, g, "growth-time", "seconds", TOTAL_MS, QUANTITIES, 1000, error);
    if (code == GW_OK && bench->out)
        code = write_plot(bench, g, "growth-bytes", "MB", BYTES, TOTAL_MS, 1e6, error);
    return code;
}

static void report(gw_bench *bench, growth *g) {
    json_t *exponents = json_object(), *points = json_array();
    for (int q = 0; q < QUANTITIES; q++) {
        g->exponents[q] = fit_exponent(g->triangles, g->quantities[q], g->count);
        json_object_set_new(exponents, quantities[q].key, json_real(g->exponents[q]));
    }
    for (size_t i = 0; i < g->count; i++) {
        json_t *point = json_pack("{s:I}", "triangles", (json_int_t)g->triangles[i]);
        for (int q = 0; q < QUANTITIES; q++)
            json_object_set_new(point, quantities[q].key, json_real(g->quantities[q][i]));
        json_array_append_new(points, point);
    }
    json_object_set_new(
        bench->report, "bench",
        json_pack("{s:s, s:o, s:o}", "name", "growth", "exponents", exponents, "points", points));
}

static void print_summary(const growth *g) {
    printf("%12s %14s %10s %12s %14s %10s\n", "triangles", "nodes/triangle", "tests/tri", "bytes/tri",
           "s/M triangles", "s");
    for (size_t i = 0; i < g->count; i++) {
        double t = g->triangles[i];
        printf("%12.0f %14.2f %10.1f %12.1f %14.2f %10.2f\n", t, g->quantities[NODES][i] / t,
               g->quantities[OVERLAP_TESTS][i] / t, g->quantities[BYTES][i] / t,
               g->quantities[TOTAL_MS][i] * 1e3 / t, g->quantities[TOTAL_MS][i] * 1e-3);
    }
    printf("fitted exponents (1: in proportion to the triangles): time %.3f, overlap tests %.3f, nodes %.3f, "
           "bytes %.3f\n",
           g->exponents[TOTAL_MS], g->exponents[OVERLAP_TESTS], g->exponents[NODES], g->exponents[BYTES]);
}

gw_code gw_bench_growth(gw_bench *bench, gw_error *error) {
    growth g = {.count = 0};
    size_t wanted = bench->quick ? QUICK_COUNT : SIZE_COUNT;
    gw_code code = GW_OK;
    while (g.count < wanted && code == GW_OK)
        code = measure(bench, &g, error);
    if (code == GW_OK) {
        report(bench, &g);
        code = write_results(bench, &g, error);
    }
    if (code == GW_OK && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(&g);
    }
    return code;
}
