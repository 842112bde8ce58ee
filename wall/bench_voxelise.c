/* `gazewall bench voxelise`: the rasterised A-buffer voxeliser of Weier et al. 2014 against the refinement of
 * pairs: which (voxel, triangle) pairs each finds and the other lacks and why, time and bytes; then that
 * paper's build loop over its fragments against our build with its stopping rule, phase by phase. */
#include "wall/bench.h"

#include "wall/report.h"
#include "wall/splat_build.h"
#include "wall/voxel_pairs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* 512^3 voxels; quick: 64^3. */
enum { DEPTH = 9, QUICK_DEPTH = 6, PAIR_BYTES = 8 };

typedef struct comparison {
    uint32_t depth;
    gw_pair_differences differences;
    size_t refined, rasterised;
    uint64_t fragments;
    uint32_t draws;
    double subpixel;
    double refine_ms, raster_ms; /* the fastest */
    int has_loop;                /* 0: its fragments do not fit one buffer */
    gw_splat_counts loop;        /* the fastest */
    gw_built ours;               /* with the paper's stopping rule */
} comparison;

static double loop_ms(const gw_splat_counts *loop) {
    double sum = 0;
    for (int p = 0; p < GW_SPLAT_PHASES; p++)
        sum += loop->milliseconds[p];
    return sum;
}

static gw_code run_loop(gw_bench *bench, comparison *c, const gw_voxelised *voxelised, gw_error *error) {
    gw_splat_counts loop;
    if (!voxelised->buffer.id)
        return GW_OK;
    gw_code code = gw_splat_build(bench->model.device, voxelised, c->depth,
                                  bench->model.scene->triangle_count, &loop, error);
    if (code == GW_OK && (!c->has_loop || loop_ms(&loop) < loop_ms(&c->loop)))
        c->loop = loop;
    c->has_loop = code == GW_OK;
    return code;
}

/* Our build with the paper's rule. */
static gw_code build_ours(gw_bench *bench, comparison *c, uint32_t repeats, gw_error *error) {
    gw_settings settings = bench->draw.settings;
    settings.octree_depth = (int32_t)c->depth;
    settings.leaf_triangles = 2;
    settings.fan_rule = settings.isolation_rule = 0;
    return gw_bench_measure(bench, bench->model.scene, &settings, repeats, &c->ours, error);
}

static gw_code refine(gw_bench *bench, comparison *c, gw_pairs *pairs, gw_error *error) {
    gw_octree *octree = NULL;
    gw_settings settings = bench->draw.settings;
    gw_octree_options options = {.settings = &settings, .log = &bench->console.log};
    settings.octree_depth = (int32_t)c->depth;
    settings.leaf_triangles = 0;
    settings.fan_rule = settings.isolation_rule = 0;
    gw_code code = gw_octree_build(bench->model.device, bench->model.scene, &options, &octree, error);
    if (code != GW_OK)
        return code;
    double ms = octree->statistics.milliseconds[0];
    c->refine_ms = pairs->keys && c->refine_ms < ms ? c->refine_ms : ms;
    if (!pairs->keys)
        code = gw_pairs_of_octree(octree, pairs, error);
    gw_octree_destroy(&octree);
    return code;
}

static gw_code rasterise(gw_bench *bench, comparison *c, gw_pairs *pairs, gw_error *error) {
    gw_voxelised voxelised;
    gw_code code =
        gw_voxelise(bench->model.device, bench->model.scene, 1u << c->depth, 1, 0, &voxelised, error);
    if (code != GW_OK)
        return code;
    c->raster_ms =
        pairs->keys && c->raster_ms < voxelised.milliseconds ? c->raster_ms : voxelised.milliseconds;
    c->fragments = voxelised.count;
    c->draws = voxelised.draws;
    c->subpixel = voxelised.subpixel;
    if (!pairs->keys)
        code = gw_pairs_of_fragments(&voxelised, pairs, error);
    if (code == GW_OK)
        code = run_loop(bench, c, &voxelised, error);
    gw_voxelised_finish(&voxelised);
    return code;
}

/* By turns, so that a busy machine disturbs both alike. */
static gw_code measure(gw_bench *bench, comparison *c, gw_error *error) {
    gw_pairs refined = {0}, rasterised = {0};
    uint32_t repeats = bench->repeats ? bench->repeats : bench->quick ? 1 : 3;
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < repeats && code == GW_OK; i++) {
        code = refine(bench, c, &refined, error);
        if (code == GW_OK)
            code = rasterise(bench, c, &rasterised, error);
    }
    if (code == GW_OK)
        code = gw_pairs_compare(bench->model.scene, 1u << c->depth, c->subpixel, &refined, &rasterised,
                                &c->differences, error);
    if (code == GW_OK)
        code = build_ours(bench, c, repeats, error);
    c->refined = refined.count;
    c->rasterised = rasterised.count;
    gw_pairs_finish(&refined);
    gw_pairs_finish(&rasterised);
    if (code == GW_OK && c->differences.unexplained > 0)
        code = gw_fail(error, GW_MACHINE, "refinement has missed %" PRIu64 " voxels that triangles touch",
                       c->differences.unexplained);
    return code;
}

static void print_builds(const comparison *c) {
    const gw_splat_counts *loop = &c->loop;
    const gw_octree_statistics *ours = &c->ours.statistics;
    if (c->has_loop)
        printf("  the paper's loop: %" PRIu64 " nodes (%" PRIu64 " inner, %" PRIu64 " leaves, %" PRIu64
               " empty), %" PRIu64
               " index entries; ms: fragments %.1f, top-down %.1f, lists %.1f, leaf voxels %.1f, "
               "bottom-up %.1f, total %.1f\n",
               loop->nodes, loop->inner, loop->leaves, loop->empty, loop->pair_entries + loop->list_entries,
               c->raster_ms, loop->milliseconds[GW_SPLAT_TOP_DOWN], loop->milliseconds[GW_SPLAT_LISTS],
               loop->milliseconds[GW_SPLAT_LEAVES], loop->milliseconds[GW_SPLAT_BOTTOM_UP],
               c->raster_ms + loop_ms(loop));
    else
        printf("  the paper's loop was not run: its fragments do not fit one buffer of this driver\n");
    printf("  ours, same rule:  %" PRIu64 " nodes (%" PRIu64 " inner, %" PRIu64 " leaves), %" PRIu64
           " references; ms: refinement %.1f, leaf voxels %.1f, upwards %.1f, assembly %.1f, total %.1f\n",
           ours->inner + ours->leaves, ours->inner, ours->leaves, c->ours.reference_bytes / 4,
           ours->milliseconds[0], ours->milliseconds[1], ours->milliseconds[2], ours->milliseconds[3],
           c->ours.total_ms);
}

static json_t *loop_json(const comparison *c) {
    const double *ms = c->loop.milliseconds;
    return c->has_loop
               ? json_pack("{s:I, s:I, s:I, s:I, s:I, s:{s:f, s:f, s:f, s:f, s:f}}", "nodes",
                           (json_int_t)c->loop.nodes, "inner", (json_int_t)c->loop.inner, "leaves",
                           (json_int_t)c->loop.leaves, "pair_entries", (json_int_t)c->loop.pair_entries,
                           "list_entries", (json_int_t)c->loop.list_entries, "ms", "fragments", c->raster_ms,
                           "top_down", ms[GW_SPLAT_TOP_DOWN], "lists", ms[GW_SPLAT_LISTS], "leaf_voxels",
                           ms[GW_SPLAT_LEAVES], "bottom_up", ms[GW_SPLAT_BOTTOM_UP])
               : json_null();
}

static json_t *ours_json(const comparison *c) {
    const gw_octree_statistics *s = &c->ours.statistics;
    return json_pack("{s:I, s:I, s:I, s:{s:f, s:f, s:f, s:f, s:f}}", "inner", (json_int_t)s->inner, "leaves",
                     (json_int_t)s->leaves, "reference_bytes", (json_int_t)c->ours.reference_bytes, "ms",
                     "refinement", s->milliseconds[0], "leaf_payload", s->milliseconds[1], "inner_payload",
                     s->milliseconds[2], "assembly", s->milliseconds[3], "total", c->ours.total_ms);
}

static void print_summary(const gw_bench *bench, const comparison *c) {
    const gw_pair_differences *d = &c->differences;
    printf("%s: %" PRIu32 " triangles, %u^3 voxels\n", bench->model.scene->path,
           bench->model.scene->triangle_count, 1u << c->depth);
    printf("  refinement   %10zu pairs, %8.2f MB, %8.1f ms from the root down\n", c->refined,
           1e-6 * PAIR_BYTES * (double)c->refined, c->refine_ms);
    printf("  rasteriser   %10zu pairs, %8.2f MB, %8.1f ms to the fragments, %" PRIu32 " draws\n",
           c->rasterised, 1e-6 * (double)sizeof(gw_fragment) * (double)c->fragments, c->raster_ms, c->draws);
    printf("  both         %10" PRIu64 "\n", d->both);
    printf("  refinement alone %" PRIu64 ": %" PRIu64
           " in a pixel whose one fragment is at another depth, %" PRIu64
           " thinner than the rasteriser's subpixels, %" PRIu64 " without a fragment, %" PRIu64
           " within the boxes' margin only\n",
           d->other_depth + d->thinner + d->no_fragment + d->touching, d->other_depth, d->thinner,
           d->no_fragment, d->touching);
    printf("  rasteriser alone %" PRIu64 ": beside the triangle, covered by its enlargement\n", d->beside);
    print_builds(c);
}

static gw_code write_results(gw_bench *bench, const comparison *c, gw_error *error) {
    const gw_pair_differences *d = &c->differences;
    char row[512];
    json_object_set_new(
        bench->report, "bench",
        json_pack("{s:s, s:i, s:{s:I, s:f, s:f}, s:{s:I, s:f, s:f, s:i}, s:I, s:{s:I, s:I, s:I, s:I}, "
                  "s:{s:I, s:I}, s:o, s:o}",
                  "name", "voxelise", "depth", (int)c->depth, "refinement", "pairs", (json_int_t)c->refined,
                  "bytes", (double)PAIR_BYTES * (double)c->refined, "ms", c->refine_ms, "rasteriser", "pairs",
                  (json_int_t)c->rasterised, "bytes", (double)sizeof(gw_fragment) * (double)c->fragments,
                  "ms", c->raster_ms, "draws", (int)c->draws, "both", (json_int_t)d->both, "refinement_alone",
                  "other_depth", (json_int_t)d->other_depth, "thinner", (json_int_t)d->thinner, "no_fragment",
                  (json_int_t)d->no_fragment, "margin", (json_int_t)d->touching, "rasteriser_alone", "beside",
                  (json_int_t)d->beside, "unexplained", (json_int_t)d->unexplained, "paper_loop",
                  loop_json(c), "ours_same_rule", ours_json(c)));
    int length = snprintf(
        row, sizeof row,
        "depth,refined,rasterised,fragments,both,other_depth,thinner,no_fragment,margin,beside,refine_ms,"
        "raster_ms\n%" PRIu32 ",%zu,%zu,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64
        ",%" PRIu64 ",%.3f,%.3f\n",
        c->depth, c->refined, c->rasterised, c->fragments, d->both, d->other_depth, d->thinner,
        d->no_fragment, d->touching, d->beside, c->refine_ms, c->raster_ms);
    return gw_bench_write(bench, "voxelise", row, (size_t)length, error);
}

gw_code gw_bench_voxelise(gw_bench *bench, gw_error *error) {
    comparison c = {.depth = bench->quick ? QUICK_DEPTH : DEPTH};
    gw_code code = measure(bench, &c, error);
    if (code == GW_OK)
        code = write_results(bench, &c, error);
    if (code == GW_OK && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(bench, &c);
    }
    return code;
}
