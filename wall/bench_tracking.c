/* `gazewall bench tracking`: how late and how steady each filter is, on people who do not exist
 * (tracking/generator_motion.h) whose true paths are known, through the whole tracker; and what a sample
 * costs. */
#include "wall/bench_tracking.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/bench.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SETTLED = 0.5; /* s that a filter has to begin with */

const char *const gw_tracking_head_figures[GW_TRACKING_FIGURES] = {
    "lag_ms", "told_ms", "jitter_mm", "error_mm", "predicted_error_mm", "predicted_jitter_mm", NULL};

const char *const gw_tracking_head_filters[GW_TRACKING_HEAD_FILTERS] = {
    "head_filter=none",
    "head_filter=one-euro",
    "head_filter=one-euro head_cutoff=1 head_cutoff_growth=10",
    "head_filter=one-euro head_cutoff=1 head_cutoff_growth=0",
    "head_filter=kalman",
    "head_filter=kalman head_noise=1 head_acceleration=1",
};

/* --- paths */

void gw_tracking_path_at(const gw_tracking_path *path, double time, double out[3]) {
    const double last = path->seconds * GW_TRACKING_GRID - 1;
    const double at = fmin(fmax(time * GW_TRACKING_GRID, 0), last);
    const size_t i = (size_t)fmin(at, last - 1);
    for (int k = 0; k < 3; k++)
        out[k] = path->at[i][k] + (path->at[i + 1][k] - path->at[i][k]) * (at - (double)i);
}

static double square_difference(const gw_tracking_path *path, double shift, const double *times,
                                double (*seen)[3], size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double truth[3];
        gw_tracking_path_at(path, times[i] - shift, truth);
        for (int k = 0; k < 3; k++)
            sum += (seen[i][k] - truth[k]) * (seen[i][k] - truth[k]);
    }
    return sum;
}

double gw_tracking_lag(const gw_tracking_path *path, const double *times, double (*seen)[3], size_t count) {
    double best = 0, from = -0.1, to = 0.3;
    for (double step = 0.01; step > 0.0001; step *= 0.2) {
        double least = INFINITY;
        for (double shift = from; shift <= to + 1e-9; shift += step) {
            const double sum = square_difference(path, shift, times, seen, count);
            if (sum < least) {
                least = sum;
                best = shift;
            }
        }
        from = best - step;
        to = best + step;
    }
    return best;
}

/* Where the head of a person who walks is, mm; 0 when memory is out. Without a person: at rest. */
static gw_code make_path(const gw_person *person, double seconds, gw_tracking_path *out, gw_error *error) {
    const size_t count = (size_t)(seconds * GW_TRACKING_GRID);
    out->seconds = seconds;
    gw_code code = gw_allocate((void **)&out->at, count, sizeof *out->at, "a path", error);
    for (size_t i = 0; i < count && !code; i++) {
        double turn[4], place[3] = {0.1, 0.05, 1.8};
        if (person)
            gw_person_head(person, (double)i / GW_TRACKING_GRID, place, turn);
        for (int k = 0; k < 3; k++)
            out->at[i][k] = 1000 * place[k];
    }
    return code;
}

/* --- heads */

gw_code gw_bench_tracker(const char *settings, const gw_tracker_setup *setup, gw_tracker **out,
                         gw_error *error) {
    gw_settings all;
    gw_tracker_setup plain;
    char text[256], *rest = text;
    gw_settings_init(&all);
    snprintf(text, sizeof text, "%s", settings);
    for (char *word; (word = strtok_r(rest, " ", &rest));) {
        gw_code code = gw_settings_assign(&all, word, error);
        if (code)
            return code;
    }
    gw_tracker_setup_default("bench", &plain);
    const gw_tracker_options options = {.settings = &all, .neutral_eye = {0, 0, 1800}, .adopt_first = 1};
    return gw_tracker_create(setup ? setup : &plain, &options, out, error);
}

/* What is seen of a path: after each sample, `lead` s before the frame is seen. */
typedef struct watched {
    size_t count;
    double *times;     /* s, of the frames' states */
    double (*eyes)[3]; /* mm */
    double told;       /* s, mean of what the filter says it is late */
} watched;

static gw_code watch(const gw_tracking_path *path, const char *settings, double rate, double noise,
                     double lead, watched *out, gw_error *error) {
    gw_random random = {42};
    gw_tracker *tracker = NULL;
    gw_tracker_view view;
    const size_t count = (size_t)(path->seconds * rate);
    gw_code code = gw_bench_tracker(settings, NULL, &tracker, error);
    memset(out, 0, sizeof *out);
    if (!code)
        code = gw_allocate((void **)&out->times, count, sizeof *out->times, "times", error);
    if (!code)
        code = gw_allocate((void **)&out->eyes, count, sizeof *out->eyes, "eyes", error);
    for (size_t i = 0; i < count && !code; i++) {
        const double time = (double)i / rate;
        gw_tracking_event event = {.kind = GW_EVENT_POSE, .quality = 1, .device_time = GW_NO_TIME};
        gw_tracking_path_at(path, time, event.of.pose.position);
        for (int k = 0; k < 3; k++)
            event.of.pose.position[k] =
                1e-3 * (event.of.pose.position[k] + noise * gw_random_normal(&random));
        event.of.pose.orientation[3] = 1;
        event.arrival = llrint(time * 1e9);
        gw_tracker_take(tracker, 0, &event);
        gw_tracker_at(tracker, event.arrival, event.arrival + llrint(lead * 1e9), &view);
        if (time < SETTLED || time > path->seconds - SETTLED)
            continue;
        out->times[out->count] = time;
        memcpy(out->eyes[out->count++], view.viewers[0].eye, sizeof *out->eyes);
        out->told += 1e-9 * (double)view.viewers[0].head_delay;
    }
    out->told /= out->count ? (double)out->count : 1;
    gw_tracker_destroy(&tracker);
    return code;
}

static void finish_watched(watched *w) {
    free(w->times);
    free(w->eyes);
}

/* Root mean square distance of what is seen from the path as it is `ahead` s later. */
static double error_of(const gw_tracking_path *path, const watched *w, double ahead) {
    const double sum = square_difference(path, -ahead, w->times, w->eyes, w->count);
    return sqrt(sum / (double)(w->count ? w->count : 1));
}

static gw_code measure_head(const gw_tracking_path *walk, const gw_tracking_path *rest, gw_tracking_row *row,
                            gw_error *error) {
    char still[128];
    snprintf(still, sizeof still, "%s prediction=off", row->filter);
    watched w[4] = {{0}, {0}, {0}, {0}};
    const gw_tracking_path *paths[4] = {walk, rest, walk, rest};
    gw_code code = GW_OK;
    for (int i = 0; i < 4 && !code; i++)
        code = watch(paths[i], i < 2 ? still : row->filter, row->rate, row->noise,
                     i < 2 ? 0 : GW_TRACKING_LEAD, &w[i], error);
    if (!code) {
        row->figures[0] = 1e3 * gw_tracking_lag(walk, w[0].times, w[0].eyes, w[0].count);
        row->figures[1] = 1e3 * w[0].told;
        row->figures[2] = error_of(rest, &w[1], 0);
        row->figures[3] = error_of(walk, &w[0], GW_TRACKING_LEAD);
        row->figures[4] = error_of(walk, &w[2], GW_TRACKING_LEAD);
        row->figures[5] = error_of(rest, &w[3], 0);
    }
    for (int i = 0; i < 4; i++)
        finish_watched(&w[i]);
    return code;
}

static gw_code measure_heads(double seconds, gw_tracking_row *rows, uint32_t *count, gw_error *error) {
    static const double rates[] = {60, 240}, noises[] = {0.1, 1};
    const gw_person_habits walking = {.place = {0, 0.05, 1.8},
                                      .walks = 1,
                                      .sway = 1,
                                      .fixation = {0.25, 1.1},
                                      .amplitude = {1, 15},
                                      .blink_every = {2, 6}};
    gw_tracking_path walk = {0}, rest = {0};
    gw_person person;
    if (!gw_person_init(&person, &walking, 2, seconds))
        return gw_fail(error, GW_MACHINE, "memory is out while making a person");
    gw_code code = make_path(&person, seconds, &walk, error);
    if (!code)
        code = make_path(NULL, seconds, &rest, error);
    for (size_t n = 0; n < 2; n++)
        for (size_t r = 0; r < 2; r++)
            for (size_t f = 0; f < GW_TRACKING_HEAD_FILTERS && !code; f++) {
                gw_tracking_row *row = &rows[(*count)++];
                *row = (gw_tracking_row){.table = "head", .rate = rates[r], .noise = noises[n]};
                snprintf(row->filter, sizeof row->filter, "%s", gw_tracking_head_filters[f]);
                code = measure_head(&walk, &rest, row, error);
            }
    gw_person_finish(&person);
    free(walk.at);
    free(rest.at);
    return code;
}

/* --- what a sample costs */

/* ns of processor for one head and for one gaze sample with every filter on, the view of a frame each ten. */
static gw_code measure_cost(const gw_bench *bench, double cost[3], gw_error *error) {
    const uint32_t samples = bench->quick ? 20000 : 200000;
    gw_tracker *tracker = NULL;
    gw_tracker_view view;
    gw_code code = gw_bench_tracker("head_filter=kalman gaze_filter=one-euro", NULL, &tracker, error);
    for (int part = 0; part < 3 && !code; part++) {
        const int64_t begin = gw_processor_ns();
        for (uint32_t i = 0; i < samples; i++) {
            const double angle = 0.001 * i;
            gw_tracking_event event = {.kind = GW_EVENT_POSE,
                                       .sensor = part,
                                       .arrival = (int64_t)(part * (int64_t)samples + i) * 1000000,
                                       .device_time = (int64_t)i * 1000000,
                                       .quality = 1};
            event.of.pose.position[0] = 1e-4 * (i % 1000);
            event.of.pose.orientation[1] = angle / (1 + angle);
            event.of.pose.orientation[3] = 1;
            if (part < 2)
                gw_tracker_take(tracker, 0, &event);
            else
                gw_tracker_at(tracker, event.arrival, event.arrival + 50000000, &view);
        }
        cost[part] = (double)(gw_processor_ns() - begin) / samples;
    }
    gw_tracker_destroy(&tracker);
    return code;
}

/* --- output */

static const char *const *figures_of(const gw_tracking_row *row) {
    return strcmp(row->table, "head") ? gw_tracking_gaze_figures : gw_tracking_head_figures;
}

static void print_rows(const gw_tracking_row *rows, uint32_t count, const double cost[3]) {
    printf("how late and how steady the tracker is; figures at presentation are for %g ms ahead\n",
           1e3 * GW_TRACKING_LEAD);
    for (uint32_t i = 0; i < count; i++) {
        const char *const *names = figures_of(&rows[i]);
        const int first = i == 0 || strcmp(rows[i].table, rows[i - 1].table) != 0 ||
                          strcmp(rows[i].track, rows[i - 1].track) != 0;
        if (first || rows[i].rate != rows[i - 1].rate || rows[i].noise != rows[i - 1].noise) {
            printf("%s, %s%s%g Hz, noise %g %s\n  %-62s", rows[i].table, rows[i].track,
                   rows[i].track[0] ? ", " : "", rows[i].rate, rows[i].noise,
                   names == gw_tracking_head_figures ? "mm" : "degrees", "");
            for (int k = 0; k < GW_TRACKING_FIGURES && names[k]; k++)
                printf(" %s", names[k]);
            putchar('\n');
        }
        printf("  %-62s", rows[i].filter);
        for (int k = 0; k < GW_TRACKING_FIGURES && names[k]; k++)
            printf(" %*.2f", (int)strlen(names[k]), rows[i].figures[k]);
        putchar('\n');
    }
    printf("cost         head sample %.2f, gaze sample %.2f, a frame's view %.2f us of processor\n",
           1e-3 * cost[0], 1e-3 * cost[1], 1e-3 * cost[2]);
}

static void report_rows(gw_bench *bench, const gw_tracking_row *rows, uint32_t count, const double cost[3]) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; i++) {
        json_t *object =
            json_pack("{s:s, s:s, s:s, s:f, s:f}", "table", rows[i].table, "track", rows[i].track, "filter",
                      rows[i].filter, "rate_hz", rows[i].rate, "noise", rows[i].noise);
        for (int k = 0; k < GW_TRACKING_FIGURES && figures_of(&rows[i])[k]; k++)
            json_object_set_new(object, figures_of(&rows[i])[k], json_real(rows[i].figures[k]));
        json_array_append_new(list, object);
    }
    json_object_set_new(bench->report, "bench",
                        json_pack("{s:s, s:f, s:o, s:{s:f, s:f, s:f}}", "name", "tracking", "lead_ms",
                                  1e3 * GW_TRACKING_LEAD, "rows", list, "cost_us", "head_sample",
                                  1e-3 * cost[0], "gaze_sample", 1e-3 * cost[1], "view", 1e-3 * cost[2]));
}

static gw_code write_rows(const gw_bench *bench, const gw_tracking_row *rows, uint32_t count,
                          gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("table,track,filter,rate_hz,noise,figure,value\n", stream);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < GW_TRACKING_FIGURES && figures_of(&rows[i])[k]; k++)
            fprintf(stream, "%s,%s,%s,%g,%g,%s,%.6g\n", rows[i].table, rows[i].track, rows[i].filter,
                    rows[i].rate, rows[i].noise, figures_of(&rows[i])[k], rows[i].figures[k]);
    fclose(stream);
    gw_code code = gw_bench_write(bench, "tracking", text, size, error);
    free(text);
    return code;
}

gw_code gw_bench_tracking(gw_bench *bench, gw_error *error) {
    static gw_tracking_row rows[GW_TRACKING_ROWS];
    const double seconds = bench->quick ? 4 : 20;
    uint32_t count = 0;
    double cost[3] = {0, 0, 0};
    gw_code code = measure_heads(seconds, rows, &count, error);
    if (!code)
        code = gw_bench_tracking_gaze(seconds, rows, &count, error);
    if (!code)
        code = gw_bench_tracking_shipped(rows, &count, error);
    if (!code)
        code = measure_cost(bench, cost, error);
    if (code)
        return code;
    report_rows(bench, rows, count, cost);
    code = write_rows(bench, rows, count, error);
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_rows(rows, count, cost);
    }
    return code;
}
