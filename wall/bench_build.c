/* `gazewall bench build`. */
#include "wall/bench.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/report.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum { PHASES = 4, COLUMNS = PHASES + 1 };
static const char *const column_names[COLUMNS] = {"total", "refinement", "leaf_payload", "inner_payload",
                                                  "assembly"};

/* One build; fails when its bytes differ from those of the model's octree. */
static gw_code build_once(gw_bench *bench, double *row, gw_error *error) {
    gw_octree *octree = NULL;
    gw_octree_options options = {.settings = &bench->draw.settings, .log = &bench->console.log};
    int64_t begin = gw_now_ns();
    gw_code code = gw_octree_build(bench->model.device, bench->model.scene, &options, &octree, error);
    row[0] = (double)(gw_now_ns() - begin) * 1e-6;
    if (code)
        return code;
    for (int i = 0; i < PHASES; i++)
        row[i + 1] = octree->statistics.milliseconds[i];
    if (!gw_hash_equal(octree->hash, bench->model.octree->hash))
        code = gw_fail(error, GW_MACHINE,
                       "two builds of the same octree differ; this device is not deterministic");
    gw_octree_destroy(&octree);
    return code;
}

static void report_columns(gw_bench *bench, const double *rows, uint32_t count, gw_spread spreads[COLUMNS]) {
    json_t *times = json_object();
    double column[1000];
    for (int c = 0; c < COLUMNS; c++) {
        for (uint32_t i = 0; i < count; i++)
            column[i] = rows[i * COLUMNS + (uint32_t)c];
        spreads[c] = gw_spread_of(column, count);
        json_object_set_new(times, column_names[c],
                            json_pack("{s:f, s:f, s:f}", "median_ms", spreads[c].median, "min_ms",
                                      spreads[c].minimum, "max_ms", spreads[c].maximum));
    }
    const gw_octree *octree = bench->model.octree;
    double triangles = bench->model.scene->triangle_count;
    double bytes = (double)gw_octree_bytes(octree);
    json_object_set_new(bench->report, "bench",
                        json_pack("{s:s, s:i, s:o, s:f, s:f}", "name", "build", "repeats", (int)count,
                                  "times", times, "ms_per_million_triangles",
                                  spreads[0].median / (triangles * 1e-6), "bytes_per_triangle",
                                  bytes / triangles));
}

static gw_code write_rows(const gw_bench *bench, const double *rows, uint32_t count, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("run,total_ms,refinement_ms,leaf_payload_ms,inner_payload_ms,assembly_ms\n", stream);
    for (uint32_t i = 0; i < count; i++) {
        fprintf(stream, "%" PRIu32, i);
        for (int c = 0; c < COLUMNS; c++)
            fprintf(stream, ",%.3f", rows[i * COLUMNS + (uint32_t)c]);
        fputc('\n', stream);
    }
    fclose(stream);
    gw_code code = gw_bench_write(bench, "build", text, size, error);
    free(text);
    return code;
}

static void print_summary(const gw_bench *bench, const gw_spread spreads[COLUMNS], uint32_t count) {
    const gw_octree *octree = bench->model.octree;
    const gw_octree_statistics *s = &octree->statistics;
    double triangles = bench->model.scene->triangle_count;
    printf("%s: %" PRIu32 " triangles, depth %" PRIu32 ", %" PRIu32 " nodes, %" PRIu32
           " builds, all the same bytes\n",
           bench->model.scene->path, bench->model.scene->triangle_count, octree->depth, octree->node_count,
           count);
    for (int c = 0; c < COLUMNS; c++)
        printf("  %-14s median %8.1f ms   (%.1f to %.1f)\n", column_names[c], spreads[c].median,
               spreads[c].minimum, spreads[c].maximum);
    printf("  %.0f ms a million triangles; %.2f pairs and %.2f overlap tests a triangle; %.0f bytes a "
           "triangle\n",
           spreads[0].median / (triangles * 1e-6), (double)s->pairs / triangles,
           (double)s->overlap_tests / triangles, (double)gw_octree_bytes(octree) / triangles);
}

gw_code gw_bench_build(gw_bench *bench, gw_error *error) {
    /* The build that opened the model compiled the kernels: it is the warm-up. */
    uint32_t count = bench->repeats ? bench->repeats : bench->quick ? 2 : 7;
    double *rows = NULL;
    gw_spread spreads[COLUMNS];
    gw_code code = gw_allocate((void **)&rows, (size_t)count * COLUMNS, sizeof *rows, "build times", error);
    for (uint32_t i = 0; i < count && !code; i++) {
        code = build_once(bench, rows + (size_t)i * COLUMNS, error);
        gw_log_progress(&bench->console.log, "building again and again", (double)(i + 1) / count);
    }
    if (!code) {
        report_columns(bench, rows, count, spreads);
        code = write_rows(bench, rows, count, error);
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(bench, spreads, count);
    }
    free(rows);
    return code;
}
