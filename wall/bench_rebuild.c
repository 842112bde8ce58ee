/* `gazewall bench rebuild`: the octrees of an animated scene, pose after pose a thirtieth of a second apart,
 * first each built anew, then rebuilt twice over. Fails when a rebuild differs from the build of its pose by
 * a bit. */
#include "wall/bench.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/scene_pose.h"
#include "wall/report.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum { POSES = 60, QUICK_POSES = 4 };
enum { BUILD, FIRST_ROUND, SECOND_ROUND, ROUNDS };
static const int64_t pose_step = 1000000000 / 30; /* ns */
static const char *const round_names[ROUNDS] = {"built anew", "rebuilt", "rebuilt again"};

typedef struct rebuilds {
    gw_bench *bench;
    gw_posed *posed;
    gw_octree_rebuilder *rebuilder;
    uint32_t count;
    gw_hash *hashes;                       /* [count] of the builds */
    double *milliseconds[ROUNDS];          /* [count] */
    double pose_ms;                        /* sum over the builds' poses, and one to warm up */
    uint64_t made[ROUNDS], reused[ROUNDS]; /* buffers on the GPU */
} rebuilds;

static gw_code run_pose(rebuilds *r, int round, uint32_t i, gw_error *error) {
    gw_gl *device = r->bench->model.device;
    const gw_octree_options options = {.settings = &r->bench->draw.settings};
    const gw_octree *made = NULL;
    gw_octree *owned = NULL;
    const int64_t begin = gw_now_ns();
    gw_posed_move(r->posed, (int64_t)i * pose_step);
    const int64_t posed = gw_now_ns();
    gw_code code = round == BUILD ? gw_octree_build(device, gw_posed_scene(r->posed), &options, &owned, error)
                                  : gw_octree_rebuild(r->rebuilder, gw_posed_scene(r->posed), &made, error);
    r->milliseconds[round][i] = (double)(gw_now_ns() - posed) * 1e-6;
    if (!code && round == BUILD) {
        r->hashes[i] = owned->hash;
        r->pose_ms += (double)(posed - begin) * 1e-6;
    } else if (!code && !gw_hash_equal(made->hash, r->hashes[i])) {
        code =
            gw_fail(error, GW_MACHINE, "pose %" PRIu32 ": the octree rebuilt differs from the one built", i);
    }
    gw_octree_destroy(&owned);
    return code;
}

static gw_code run_rounds(rebuilds *r, gw_error *error) {
    gw_gl *device = r->bench->model.device;
    gw_code code = run_pose(r, BUILD, 0, error); /* compiles the kernels */
    for (int round = 0; round < ROUNDS && !code; round++) {
        if (round == FIRST_ROUND)
            gw_gl_pool_start(device);
        const gw_gl_pool_counts before = gw_gl_pool_counts_of(device);
        for (uint32_t i = 0; i < r->count && !code; i++) {
            code = run_pose(r, round, i, error);
            gw_log_progress(&r->bench->console.log, round_names[round], (double)(i + 1) / r->count);
        }
        const gw_gl_pool_counts after = gw_gl_pool_counts_of(device);
        r->made[round] = after.made - before.made;
        r->reused[round] = after.reused - before.reused;
    }
    return code;
}

static gw_code tell(rebuilds *r, gw_error *error) {
    const gw_bench *bench = r->bench;
    const double pose_ms = r->pose_ms / (r->count + 1);
    char *text = NULL;
    size_t size = 0;
    FILE *csv = open_memstream(&text, &size);
    json_t *rounds = json_array();
    if (!csv || !rounds)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("pose,build_ms,rebuild_ms,again_ms\n", csv);
    for (uint32_t i = 0; i < r->count; i++)
        fprintf(csv, "%" PRIu32 ",%.3f,%.3f,%.3f\n", i, r->milliseconds[BUILD][i],
                r->milliseconds[FIRST_ROUND][i], r->milliseconds[SECOND_ROUND][i]);
    fclose(csv);
    if (!bench->draw.quiet)
        printf("%s: %" PRIu32 " triangles, %" PRIu32
               " poses of %.2f ms each; all rebuilds have the bytes of builds\n",
               bench->model.scene->path, bench->model.scene->triangle_count, r->count, pose_ms);
    for (int round = 0; round < ROUNDS; round++) {
        const gw_spread ms = gw_spread_of(r->milliseconds[round], r->count);
        json_array_append_new(rounds, json_pack("{s:s, s:f, s:f, s:f, s:I, s:I}", "name", round_names[round],
                                                "median_ms", ms.median, "min_ms", ms.minimum, "max_ms",
                                                ms.maximum, "buffers_made", (json_int_t)r->made[round],
                                                "buffers_reused", (json_int_t)r->reused[round]));
        if (!bench->draw.quiet)
            printf("  %-14s median %7.1f ms   (%.1f to %.1f); %" PRIu64 " buffers made, %" PRIu64 " reused\n",
                   round_names[round], ms.median, ms.minimum, ms.maximum, r->made[round], r->reused[round]);
    }
    json_object_set_new(bench->report, "bench",
                        json_pack("{s:s, s:i, s:f, s:o}", "name", "rebuild", "poses", (int)r->count,
                                  "pose_ms", pose_ms, "rounds", rounds));
    gw_code code = gw_bench_write(bench, "rebuild", text, size, error);
    free(text);
    return code;
}

static gw_code prepare(rebuilds *r, gw_error *error) {
    const gw_octree_options options = {.settings = &r->bench->draw.settings};
    gw_code code = gw_posed_create(r->bench->model.scene, &r->posed, error);
    if (!code)
        code = gw_octree_rebuilder_create(r->bench->model.device, &options, &r->rebuilder, error);
    if (!code)
        code = gw_allocate((void **)&r->hashes, r->count, sizeof *r->hashes, "hashes", error);
    for (int round = 0; round < ROUNDS && !code; round++)
        code = gw_allocate((void **)&r->milliseconds[round], r->count, sizeof(double), "build times", error);
    return code;
}

gw_code gw_bench_rebuild(gw_bench *bench, gw_error *error) {
    rebuilds r = {.bench = bench,
                  .count = bench->repeats ? bench->repeats
                           : bench->quick ? QUICK_POSES
                                          : POSES};
    if (!bench->model.scene->animation)
        return gw_fail(error, GW_BAD_INPUT, "%s: nothing in it moves; give a glTF file with an animation",
                       bench->model.scene->path);
    gw_code code = prepare(&r, error);
    if (!code)
        code = run_rounds(&r, error);
    gw_console_finish(&bench->console);
    if (!code)
        code = tell(&r, error);
    gw_octree_rebuilder_destroy(&r.rebuilder);
    gw_posed_destroy(&r.posed);
    free(r.hashes);
    for (int round = 0; round < ROUNDS; round++)
        free(r.milliseconds[round]);
    return code;
}
