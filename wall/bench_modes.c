/* `gazewall bench modes`: one view drawn in the modes of Table 3 of Weier et al. 2014 - triangles only,
 * voxels only, hybrid, foveated - in turns: rays, work, time, and how much of the difference to a picture of
 * full quality a viewer who looks at the wall's centre can tell. */
#include "wall/bench.h"

#include "base/clock.h"
#include "base/memory.h"
#include "render/acuity_filter.h"
#include "render/flip.h"
#include "render/frame_block.h"
#include "wall/frames.h"
#include "wall/report.h"
#include "wall/sim_options.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { REFERENCE_SAMPLES = 4 /* log2 */, MOST_REPEATS = 1000 };

typedef enum mode {
    MODE_EXACT,
    MODE_TRIANGLES,
    MODE_VOXELS,
    MODE_HYBRID,
    MODE_FULL_RATE,
    MODE_FOVEATED,
    MODE_COUNT
} mode;

static const struct {
    const char *name, *what;
} modes[MODE_COUNT] = {{"exact", "triangles at every pixel, tau 0: what the others are timed against"},
                       {"triangles", "geometry=triangles: textures by footprint, no voxels"},
                       {"voxels", "geometry=voxels: the finest voxels only"},
                       {"hybrid", "triangles or voxels by footprint everywhere, no gaze"},
                       {"gazed", "exact inside the gaze ellipsoid, voxels outside, a ray for every pixel"},
                       {"foveated", "the same with fewer rays where nobody resolves more"}};

typedef struct outcome {
    gw_counters counters;
    double ms[MOST_REPEATS], ratio[MOST_REPEATS]; /* to the exact one of the same round */
    gw_spread time, against;
    double flip;      /* mean, as a foveal viewer would see it everywhere */
    double seen_flip; /* mean, behind the acuity filter of the gaze */
} outcome;

typedef struct bench_modes {
    gw_bench *bench;
    gw_renderer *renderer, *counting;
    gw_layout layout;
    gw_similarity placement;
    gw_rectangle rectangle;
    double pixels_per_degree; /* at the wall's centre */
    uint32_t repeats;
    int by_processor; /* 1: times are the process's: software GL runs there, and so may others */
    gw_image reference, seen_reference, picture;
    outcome *outcomes; /* [MODE_COUNT] */
} bench_modes;

static gw_frame_state state_of(const bench_modes *m, mode which) {
    const gw_draw_options *draw = &m->bench->draw;
    gw_frame_state state;
    int gazed = which == MODE_FULL_RATE || which == MODE_FOVEATED;
    gw_frame_begin(&state, 0, &draw->settings, draw->seed, GW_DEBUG_NONE);
    gw_frame_stare(&state, m->layout.eye, gazed ? m->layout.centre : NULL, &draw->settings);
    switch (which) {
    case MODE_EXACT:
        state.tau = state.tau_inside = 0;
        break;
    case MODE_TRIANGLES:
        state.geometry = GW_GEOMETRY_TRIANGLES;
        break;
    case MODE_VOXELS:
        state.geometry = GW_GEOMETRY_VOXELS;
        break;
    case MODE_HYBRID:
        state.tau_inside = state.tau;
        break;
    case MODE_FULL_RATE:
        state.sample_block = 0;
        break;
    default:
        break;
    }
    return state;
}

static gw_code draw(const bench_modes *m, gw_renderer *renderer, const gw_frame_state *state, gw_image *out,
                    gw_counters *counters, gw_error *error) {
    return gw_renderer_frame(renderer, &m->placement, &m->layout.tiles[0].plane, &m->rectangle, state,
                             out->rgba, counters, error);
}

/* The picture as the viewer of the foveated mode sees it; release it. */
static gw_code filter(const bench_modes *m, const gw_image *picture, gw_image *out, gw_error *error) {
    gw_frame_block block;
    const gw_frame_state state = state_of(m, MODE_FOVEATED);
    gw_code code = gw_frame_block_fill(m->bench->model.scene, m->bench->model.octree, &m->placement,
                                       &m->layout.tiles[0].plane, &state, &block, NULL, error);
    return code ? code : gw_acuity_filter(picture, &block, out, error);
}

static gw_code compare(bench_modes *m, outcome *o, gw_error *error) {
    gw_image seen = {0};
    gw_code code = gw_flip(&m->reference, &m->picture, m->pixels_per_degree, NULL, &o->flip, error);
    if (!code)
        code = filter(m, &m->picture, &seen, error);
    if (!code)
        code = gw_flip(&m->seen_reference, &seen, m->pixels_per_degree, NULL, &o->seen_flip, error);
    gw_image_finish(&seen);
    return code;
}

/* Work and error of every mode, once. */
static gw_code inspect_modes(bench_modes *m, gw_error *error) {
    gw_frame_state full = state_of(m, MODE_EXACT);
    full.samples = REFERENCE_SAMPLES;
    gw_code code = draw(m, m->renderer, &full, &m->reference, NULL, error);
    if (!code)
        code = filter(m, &m->reference, &m->seen_reference, error);
    for (int i = 0; i < MODE_COUNT && !code; i++) {
        const gw_frame_state state = state_of(m, (mode)i);
        code = draw(m, m->counting, &state, &m->picture, &m->outcomes[i].counters, error);
        if (!code)
            code = compare(m, &m->outcomes[i], error);
        gw_log_progress(&m->bench->console.log, "counting and comparing", (double)(i + 1) / MODE_COUNT);
    }
    return code;
}

/* Round 0 warms up; modes take turns, so that what else the machine does hits all alike. */
static gw_code time_modes(bench_modes *m, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t round = 0; round <= m->repeats && !code; round++)
        for (int i = 0; i < MODE_COUNT && !code; i++) {
            outcome *o = &m->outcomes[i];
            const gw_frame_state state = state_of(m, (mode)i);
            int64_t begin = m->by_processor ? gw_processor_ns() : gw_now_ns();
            code = draw(m, m->renderer, &state, &m->picture, NULL, error);
            int64_t end = m->by_processor ? gw_processor_ns() : gw_now_ns();
            if (round == 0)
                continue;
            o->ms[round - 1] = (double)(end - begin) * 1e-6;
            o->ratio[round - 1] = o->ms[round - 1] / m->outcomes[MODE_EXACT].ms[round - 1];
            gw_log_progress(&m->bench->console.log, "drawing in turns",
                            (double)(round * MODE_COUNT + (uint32_t)i + 1) / ((m->repeats + 1) * MODE_COUNT));
        }
    for (int i = 0; i < MODE_COUNT; i++) {
        m->outcomes[i].time = gw_spread_of(m->outcomes[i].ms, m->repeats);
        m->outcomes[i].against = gw_spread_of(m->outcomes[i].ratio, m->repeats);
    }
    return code;
}

static gw_code open_modes(bench_modes *m, gw_error *error) {
    gw_bench *bench = m->bench;
    gw_wall_options wall;
    gw_renderer_options counting = {.count = 1, .log = &bench->console.log};
    m->repeats = bench->repeats ? bench->repeats : bench->quick ? 2 : 7;
    m->by_processor = gw_gl_limits_of(bench->model.device)->software;
    m->rectangle.width = bench->size[0] ? bench->size[0] : bench->quick ? 160 : 1024;
    m->rectangle.height = bench->size[0] ? bench->size[1] : bench->quick ? 90 : 576;
    gw_wall_options_init(&wall, 1, 1);
    wall.size[0] = m->rectangle.width;
    wall.size[1] = m->rectangle.height;
    gw_code code = gw_wall_layout(&wall, &m->layout, error);
    if (!code)
        code = gw_place_scene(bench->model.scene, m->layout.size[0], m->layout.size[1], m->layout.centre,
                              m->layout.eye, &m->placement, error);
    double distance = 0;
    for (int k = 0; k < 3; k++)
        distance += (m->layout.centre[k] - m->layout.eye[k]) * (m->layout.centre[k] - m->layout.eye[k]);
    double millimetres = m->layout.size[0] / m->rectangle.width;
    m->pixels_per_degree = fmax(sqrt(distance) * tan(acos(-1) / 180) / millimetres, 1);
    if (!code)
        code = gw_allocate((void **)&m->outcomes, MODE_COUNT, sizeof *m->outcomes, "results", error);
    if (!code)
        code = gw_image_create(m->rectangle.width, m->rectangle.height, &m->reference, error);
    if (!code)
        code = gw_image_create(m->rectangle.width, m->rectangle.height, &m->picture, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, NULL,
                                  &m->renderer, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &counting,
                                  &m->counting, error);
    return code;
}

static double per_pixel(const bench_modes *m, uint64_t count) {
    return (double)count / ((double)m->rectangle.width * m->rectangle.height);
}

static void report_modes(const bench_modes *m) {
    json_t *entries = json_array();
    for (int i = 0; i < MODE_COUNT; i++) {
        const outcome *o = &m->outcomes[i];
        json_array_append_new(
            entries,
            json_pack("{s:s, s:s, s:{s:I, s:I, s:I, s:I, s:I}, s:{s:f, s:f, s:f}, s:{s:f, s:f, s:f}, s:f, "
                      "s:f}",
                      "name", modes[i].name, "what", modes[i].what, "counters", "rays",
                      (json_int_t)o->counters.rays, "steps", (json_int_t)o->counters.steps, "node_loads",
                      (json_int_t)o->counters.node_loads, "triangle_tests",
                      (json_int_t)o->counters.triangle_tests, "voxels", (json_int_t)o->counters.voxels, "ms",
                      "median", o->time.median, "min", o->time.minimum, "max", o->time.maximum, "ratio",
                      "median", o->against.median, "min", o->against.minimum, "max", o->against.maximum,
                      "flip", o->flip, "seen_flip", o->seen_flip));
    }
    json_object_set_new(m->bench->report, "bench",
                        json_pack("{s:s, s:i, s:s, s:[i,i], s:f, s:o}", "name", "modes", "repeats",
                                  (int)m->repeats, "clock", m->by_processor ? "processor" : "wall", "size",
                                  (int)m->rectangle.width, (int)m->rectangle.height, "pixels_per_degree",
                                  m->pixels_per_degree, "modes", entries));
}

static gw_code write_rows(const bench_modes *m, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("mode,rays,steps,node_loads,triangle_tests,voxels,median_ms,min_ms,max_ms,median_ratio,flip,seen_"
          "flip\n",
          stream);
    for (int i = 0; i < MODE_COUNT; i++) {
        const outcome *o = &m->outcomes[i];
        fprintf(stream, "%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f,%.4f,%.5f,%.5f\n", modes[i].name,
                per_pixel(m, o->counters.rays), per_pixel(m, o->counters.steps),
                per_pixel(m, o->counters.node_loads), per_pixel(m, o->counters.triangle_tests),
                per_pixel(m, o->counters.voxels), o->time.median, o->time.minimum, o->time.maximum,
                o->against.median, o->flip, o->seen_flip);
    }
    fclose(stream);
    gw_code code = gw_bench_write(m->bench, "modes", text, size, error);
    free(text);
    return code;
}

static void print_summary(const bench_modes *m) {
    const gw_scene *scene = m->bench->model.scene;
    printf("%s: %" PRIu32 " triangles, depth %" PRIu32 ", %" PRIu32 "x%" PRIu32
           " px, %.1f px a degree, %" PRIu32 " rounds in turns on %s\n",
           scene->path, scene->triangle_count, m->bench->model.octree->depth, m->rectangle.width,
           m->rectangle.height, m->pixels_per_degree, m->repeats,
           gw_gl_limits_of(m->bench->model.device)->renderer);
    printf("  times by the %s clock; errors: FLIP to 16 exact rays a pixel, plain and behind the acuity of a "
           "viewer who looks at the centre\n",
           m->by_processor ? "processor" : "wall");
    printf("              per pixel                          median\n");
    printf("  mode         rays  steps  tests  voxels      ms   ratio (from to)         FLIP    seen\n");
    for (int i = 0; i < MODE_COUNT; i++) {
        const outcome *o = &m->outcomes[i];
        printf("  %-10s %6.3f %6.1f %6.2f %7.2f %7.1f   %5.3f (%.3f to %.3f)  %.4f  %.4f\n", modes[i].name,
               per_pixel(m, o->counters.rays), per_pixel(m, o->counters.steps),
               per_pixel(m, o->counters.triangle_tests), per_pixel(m, o->counters.voxels), o->time.median,
               o->against.median, o->against.minimum, o->against.maximum, o->flip, o->seen_flip);
    }
    printf(
        "  hybrid over triangles: %.2f times as fast; foveated over hybrid: %.2f times (Weier et al. 2014, "
        "Table 3: hybrid over triangles 1.13, 1.78, 1.65, 5.38)\n",
        m->outcomes[MODE_TRIANGLES].time.median / m->outcomes[MODE_HYBRID].time.median,
        m->outcomes[MODE_HYBRID].time.median / m->outcomes[MODE_FOVEATED].time.median);
}

gw_code gw_bench_modes(gw_bench *bench, gw_error *error) {
    bench_modes m = {.bench = bench};
    gw_code code = open_modes(&m, error);
    if (!code)
        code = inspect_modes(&m, error);
    if (!code)
        code = time_modes(&m, error);
    if (!code) {
        report_modes(&m);
        code = write_rows(&m, error);
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(&m);
    }
    gw_renderer_destroy(&m.renderer);
    gw_renderer_destroy(&m.counting);
    gw_image_finish(&m.reference);
    gw_image_finish(&m.seen_reference);
    gw_image_finish(&m.picture);
    free(m.outcomes);
    return code;
}
