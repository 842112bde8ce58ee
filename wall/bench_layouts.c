/* `gazewall bench layouts`: the same primary rays at tau 0 through the octree in several forms, in turns. */
#include "wall/bench.h"

#include "base/memory.h"
#include "wall/node_study.h"
#include "wall/report.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* What was measured of one entry. */
typedef struct outcome {
    gw_counters counters;
    uint64_t different; /* hits unlike the shipped ones */
    double *ms, *ratio; /* [repeats]; to the shipped one of the same round */
    gw_spread time, against;
} outcome;

typedef struct layouts {
    gw_bench *bench;
    gw_node_study study;
    uint32_t repeats;
    int by_processor; /* 1: times are the process's: software GL runs there, and so may others */
    size_t count;
    gw_ray *rays;
    gw_hit *shipped, *hits;
    outcome outcomes[GW_STUDY_ENTRIES];
} layouts;

static int measured(const layouts *l, uint32_t entry) {
    return !l->study.entries[entry].skipped.text[0];
}

/* One entry once; the shipped one's hits are what the others are compared with. */
static gw_code trace_entry(layouts *l, uint32_t entry, gw_counters *counters, double *ms, gw_error *error) {
    gw_hit *hits = entry == 0 ? l->shipped : l->hits;
    gw_trace_time time = {0};
    gw_code code = gw_node_study_trace(&l->study, entry, l->rays, l->count, hits, counters != NULL, counters,
                                       &time, error);
    *ms = l->by_processor ? time.processor_ms : time.wall_ms;
    if (code || entry == 0)
        return code;
    return gw_study_compare(&l->study.entries[entry], l->shipped, hits, l->count,
                            &l->outcomes[entry].different, error);
}

/* Round 0 counts the work, round 1 warms up, the others are timed. */
static gw_code trace_rounds(layouts *l, gw_error *error) {
    uint32_t rounds = l->repeats + 2;
    gw_code code = GW_OK;
    for (uint32_t round = 0; round < rounds && !code; round++)
        for (uint32_t entry = 0; entry < GW_STUDY_ENTRIES && !code; entry++) {
            outcome *o = &l->outcomes[entry];
            double ms = 0;
            if (measured(l, entry))
                code = trace_entry(l, entry, round == 0 ? &o->counters : NULL, &ms, error);
            if (round >= 2) {
                o->ms[round - 2] = ms;
                o->ratio[round - 2] = ms / l->outcomes[0].ms[round - 2];
            }
            gw_log_progress(&l->bench->console.log, "tracing in turns",
                            (double)(round * GW_STUDY_ENTRIES + entry + 1) / (rounds * GW_STUDY_ENTRIES));
        }
    for (uint32_t entry = 0; entry < GW_STUDY_ENTRIES; entry++) {
        l->outcomes[entry].time = gw_spread_of(l->outcomes[entry].ms, l->repeats);
        l->outcomes[entry].against = gw_spread_of(l->outcomes[entry].ratio, l->repeats);
    }
    return code;
}

static double per_ray(const layouts *l, uint64_t count) {
    return (double)count / (double)l->count;
}

static double bytes_per_triangle(const layouts *l, const gw_study_entry *entry) {
    uint64_t bytes = 0;
    for (int part = 0; part < GW_STUDY_PARTS; part++)
        bytes += entry->bytes[part];
    return (double)bytes / l->bench->model.scene->triangle_count;
}

static json_t *entry_report(const layouts *l, uint32_t index) {
    const gw_study_entry *entry = &l->study.entries[index];
    const outcome *o = &l->outcomes[index];
    if (!measured(l, index))
        return json_pack("{s:s, s:s, s:s}", "name", entry->name, "what", entry->what, "skipped",
                         entry->skipped.text);
    return json_pack(
        "{s:s, s:s, s:{s:I, s:I, s:I}, s:f, s:I, s:{s:I, s:I, s:I, s:I}, s:I, s:{s:f, s:f, s:f}, s:{s:f, "
        "s:f, s:f}}",
        "name", entry->name, "what", entry->what, "bytes", "nodes", (json_int_t)entry->bytes[GW_PART_NODES],
        "references", (json_int_t)entry->bytes[GW_PART_REFERENCES], "grid",
        (json_int_t)entry->bytes[GW_PART_GRID], "bytes_per_triangle", bytes_per_triangle(l, entry), "voxels",
        (json_int_t)entry->voxels, "counters", "steps", (json_int_t)o->counters.steps, "node_loads",
        (json_int_t)o->counters.node_loads, "triangle_tests", (json_int_t)o->counters.triangle_tests,
        "resumed", (json_int_t)o->counters.resumed, "different_hits", (json_int_t)o->different, "ms",
        "median", o->time.median, "min", o->time.minimum, "max", o->time.maximum, "ratio", "median",
        o->against.median, "min", o->against.minimum, "max", o->against.maximum);
}

static void report_layouts(const layouts *l) {
    json_t *entries = json_array();
    for (uint32_t entry = 0; entry < GW_STUDY_ENTRIES; entry++)
        json_array_append_new(entries, entry_report(l, entry));
    json_object_set_new(l->bench->report, "bench",
                        json_pack("{s:s, s:i, s:s, s:I, s:o}", "name", "layouts", "repeats", (int)l->repeats,
                                  "clock", l->by_processor ? "processor" : "wall", "rays",
                                  (json_int_t)l->count, "layouts", entries));
}

static gw_code write_rows(const layouts *l, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("layout,node_bytes,reference_bytes,grid_bytes,bytes_per_triangle,voxels,steps,node_loads,triangle_"
          "tests,"
          "different_hits,median_ms,min_ms,max_ms,median_ratio,min_ratio,max_ratio\n",
          stream);
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; i++) {
        const gw_study_entry *entry = &l->study.entries[i];
        const outcome *o = &l->outcomes[i];
        if (!measured(l, i))
            continue;
        fprintf(stream, "%s,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%.3f,%" PRIu64, entry->name,
                entry->bytes[GW_PART_NODES], entry->bytes[GW_PART_REFERENCES], entry->bytes[GW_PART_GRID],
                bytes_per_triangle(l, entry), entry->voxels);
        fprintf(stream, ",%.4f,%.4f,%.4f,%" PRIu64 ",%.3f,%.3f,%.3f,%.4f,%.4f,%.4f\n",
                per_ray(l, o->counters.steps), per_ray(l, o->counters.node_loads),
                per_ray(l, o->counters.triangle_tests), o->different, o->time.median, o->time.minimum,
                o->time.maximum, o->against.median, o->against.minimum, o->against.maximum);
    }
    fclose(stream);
    gw_code code = gw_bench_write(l->bench, "layouts", text, size, error);
    free(text);
    return code;
}

static void print_summary(const layouts *l) {
    const gw_scene *scene = l->bench->model.scene;
    printf("%s: %" PRIu32 " triangles, depth %" PRIu32 ", %zu primary rays, %" PRIu32
           " rounds in turns on %s\n",
           scene->path, scene->triangle_count, l->bench->model.octree->depth, l->count, l->repeats,
           gw_gl_limits_of(l->bench->model.device)->renderer);
    printf("  times by the %s clock\n", l->by_processor ? "processor" : "wall");
    printf("                      bytes a triangle          per ray               median\n");
    printf(
        "  layout               nodes  refs  grid   steps  loads  tests      ms   ratio (from to)       hits "
        "that differ\n");
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; i++) {
        const gw_study_entry *entry = &l->study.entries[i];
        const outcome *o = &l->outcomes[i];
        double triangles = scene->triangle_count;
        if (!measured(l, i)) {
            printf("  %-19s skipped: %s\n", entry->name, entry->skipped.text);
            continue;
        }
        printf("  %-19s %6.1f %5.1f %5.1f  %6.1f %6.1f %6.1f %7.1f   %5.3f (%.3f to %.3f)  %" PRIu64 "\n",
               entry->name, (double)entry->bytes[GW_PART_NODES] / triangles,
               (double)entry->bytes[GW_PART_REFERENCES] / triangles,
               (double)entry->bytes[GW_PART_GRID] / triangles, per_ray(l, o->counters.steps),
               per_ray(l, o->counters.node_loads), per_ray(l, o->counters.triangle_tests), o->time.median,
               o->against.median, o->against.minimum, o->against.maximum, o->different);
    }
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; i++)
        printf("  %s: %s\n", l->study.entries[i].name, l->study.entries[i].what);
}

static gw_code measure(layouts *l, gw_error *error) {
    gw_bench *bench = l->bench;
    l->repeats = bench->repeats ? bench->repeats : bench->quick ? 2 : 7;
    l->by_processor = gw_gl_limits_of(bench->model.device)->software;
    gw_renderer_options options = {.log = &bench->console.log};
    gw_code code = gw_node_study_open(bench->model.device, bench->model.scene, bench->model.octree, &options,
                                      &l->study, error);
    if (!code)
        code = gw_bench_rays(bench, &l->rays, &l->count, error);
    if (!code)
        code = gw_allocate((void **)&l->shipped, l->count, sizeof *l->shipped, "hits", error);
    if (!code)
        code = gw_allocate((void **)&l->hits, l->count, sizeof *l->hits, "hits", error);
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES && !code; i++) {
        code = gw_allocate((void **)&l->outcomes[i].ms, l->repeats, sizeof(double), "times", error);
        if (!code)
            code = gw_allocate((void **)&l->outcomes[i].ratio, l->repeats, sizeof(double), "times", error);
    }
    if (!code)
        code = trace_rounds(l, error);
    if (code)
        return code;
    report_layouts(l);
    code = write_rows(l, error);
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(l);
    }
    return code;
}

gw_code gw_bench_layouts(gw_bench *bench, gw_error *error) {
    layouts *l = NULL;
    gw_code code = gw_allocate((void **)&l, 1, sizeof *l, "the comparison", error);
    if (code)
        return code;
    l->bench = bench;
    code = measure(l, error);
    gw_node_study_close(&l->study);
    for (uint32_t i = 0; i < GW_STUDY_ENTRIES; i++) {
        free(l->outcomes[i].ms);
        free(l->outcomes[i].ratio);
    }
    free(l->rays);
    free(l->shipped);
    free(l->hits);
    free(l);
    return code;
}
