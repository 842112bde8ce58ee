/* `gazewall bench table2`: Table 2 of Weier et al. 2014, "A Unified Triangle/Voxel Structure for GPUs and its
 * Applications" - the bytes of an octree that is refined to the finest voxels everywhere, against one that
 * stops where a cell has at most two triangles - for the scenes given, in the paper's node and in ours, with
 * our rules beside.
 *
 * The paper's bytes are computed from the counts of our build with its rules: its node is 8 bytes and keeps
 * all eight children, empty ones included (its Fig. 2 and 3), a leaf with one triangle holds it, a voxel is
 * RGBA and three floats of normal (its Table 1). */
#include "wall/bench.h"

#include "wall/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* 512^3 voxels; a shallow tree is enough to show that it works. */
enum { PAPER_DEPTH = 9, QUICK_DEPTH = 6 };
enum { PAPER_NODE_BYTES = 8, PAPER_VOXEL_BYTES = 16 };

typedef enum rules { EVERYWHERE, PAPER_STOP, OURS_AT_PAPER_DEPTH, OURS, RULES_COUNT } rules;

/* The rows of the table. against: the row whose bytes are 100 % for "saved", or none. */
static const struct {
    const char *name;
    rules rules;
    int paper_bytes; /* 1: the paper's node and voxel, 0: ours */
    int against;
} rows[] = {
    {"refined everywhere in the paper's node", EVERYWHERE, 1, -1},
    {"early stop in the paper's node", PAPER_STOP, 1, 0},
    {"refined everywhere", EVERYWHERE, 0, -1},
    {"early stop by the paper's rule", PAPER_STOP, 0, 2},
    {"early stop by our rules", OURS_AT_PAPER_DEPTH, 0, 2},
    {"our rules and depth", OURS, 0, -1},
};
enum { ROW_COUNT = sizeof rows / sizeof *rows };

/* Table 2 as printed there, in MB of 10^6 bytes: full, then early stop. The statue has 1.088 million
 * triangles. */
static const struct {
    const char *scene;
    double nodes[2], references[2], voxels[2], triangles;
} paper[] = {
    {"Sponza", {42.29, 10.89}, {14.14, 12.51}, {46.06, 13.97}, 27.66},
    {"Urban Sprawl", {18.32, 12.37}, {19.31, 18.47}, {20.38, 14.77}, 75.19},
    {"Happy Buddha", {11.42, 10.97}, {21.94, 21.92}, {11.95, 11.81}, 103.07},
    {"Forest Scene", {30.41, 21.27}, {34.58, 34.00}, {33.29, 27.20}, 156.25},
};

typedef struct table_row {
    const gw_built *built;
    double nodes, references, voxels, triangles; /* bytes; references with the boxes of dense leaves */
    double saved_all,
        saved_tree; /* of all bytes, of nodes and voxels; per cent, negative for no comparison */
} table_row;

static gw_settings settings_of(const gw_bench *bench, rules which) {
    gw_settings settings = bench->draw.settings;
    if (which != OURS || bench->quick)
        settings.octree_depth = bench->quick ? QUICK_DEPTH : PAPER_DEPTH;
    if (which != OURS)
        settings.dense_leaf = 0; /* boxes over long lists stop nothing */
    if (which == EVERYWHERE || which == PAPER_STOP) {
        settings.leaf_triangles = which == EVERYWHERE ? 0 : 2;
        settings.fan_rule = settings.isolation_rule = 0;
    }
    return settings;
}

static double percent_saved(double now, double before) {
    return before > 0 ? 100.0 * (1.0 - now / before) : 0.0;
}

static void fill_rows(const gw_built built[RULES_COUNT], table_row table[ROW_COUNT]) {
    for (int i = 0; i < ROW_COUNT; i++) {
        const gw_built *b = &built[rows[i].rules];
        double inner = (double)b->statistics.inner, leaves = (double)b->statistics.leaves;
        table[i] = (table_row){.built = b,
                               .nodes = (double)b->node_bytes,
                               .references = (double)b->reference_bytes,
                               .voxels = (double)b->payload_bytes,
                               .triangles = (double)b->triangle_bytes,
                               .saved_all = NAN,
                               .saved_tree = NAN};
        if (rows[i].paper_bytes) {
            table[i].nodes = PAPER_NODE_BYTES * (1 + 8 * inner);
            table[i].voxels = PAPER_VOXEL_BYTES * (inner + leaves);
        }
        if (rows[i].against < 0)
            continue;
        const table_row *full = &table[rows[i].against];
        table[i].saved_tree = percent_saved(table[i].nodes + table[i].voxels, full->nodes + full->voxels);
        table[i].saved_all =
            percent_saved(table[i].nodes + table[i].references + table[i].voxels + table[i].triangles,
                          full->nodes + full->references + full->voxels + full->triangles);
    }
}

static void print_saved(double percent) {
    if (isnan(percent))
        printf("%9s", "");
    else
        printf("%7.1f %%", percent);
}

static void print_scene(const gw_scene *scene, const table_row table[ROW_COUNT]) {
    double triangles = scene->triangle_count;
    printf("%s: %" PRIu32 " triangles, %.2f MB\n", scene->path, scene->triangle_count,
           table[0].triangles * 1e-6);
    printf("  %-39s %5s %31s %20s %18s   %s\n", "", "depth", "MB: nodes  references  voxels",
           "B/triangle, +voxels", "saved: all, tree", "ms: refine, leaves, up, all");
    for (int i = 0; i < ROW_COUNT; i++) {
        const table_row *r = &table[i];
        const double *ms = r->built->statistics.milliseconds;
        printf("  %-39s %5" PRIu32 " %11.2f %11.2f %7.2f %11.1f %8.1f", rows[i].name, r->built->depth,
               r->nodes * 1e-6, r->references * 1e-6, r->voxels * 1e-6,
               (r->nodes + r->references) / triangles, (r->nodes + r->references + r->voxels) / triangles);
        print_saved(r->saved_all);
        print_saved(r->saved_tree);
        printf("   %.0f, %.0f, %.0f, %.0f\n", ms[0], ms[1], ms[2], r->built->total_ms);
    }
}

static void print_paper(void) {
    printf("Table 2 of Weier et al. 2014 (512^3; MB; refined everywhere -> early stop):\n");
    for (size_t i = 0; i < sizeof paper / sizeof *paper; i++) {
        double tree[2], all[2];
        for (int k = 0; k < 2; k++) {
            tree[k] = paper[i].nodes[k] + paper[i].voxels[k];
            all[k] = tree[k] + paper[i].references[k] + paper[i].triangles;
        }
        printf("  %-13s nodes %.2f -> %.2f, index array %.2f -> %.2f, voxels %.2f -> %.2f, triangles %.2f; "
               "saved of "
               "all %.1f %%, of nodes + voxels %.1f %%\n",
               paper[i].scene, paper[i].nodes[0], paper[i].nodes[1], paper[i].references[0],
               paper[i].references[1], paper[i].voxels[0], paper[i].voxels[1], paper[i].triangles,
               percent_saved(all[1], all[0]), percent_saved(tree[1], tree[0]));
    }
    printf("  its statue of 1.088 million triangles: 30.2 bytes a triangle without voxels, 41.1 with\n");
}

static json_t *json_of_row(const table_row *r, int i) {
    const double *ms = r->built->statistics.milliseconds;
    return json_pack(
        "{s:s, s:i, s:b, s:I, s:I, s:I, s:{s:f, s:f, s:f, s:f}, s:o, s:o, s:{s:f, s:f, s:f, s:f, s:f}}",
        "row", rows[i].name, "depth", (int)r->built->depth, "paper_bytes", rows[i].paper_bytes, "inner",
        (json_int_t)r->built->statistics.inner, "leaves", (json_int_t)r->built->statistics.leaves, "pairs",
        (json_int_t)r->built->statistics.pairs, "bytes", "nodes", r->nodes, "references", r->references,
        "voxels", r->voxels, "triangles", r->triangles, "saved_all_percent",
        rows[i].against < 0 ? json_null() : json_real(r->saved_all), "saved_nodes_voxels_percent",
        rows[i].against < 0 ? json_null() : json_real(r->saved_tree), "build_ms", "refinement", ms[0],
        "leaf_payload", ms[1], "inner_payload", ms[2], "assembly", ms[3], "total", r->built->total_ms);
}

static void write_csv_rows(FILE *csv, const gw_scene *scene, const table_row table[ROW_COUNT]) {
    for (int i = 0; i < ROW_COUNT; i++) {
        const table_row *r = &table[i];
        const gw_octree_statistics *s = &r->built->statistics;
        fprintf(csv, "\"%s\",%" PRIu32 ",\"%s\",%" PRIu32 ",%" PRIu64 ",%" PRIu64 ",%.0f,%.0f,%.0f,%.0f,",
                scene->path, scene->triangle_count, rows[i].name, r->built->depth, s->inner, s->leaves,
                r->nodes, r->references, r->voxels, r->triangles);
        if (rows[i].against >= 0)
            fprintf(csv, "%.3f,%.3f", r->saved_all, r->saved_tree);
        else
            fputc(',', csv);
        fprintf(csv, ",%.3f,%.3f,%.3f,%.3f,%.3f\n", s->milliseconds[0], s->milliseconds[1],
                s->milliseconds[2], s->milliseconds[3], r->built->total_ms);
    }
}

static gw_code measure_scene(gw_bench *bench, const char *path, FILE *csv, json_t *scenes, gw_error *error) {
    gw_built built[RULES_COUNT];
    table_row table[ROW_COUNT];
    bench->draw.scene = path;
    gw_code code = gw_model_import(&bench->model, &bench->draw, &bench->console.log, error);
    for (rules r = 0; r < RULES_COUNT && code == GW_OK; r++) {
        gw_settings settings = settings_of(bench, r);
        code = gw_bench_measure(bench, bench->model.scene, &settings, bench->repeats ? bench->repeats : 1,
                                &built[r], error);
    }
    if (code == GW_OK) {
        const gw_scene *scene = bench->model.scene;
        json_t *list = json_array();
        fill_rows(built, table);
        for (int i = 0; i < ROW_COUNT; i++)
            json_array_append_new(list, json_of_row(&table[i], i));
        json_array_append_new(scenes, json_pack("{s:s, s:I, s:o}", "file", scene->path, "triangles",
                                                (json_int_t)scene->triangle_count, "rows", list));
        write_csv_rows(csv, scene, table);
        if (!bench->draw.quiet) {
            gw_console_finish(&bench->console);
            print_scene(scene, table);
        }
    }
    gw_model_drop(&bench->model);
    return code;
}

gw_code gw_bench_table2(gw_bench *bench, gw_error *error) {
    const char *only[] = {bench->draw.scene};
    const char **paths = bench->scene_count ? bench->scenes : only;
    size_t count = bench->scene_count ? bench->scene_count : 1, size = 0;
    char *text = NULL;
    FILE *csv = open_memstream(&text, &size);
    json_t *scenes = json_array();
    gw_code code = csv && scenes ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while writing results");
    if (code == GW_OK)
        fputs("scene,triangles,row,depth,inner,leaves,node_bytes,reference_bytes,voxel_bytes,triangle_bytes,"
              "saved_all_percent,saved_nodes_voxels_percent,refinement_ms,leaf_payload_ms,inner_payload_ms,"
              "assembly_ms,total_ms\n",
              csv);
    for (size_t i = 0; i < count && code == GW_OK; i++)
        code = measure_scene(bench, paths[i], csv, scenes, error);
    if (csv)
        fclose(csv);
    json_object_set_new(bench->report, "bench", json_pack("{s:s, s:o}", "name", "table2", "scenes", scenes));
    if (code == GW_OK)
        code = gw_bench_write(bench, "table2", text, size, error);
    if (code == GW_OK && !bench->draw.quiet)
        print_paper();
    free(text);
    return code;
}
