/* `gazewall bench scale`: what a wall of 1, 4, 16 and 35 panels costs, a ray for every pixel against a
 * foveated frame; and what one ray costs in scenes of more and more triangles (bench_scale_growth.c).
 *
 * Panels are 55 inches of 1920 x 1080 pixels, the viewer stands 2 m before the wall's centre and looks there,
 * as in configs/sites/35-panels.yaml. With --quick panels have an eighth of the pixels a side: the same wall,
 * coarser. */
#include "wall/bench_scale.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/bench_view.h"
#include "wall/frames.h"
#include "wall/plot.h"
#include "wall/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct { uint32_t columns, rows; } walls[] = {{1, 1}, {2, 2}, {4, 4}, {7, 5}};
enum { WALLS = sizeof walls / sizeof *walls, QUICK = 8 };

static const double panel_width = 1209.6, bezel = 1.75, eye_distance = 2000; /* mm */
static const double half_angle = 2.5, margin = 5;                            /* deg */

typedef struct tile_work {
    gw_counters full, foveated;
} tile_work;

typedef struct wall_work {
    gw_layout layout;
    tile_work tiles[GW_MAXIMUM_TILES], all;
    double share_most; /* of its own full rays, of the tile that has the most */
    uint32_t timed[2]; /* the tile that is looked at, and a corner */
    double full_ms[2], foveated_ms[2];
} wall_work;

typedef struct scale {
    gw_bench *bench;
    gw_renderer *renderer, *counting;
    uint32_t panel[2];
    int by_processor;
    uint8_t *pixels;
    wall_work walls[WALLS];
} scale;

static gw_code lay_out(const scale *s, size_t which, gw_layout *out, gw_error *error) {
    gw_grid grid = {.columns = walls[which].columns,
                    .rows = walls[which].rows,
                    .left = bezel,
                    .right = bezel,
                    .top = bezel,
                    .bottom = bezel,
                    .eye = {0, 0, eye_distance}};
    grid.pitch[0] = grid.pitch[1] = panel_width / s->panel[0];
    for (uint32_t i = 0; i < grid.columns; i++)
        grid.widths[i] = s->panel[0];
    for (uint32_t i = 0; i < grid.rows; i++)
        grid.heights[i] = s->panel[1];
    return gw_layout_grid(&grid, out, error);
}

static gw_frame_state state_of(const scale *s, const gw_layout *layout, int foveated) {
    const gw_draw_options *draw = &s->bench->draw;
    gw_settings settings = draw->settings;
    gw_frame_state state;
    settings.gaze_half_width = settings.gaze_half_height = half_angle;
    settings.gaze_margin = margin;
    gw_frame_begin(&state, 0, &settings, draw->seed, GW_DEBUG_NONE);
    gw_frame_stare(&state, layout->eye, foveated ? layout->centre : NULL, &settings);
    if (!foveated)
        state.tau = state.tau_inside = 0;
    return state;
}

static gw_code draw(const scale *s, gw_renderer *renderer, const gw_layout *layout, uint32_t tile,
                    int foveated, gw_counters *counters, gw_error *error) {
    const gw_frame_state state = state_of(s, layout, foveated);
    gw_similarity placement;
    gw_code code = gw_place_scene(s->bench->model.scene, layout->size[0], layout->size[1], layout->centre,
                                  layout->eye, &placement, error);
    return code ? code
                : gw_renderer_frame(renderer, &placement, &layout->tiles[tile].plane,
                                    &layout->tiles[tile].rectangle, &state, s->pixels, counters, error);
}

/* Distance of the middle of a tile from the middle of the wall. */
static double off_centre(const gw_layout *layout, uint32_t tile) {
    const gw_tile *t = &layout->tiles[tile];
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double middle = t->plane.corner[k] +
                        (t->rectangle.x + 0.5 * t->rectangle.width) * t->plane.step_x[k] +
                        (t->rectangle.y + 0.5 * t->rectangle.height) * t->plane.step_y[k];
        square += (middle - layout->centre[k]) * (middle - layout->centre[k]);
    }
    return sqrt(square);
}

static void choose_timed(wall_work *w) {
    for (uint32_t i = 0; i < w->layout.tile_count; i++)
        if (off_centre(&w->layout, i) < off_centre(&w->layout, w->timed[0]))
            w->timed[0] = i;
}

/* The least of some rounds in turns, after one that warms up. */
static gw_code time_tiles(const scale *s, wall_work *w, gw_error *error) {
    const uint32_t rounds = s->bench->repeats ? s->bench->repeats : s->bench->quick ? 1 : 3;
    gw_code code = GW_OK;
    for (uint32_t round = 0; round <= rounds && !code; round++)
        for (int job = 0; job < 4 && !code; job++) {
            int foveated = job & 1, which = job >> 1;
            double *least = foveated ? &w->foveated_ms[which] : &w->full_ms[which];
            int64_t begin = s->by_processor ? gw_processor_ns() : gw_now_ns();
            code = draw(s, s->renderer, &w->layout, w->timed[which], foveated, NULL, error);
            double ms = (double)((s->by_processor ? gw_processor_ns() : gw_now_ns()) - begin) * 1e-6;
            if (round > 0)
                *least = round == 1 ? ms : fmin(*least, ms);
        }
    return code;
}

static gw_code measure_wall(scale *s, size_t which, gw_error *error) {
    wall_work *w = &s->walls[which];
    gw_code code = lay_out(s, which, &w->layout, error);
    for (uint32_t i = 0; i < w->layout.tile_count && !code; i++) {
        tile_work *tile = &w->tiles[i];
        code = draw(s, s->counting, &w->layout, i, 0, &tile->full, error);
        if (!code)
            code = draw(s, s->counting, &w->layout, i, 1, &tile->foveated, error);
        gw_counters_add(&w->all.full, &tile->full);
        gw_counters_add(&w->all.foveated, &tile->foveated);
        w->share_most = fmax(w->share_most, (double)tile->foveated.rays / (double)tile->full.rays);
        gw_log_progress(&s->bench->console.log, "counting tiles", (double)(i + 1) / w->layout.tile_count);
    }
    if (code)
        return code;
    choose_timed(w);
    return time_tiles(s, w, error);
}

/* --- results --- */

static double share(uint64_t foveated, uint64_t full) {
    return full ? (double)foveated / (double)full : 0;
}

static json_t *work_json(const gw_counters *c) {
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "rays", (json_int_t)c->rays, "steps",
                     (json_int_t)c->steps, "node_loads", (json_int_t)c->node_loads, "triangle_tests",
                     (json_int_t)c->triangle_tests, "voxels", (json_int_t)c->voxels, "shadow_rays",
                     (json_int_t)c->shadow_rays);
}

static void report_walls(const scale *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < WALLS; i++) {
        const wall_work *w = &s->walls[i];
        const gw_counters *full = &w->all.full, *foveated = &w->all.foveated;
        json_t *times = json_array();
        for (int t = 0; t < 2; t++)
            json_array_append_new(times,
                                  json_pack("{s:s, s:f, s:f}", "tile", w->layout.tiles[w->timed[t]].name,
                                            "full_ms", w->full_ms[t], "foveated_ms", w->foveated_ms[t]));
        json_array_append_new(list, json_pack("{s:i, s:o, s:o, s:{s:f, s:f, s:f, s:f}, s:f, s:o}", "tiles",
                                              (int)w->layout.tile_count, "full", work_json(full), "foveated",
                                              work_json(foveated), "share", "rays",
                                              share(foveated->rays, full->rays), "steps",
                                              share(foveated->steps, full->steps), "node_loads",
                                              share(foveated->node_loads, full->node_loads), "triangle_tests",
                                              share(foveated->triangle_tests, full->triangle_tests),
                                              "most_rays_of_a_tile", w->share_most, "timed", times));
    }
    json_object_set_new(s->bench->report, "bench",
                        json_pack("{s:s, s:[i,i], s:s, s:o}", "name", "scale", "panel", (int)s->panel[0],
                                  (int)s->panel[1], "clock", s->by_processor ? "processor" : "wall", "walls",
                                  list));
}

static gw_code write_rows(const scale *s, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *csv = open_memstream(&text, &size);
    if (!csv)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("tiles,tile,full_rays,full_steps,full_node_loads,full_triangle_tests,foveated_rays,foveated_steps,"
          "foveated_node_loads,foveated_triangle_tests,foveated_voxels\n",
          csv);
    for (size_t i = 0; i < WALLS; i++)
        for (uint32_t t = 0; t < s->walls[i].layout.tile_count; t++) {
            const gw_counters *a = &s->walls[i].tiles[t].full, *b = &s->walls[i].tiles[t].foveated;
            fprintf(csv, "%" PRIu32 ",%s,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",",
                    s->walls[i].layout.tile_count, s->walls[i].layout.tiles[t].name, a->rays, a->steps,
                    a->node_loads, a->triangle_tests);
            fprintf(csv, "%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 "\n", b->rays, b->steps,
                    b->node_loads, b->triangle_tests, b->voxels);
        }
    fclose(csv);
    gw_code code = gw_bench_write(s->bench, "scale", text, size, error);
    free(text);
    return code;
}

/* Shares of the full frame over the number of tiles. */
static gw_code write_plot(const scale *s, gw_error *error) {
    double tiles[WALLS], rays[WALLS], steps[WALLS], tests[WALLS];
    for (size_t i = 0; i < WALLS; i++) {
        const tile_work *all = &s->walls[i].all;
        tiles[i] = s->walls[i].layout.tile_count;
        rays[i] = 100 * share(all->foveated.rays, all->full.rays);
        steps[i] = 100 * share(all->foveated.steps, all->full.steps);
        tests[i] = 100 * share(all->foveated.triangle_tests, all->full.triangle_tests);
    }
    const gw_plot_series series[] = {{.name = "rays", .x = tiles, .y = rays, .count = WALLS},
                                     {.name = "steps", .x = tiles, .y = steps, .count = WALLS},
                                     {.name = "triangle tests", .x = tiles, .y = tests, .count = WALLS}};
    const gw_plot plot = {.title = "Foveated frame, share of a full one",
                          .x_label = "tiles",
                          .y_label = "%",
                          .series = series,
                          .series_count = 3};
    return gw_bench_plot(s->bench, "scale-tiles", &plot, error);
}

static void print_walls(const scale *s) {
    printf("%s: panels of %" PRIu32 "x%" PRIu32
           " px (%.1f px a degree), viewer at 2 m, half-angle %g and margin %g "
           "degrees, on %s\n",
           s->bench->model.scene->path, s->panel[0], s->panel[1],
           eye_distance * tan(acos(-1) / 180) * s->panel[0] / panel_width, half_angle, margin,
           gw_gl_limits_of(s->bench->model.device)->renderer);
    printf("         full frame, million           foveated: share of       most rays    time, %s clock\n",
           s->by_processor ? "processor" : "wall");
    printf(
        "  tiles    rays    steps    tests       rays   steps   tests    of a tile    looked at  corner\n");
    for (size_t i = 0; i < WALLS; i++) {
        const wall_work *w = &s->walls[i];
        const gw_counters *full = &w->all.full, *foveated = &w->all.foveated;
        printf("  %5" PRIu32
               "  %6.1f  %7.1f  %7.1f     %5.1f%%  %5.1f%%  %5.1f%%       %5.1f%%       %5.1f%%  %5.1f%%\n",
               w->layout.tile_count, 1e-6 * (double)full->rays, 1e-6 * (double)full->steps,
               1e-6 * (double)full->triangle_tests, 100 * share(foveated->rays, full->rays),
               100 * share(foveated->steps, full->steps),
               100 * share(foveated->triangle_tests, full->triangle_tests), 100 * w->share_most,
               100 * w->foveated_ms[0] / w->full_ms[0], 100 * w->foveated_ms[1] / w->full_ms[1]);
    }
    const tile_work *all = &s->walls[WALLS - 1].all;
    if (!s->bench->quick)
        printf("  at most 4 %% of the rays on 35 panels: %s\n",
               share(all->foveated.rays, all->full.rays) <= 0.04 ? "met" : "not met");
}

static gw_code open_scale(scale *s, gw_error *error) {
    gw_bench *bench = s->bench;
    const gw_renderer_options plain = gw_bench_rendering(bench, 0), counting = gw_bench_rendering(bench, 1);
    s->panel[0] = bench->quick ? 1920 / QUICK : 1920;
    s->panel[1] = bench->quick ? 1080 / QUICK : 1080;
    s->by_processor = gw_gl_limits_of(bench->model.device)->software;
    gw_code code = gw_allocate((void **)&s->pixels, (size_t)s->panel[0] * s->panel[1], 4, "pixels", error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &plain,
                                  &s->renderer, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &counting,
                                  &s->counting, error);
    return code;
}

gw_code gw_bench_scale(gw_bench *bench, gw_error *error) {
    scale *s = NULL;
    gw_code code = gw_allocate((void **)&s, 1, sizeof *s, "results", error);
    if (code)
        return code;
    s->bench = bench;
    code = open_scale(s, error);
    for (size_t i = 0; i < WALLS && !code; i++)
        code = measure_wall(s, i, error);
    gw_renderer_destroy(&s->renderer);
    gw_renderer_destroy(&s->counting);
    if (!code) {
        report_walls(s);
        code = bench->out ? write_plot(s, error) : GW_OK;
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_walls(s);
    }
    if (!code)
        code = gw_scale_growth(bench, error);
    if (!code)
        code = write_rows(s, error);
    free(s->pixels);
    free(s);
    return code;
}
