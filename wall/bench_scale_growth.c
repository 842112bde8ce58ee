/* See bench_scale.h. */
#include "wall/bench_scale.h"

#include "base/file.h"
#include "base/memory.h"
#include "wall/bench_view.h"
#include "wall/picture.h"
#include "wall/plot.h"
#include "wall/rock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const uint32_t sizes[] = {10000, 30000, 100000, 300000, 1000000, 3000000, 10000000};
enum { SIZE_COUNT = sizeof sizes / sizeof *sizes, QUICK_COUNT = 4 };

/* Per ray that meets the picture's middle square: all of its rays meet the rock. */
enum { STEPS, LOADS, TESTS, LOD_STEPS, QUANTITIES };
static const struct {
    const char *key, *curve; /* in CSV and JSON; in the plot */
} quantities[QUANTITIES] = {{"steps", "steps"},
                            {"node_loads", "node loads"},
                            {"triangle_tests", "triangle tests"},
                            {"lod_steps", "steps, tau 1"}};

/* quantity = at 10 thousand triangles + per_doubling * log2(triangles / 10 thousand), by least squares. */
typedef struct fit {
    double start, per_doubling;
    double determination; /* R^2: the share of the variance that the line explains */
    double exponent;      /* of the power law through the first and the last point */
} fit;

typedef struct growth {
    size_t count;
    double triangles[SIZE_COUNT], values[QUANTITIES][SIZE_COUNT];
    fit fits[QUANTITIES];
} growth;

static fit fit_logarithm(const double *x, const double *y, size_t count) {
    double n = (double)count, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0, sum_yy = 0;
    for (size_t i = 0; i < count; i++) {
        double u = log2(x[i] / x[0]);
        sum_x += u;
        sum_y += y[i];
        sum_xx += u * u;
        sum_xy += u * y[i];
        sum_yy += y[i] * y[i];
    }
    double var_x = n * sum_xx - sum_x * sum_x, var_y = n * sum_yy - sum_y * sum_y,
           covariance = n * sum_xy - sum_x * sum_y;
    fit out = {.per_doubling = covariance / var_x, .determination = 1};
    out.start = (sum_y - out.per_doubling * sum_x) / n;
    if (var_y > 0)
        out.determination = covariance * covariance / (var_x * var_y);
    out.exponent = log(y[count - 1] / y[0]) / log(x[count - 1] / x[0]);
    return out;
}

/* From 3 radii away, so close that the rock covers the whole picture. */
static gw_code look(gw_bench_view *view, uint32_t side, gw_error *error) {
    const double eye[3] = {1.2, 0.9, 2.6}, centre[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    const uint32_t size[2] = {side, side};
    gw_perspective camera;
    *view = (gw_bench_view){.rectangle = {.width = side, .height = side}};
    gw_code code = gw_perspective_of(eye, centre, up, 20, size, &camera, error);
    view->placement = camera.placement;
    view->plane = camera.plane;
    for (int k = 0; k < 3; k++)
        view->eye[k] = camera.eye[k];
    return code;
}

static gw_code trace(const gw_bench *bench, gw_renderer *renderer, int lod, uint8_t *pixels, uint32_t side,
                     gw_counters *out, gw_error *error) {
    gw_bench_view view;
    gw_code code = look(&view, side, error);
    gw_frame_state state = gw_bench_state(bench, &view, 0);
    state.tau = state.tau_inside = lod ? 1 : 0;
    return code ? code
                : gw_renderer_frame(renderer, &view.placement, &view.plane, &view.rectangle, &state, pixels,
                                    out, error);
}

static gw_code measure(const gw_bench *bench, growth *g, uint8_t *pixels, uint32_t side, gw_error *error) {
    const gw_octree_options how = {.settings = &bench->draw.settings, .log = &bench->console.log};
    const gw_renderer_options counting = gw_bench_rendering(bench, 1);
    gw_scene *scene = NULL;
    gw_octree *octree = NULL;
    gw_renderer *renderer = NULL;
    gw_counters exact = {0}, lod = {0};
    gw_code code = gw_rock_scene(sizes[g->count], &scene, error);
    if (!code)
        code = gw_octree_build(bench->model.device, scene, &how, &octree, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, scene, octree, &counting, &renderer, error);
    if (!code)
        code = trace(bench, renderer, 0, pixels, side, &exact, error);
    if (!code)
        code = trace(bench, renderer, 1, pixels, side, &lod, error);
    if (!code) {
        double rays = (double)exact.rays;
        g->triangles[g->count] = scene->triangle_count;
        g->values[STEPS][g->count] = (double)exact.steps / rays;
        g->values[LOADS][g->count] = (double)exact.node_loads / rays;
        g->values[TESTS][g->count] = (double)exact.triangle_tests / rays;
        g->values[LOD_STEPS][g->count] = (double)lod.steps / rays;
        g->count++;
    }
    gw_renderer_destroy(&renderer);
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
    return code;
}

static void report(const gw_bench *bench, const growth *g) {
    json_t *points = json_array(), *fits = json_object();
    for (size_t i = 0; i < g->count; i++) {
        json_t *point = json_pack("{s:I}", "triangles", (json_int_t)g->triangles[i]);
        for (int q = 0; q < QUANTITIES; q++)
            json_object_set_new(point, quantities[q].key, json_real(g->values[q][i]));
        json_array_append_new(points, point);
    }
    for (int q = 0; q < QUANTITIES; q++)
        json_object_set_new(fits, quantities[q].key,
                            json_pack("{s:f, s:f, s:f, s:f}", "start", g->fits[q].start, "per_doubling",
                                      g->fits[q].per_doubling, "determination", g->fits[q].determination,
                                      "exponent", g->fits[q].exponent));
    json_object_set_new(json_object_get(bench->report, "bench"), "growth",
                        json_pack("{s:o, s:o}", "points", points, "fits", fits));
}

static gw_code write_rows(const gw_bench *bench, const growth *g, gw_error *error) {
    char *text = NULL, *path = gw_picture_path(bench->out, "scale-growth.csv");
    size_t size = 0;
    FILE *csv = path ? open_memstream(&text, &size) : NULL;
    if (!csv) {
        free(path);
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    }
    fputs("triangles", csv);
    for (int q = 0; q < QUANTITIES; q++)
        fprintf(csv, ",%s", quantities[q].key);
    for (size_t i = 0; i < g->count; i++) {
        fprintf(csv, "\n%.0f", g->triangles[i]);
        for (int q = 0; q < QUANTITIES; q++)
            fprintf(csv, ",%.3f", g->values[q][i]);
    }
    fputc('\n', csv);
    fclose(csv);
    gw_code code = gw_file_write(path, text, size, error);
    free(text);
    free(path);
    return code;
}

/* The quantities, and the line through the steps. */
static gw_code write_plot(const gw_bench *bench, const growth *g, gw_error *error) {
    double line[SIZE_COUNT];
    gw_plot_series series[QUANTITIES + 1];
    for (size_t i = 0; i < g->count; i++)
        line[i] =
            g->fits[STEPS].start + g->fits[STEPS].per_doubling * log2(g->triangles[i] / g->triangles[0]);
    for (int q = 0; q < QUANTITIES; q++)
        series[q] = (gw_plot_series){
            .name = quantities[q].curve, .x = g->triangles, .y = g->values[q], .count = g->count};
    series[QUANTITIES] =
        (gw_plot_series){.name = "logarithm", .x = g->triangles, .y = line, .count = g->count, .dashed = 1};
    const gw_plot plot = {.title = "Work of one ray to a rock",
                          .x_label = "triangles",
                          .y_label = "per ray",
                          .series = series,
                          .series_count = QUANTITIES + 1};
    return gw_bench_plot(bench, "scale-growth", &plot, error);
}

static void print_summary(const growth *g) {
    printf("work of one ray to a rock, same picture:\n%12s %8s %11s %15s %13s\n", "triangles", "steps",
           "node loads", "triangle tests", "steps, tau 1");
    for (size_t i = 0; i < g->count; i++)
        printf("%12.0f %8.2f %11.2f %15.2f %13.2f\n", g->triangles[i], g->values[STEPS][i],
               g->values[LOADS][i], g->values[TESTS][i], g->values[LOD_STEPS][i]);
    for (int q = 0; q < QUANTITIES; q++)
        printf("  %s: %.2f + %.2f for each doubling (R2 %.3f); as a power of the triangles: %.3f\n",
               quantities[q].curve, g->fits[q].start, g->fits[q].per_doubling, g->fits[q].determination,
               g->fits[q].exponent);
}

gw_code gw_scale_growth(gw_bench *bench, gw_error *error) {
    growth g = {.count = 0};
    const uint32_t side = bench->quick ? 96 : 512;
    const size_t wanted = bench->quick ? QUICK_COUNT : SIZE_COUNT;
    uint8_t *pixels = NULL;
    gw_code code = gw_allocate((void **)&pixels, (size_t)side * side, 4, "pixels", error);
    while (!code && g.count < wanted) {
        code = measure(bench, &g, pixels, side, error);
        gw_log_progress(&bench->console.log, "growing the scene", (double)g.count / (double)wanted);
    }
    free(pixels);
    if (code)
        return code;
    for (int q = 0; q < QUANTITIES; q++)
        g.fits[q] = fit_logarithm(g.triangles, g.values[q], g.count);
    report(bench, &g);
    if (bench->out)
        code = write_rows(bench, &g, error);
    if (!code && bench->out)
        code = write_plot(bench, &g, error);
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(&g);
    }
    return code;
}
