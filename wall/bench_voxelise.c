/* `gazewall bench voxelise`: the rasterised A-buffer voxeliser of Weier et al. 2014 against the refinement of
 * pairs: which (voxel, triangle) pairs each finds and the other lacks and why, time and bytes. */
#include "wall/bench.h"

#include "wall/report.h"
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
} comparison;

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
    c->refined = refined.count;
    c->rasterised = rasterised.count;
    gw_pairs_finish(&refined);
    gw_pairs_finish(&rasterised);
    if (code == GW_OK && c->differences.unexplained > 0)
        code = gw_fail(error, GW_MACHINE, "refinement has missed %" PRIu64 " voxels that triangles touch",
                       c->differences.unexplained);
    return code;
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
}

static gw_code write_results(gw_bench *bench, const comparison *c, gw_error *error) {
    const gw_pair_differences *d = &c->differences;
    char row[512];
    json_object_set_new(
        bench->report, "bench",
        json_pack("{s:s, s:i, s:{s:I, s:f, s:f}, s:{s:I, s:f, s:f, s:i}, s:I, s:{s:I, s:I, s:I, s:I}, "
                  "s:{s:I, s:I}}",
                  "name", "voxelise", "depth", (int)c->depth, "refinement", "pairs", (json_int_t)c->refined,
                  "bytes", (double)PAIR_BYTES * (double)c->refined, "ms", c->refine_ms, "rasteriser", "pairs",
                  (json_int_t)c->rasterised, "bytes", (double)sizeof(gw_fragment) * (double)c->fragments,
                  "ms", c->raster_ms, "draws", (int)c->draws, "both", (json_int_t)d->both, "refinement_alone",
                  "other_depth", (json_int_t)d->other_depth, "thinner", (json_int_t)d->thinner, "no_fragment",
                  (json_int_t)d->no_fragment, "margin", (json_int_t)d->touching, "rasteriser_alone", "beside",
                  (json_int_t)d->beside, "unexplained", (json_int_t)d->unexplained));
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
