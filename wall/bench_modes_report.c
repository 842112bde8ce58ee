/* See bench_modes.h: what `bench modes` tells. */
#include "wall/bench_modes.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Two rounds of the same kernel differ by so much on a machine that is not alone. */
static const double noise = 0.05;

/* One of the goals that hold for every scene. */
typedef struct verdict {
    const char *name, *what;
    double value, least, target; /* over the path; in the worst frame; wanted */
    int every_frame;             /* 1: the worst frame counts, within the noise */
} verdict;
enum { VERDICTS = 3 };

static verdict judge(const gw_bench_modes *m, gw_mode slow, gw_mode fast, verdict v) {
    const gw_mode_outcome *a = &m->outcomes[slow], *b = &m->outcomes[fast];
    v.value = a->mean_ms / b->mean_ms;
    v.least = v.value;
    for (uint32_t s = 0; s < m->stations; s++)
        v.least = fmin(v.least, a->ms[s] / b->ms[s]);
    return v;
}

static int is_met(const verdict *v) {
    return v->every_frame ? v->least >= v->target * (1 - noise) : v->value >= v->target;
}

static void judge_all(const gw_bench_modes *m, verdict out[VERDICTS]) {
    out[0] = judge(m, GW_MODE_TRIANGLES, GW_MODE_HYBRID,
                   (verdict){.name = "hybrid_over_triangles",
                             .what = "hybrid never slower than triangles only",
                             .target = 1,
                             .every_frame = 1});
    out[1] = judge(m, GW_MODE_EXACT, GW_MODE_TRIANGLES,
                   (verdict){.name = "triangles_over_exact",
                             .what = "triangles only never slower than tau 0",
                             .target = 1,
                             .every_frame = 1});
    out[2] = judge(m, GW_MODE_HYBRID, GW_MODE_FOVEATED,
                   (verdict){.name = "foveated_over_hybrid",
                             .what = "foveated at least 4 times as fast as hybrid",
                             .target = 4});
}

static double per_pixel(const gw_bench_modes *m, uint64_t count) {
    return (double)count / ((double)m->path.size[0] * m->path.size[1] * m->stations);
}

/* Share of the rays that met a voxel. */
static double voxel_share(const gw_mode_outcome *o) {
    return (double)o->counters.voxel_rays / (double)o->counters.rays;
}

static json_t *flicker_json(const gw_flicker_result *f) {
    return json_pack("{s:f, s:f, s:f, s:f}", "mean", f->mean, "percentile_99", f->percentile, "largest",
                     f->largest, "pop", f->pop);
}

static json_t *mode_json(const gw_bench_modes *m, const gw_mode_outcome *o) {
    const gw_counters *c = &o->counters;
    json_t *times = json_array();
    for (uint32_t s = 0; s < m->stations; s++)
        json_array_append_new(times, json_real(o->ms[s]));
    const int compared = !m->bench->times_only, pairs = compared && m->path.path;
    json_t *flicker = pairs ? flicker_json(&o->flicker) : json_null();
    json_t *seen = pairs ? flicker_json(&o->seen_flicker) : json_null();
    return json_pack(
        "{s:s, s:s, s:{s:I, s:I, s:I, s:I, s:I, s:I, s:I}, s:o, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o}",
        "name", o->name, "what", o->what, "counters", "rays", (json_int_t)c->rays, "steps",
        (json_int_t)c->steps, "node_loads", (json_int_t)c->node_loads, "triangle_tests",
        (json_int_t)c->triangle_tests, "voxels", (json_int_t)c->voxels, "voxel_rays",
        (json_int_t)c->voxel_rays, "shadow_rays", (json_int_t)c->shadow_rays, "ms", times, "mean_ms",
        o->mean_ms, "frame_rate", 1000 / o->mean_ms, "ratio", o->ratio, "voxel_share", voxel_share(o), "flip",
        compared ? json_real(o->flip) : json_null(), "seen_flip",
        compared ? json_real(o->seen_flip) : json_null(), "flicker", flicker, "seen_flicker", seen);
}

static void report_modes(const gw_bench_modes *m) {
    json_t *entries = json_array(), *verdicts = json_array();
    verdict judged[VERDICTS];
    judge_all(m, judged);
    for (int i = 0; i < GW_MODE_COUNT; i++)
        json_array_append_new(entries, mode_json(m, &m->outcomes[i]));
    for (int i = 0; i < VERDICTS; i++)
        json_array_append_new(verdicts, json_pack("{s:s, s:s, s:f, s:f, s:f, s:b}", "name", judged[i].name,
                                                  "what", judged[i].what, "value", judged[i].value,
                                                  "worst_frame", judged[i].least, "target", judged[i].target,
                                                  "met", is_met(&judged[i])));
    json_object_set_new(m->bench->report, "bench",
                        json_pack("{s:s, s:s?, s:i, s:i, s:s, s:[i,i], s:f, s:i, s:o, s:o}", "name", "modes",
                                  "path", m->path.path ? m->path.path->name : NULL, "frames",
                                  (int)m->stations, "rounds", (int)m->rounds, "clock",
                                  m->by_processor ? "processor" : "wall", "size", (int)m->path.size[0],
                                  (int)m->path.size[1], "pixels_per_degree", m->pixels_per_degree,
                                  "octree_depth", (int)m->bench->model.octree->depth, "modes", entries,
                                  "verdicts", verdicts));
}

static gw_code write_rows(const gw_bench_modes *m, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("mode,rays,shadow_rays,steps,node_loads,triangle_tests,voxels,voxel_share,mean_ms,frame_rate,ratio,"
          "flip,seen_"
          "flip,"
          "flicker,flicker_99,pop,seen_flicker,seen_flicker_99,seen_pop\n",
          stream);
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        const gw_mode_outcome *o = &m->outcomes[i];
        const gw_flicker_result *f = &o->flicker, *seen = &o->seen_flicker;
        fprintf(stream, "%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%.4f,", o->name,
                per_pixel(m, o->counters.rays), per_pixel(m, o->counters.shadow_rays),
                per_pixel(m, o->counters.steps), per_pixel(m, o->counters.node_loads),
                per_pixel(m, o->counters.triangle_tests), per_pixel(m, o->counters.voxels), voxel_share(o),
                o->mean_ms, 1000 / o->mean_ms, o->ratio);
        if (m->bench->times_only)
            fputs(",,,,,,,\n", stream);
        else
            fprintf(stream, "%.5f,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f\n", o->flip, o->seen_flip, f->mean,
                    f->percentile, f->pop, seen->mean, seen->percentile, seen->pop);
    }
    fclose(stream);
    gw_code code = gw_bench_write(m->bench, "modes", text, size, error);
    free(text);
    return code;
}

/* Time of each frame by mode. */
static gw_code write_plot(const gw_bench_modes *m, gw_error *error) {
    double frames[GW_MODES_FRAMES];
    gw_plot_series series[GW_MODE_COUNT];
    for (uint32_t s = 0; s < m->stations; s++)
        frames[s] = s + 1;
    for (int i = 0; i < GW_MODE_COUNT; i++)
        series[i] = (gw_plot_series){
            .name = m->outcomes[i].name, .x = frames, .y = m->outcomes[i].ms, .count = m->stations};
    const gw_plot plot = {.title = "Frame time along the path",
                          .x_label = "frame",
                          .y_label = "ms",
                          .series = series,
                          .series_count = GW_MODE_COUNT};
    return gw_bench_plot(m->bench, "modes-time", &plot, error);
}

gw_code gw_modes_write(gw_bench_modes *m, gw_error *error) {
    report_modes(m);
    gw_code code = write_rows(m, error);
    return code || !m->bench->out ? code : write_plot(m, error);
}

static void print_table(const gw_bench_modes *m) {
    printf("              per pixel                                 voxel    mean  frames\n");
    printf("  mode         rays shadow  steps  loads  tests  voxels  rays      ms    /s   ratio\n");
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        const gw_mode_outcome *o = &m->outcomes[i];
        printf("  %-10s %6.3f %6.3f %6.1f %6.1f %6.2f %7.2f %4.0f%% %7.1f %5.2f   %5.3f\n", o->name,
               per_pixel(m, o->counters.rays), per_pixel(m, o->counters.shadow_rays),
               per_pixel(m, o->counters.steps), per_pixel(m, o->counters.node_loads),
               per_pixel(m, o->counters.triangle_tests), per_pixel(m, o->counters.voxels),
               100 * voxel_share(o), o->mean_ms, 1000 / o->mean_ms, o->ratio);
    }
    if (m->bench->times_only)
        return;
    printf("              FLIP    seen   flicker: mean    99 %%     pop   seen: mean    99 %%     pop\n");
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        const gw_mode_outcome *o = &m->outcomes[i];
        const gw_flicker_result *f = &o->flicker, *seen = &o->seen_flicker;
        printf("  %-10s %.4f  %.4f         %.4f  %.4f  %.4f       %.4f  %.4f  %.4f\n", o->name, o->flip,
               o->seen_flip, f->mean, f->percentile, f->pop, seen->mean, seen->percentile, seen->pop);
    }
}

void gw_modes_print(const gw_bench_modes *m) {
    const gw_scene *scene = m->bench->model.scene;
    verdict judged[VERDICTS];
    judge_all(m, judged);
    printf("%s: %" PRIu32 " triangles, depth %" PRIu32 ", %" PRIu32 "x%" PRIu32 " px, %.1f px a degree\n",
           scene->path, scene->triangle_count, m->bench->model.octree->depth, m->path.size[0],
           m->path.size[1], m->pixels_per_degree);
    if (m->path.path)
        printf("  camera path '%s': %" PRIu32 " pairs of its %d frames, the best of %" PRIu32
               " rounds in turns",
               m->path.path->name, m->stations, GW_PATH_FRAMES, m->rounds);
    else
        printf("  no camera path: one view of the default wall, no flicker; the best of %" PRIu32
               " rounds in turns",
               m->rounds);
    printf(" on %s, %s clock%s\n", gw_gl_limits_of(m->bench->model.device)->renderer,
           m->by_processor ? "processor" : "wall",
           m->bench->point_light ? "; one point light instead of the scene's" : "");
    if (!m->bench->times_only)
        printf("  errors to 16 exact rays a pixel, plain and as seen by a viewer who looks at the centre\n");
    print_table(m);
    for (int i = 0; i < VERDICTS; i++)
        printf("  %s: %.2f over the path, %.2f in the worst frame: %s\n", judged[i].what, judged[i].value,
               judged[i].least, is_met(&judged[i]) ? "met" : "not met");
    printf("  hybrid over triangles only in Weier et al. 2014, Table 3: 1.13 (Sponza), 1.78 (urban), 1.65 "
           "(statue), 5.38 (forest); here %.2f\n",
           judged[0].value);
}
