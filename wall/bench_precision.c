/* `gazewall bench precision`: how often each rung of the triangle test fails, and what it costs. Closed rocks
 * of many triangles, rays from inside and outside at their vertices and edges; Embree beside. */
#include "wall/bench.h"

#include "base/memory.h"
#include "wall/peer.h"
#include "wall/rock.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIANGLES = 1000000, QUICK_TRIANGLES = 6000, LARGE_TRIANGLES = 300, BATCH = 1 << 16 };
static const uint64_t default_rays = 1000000, quick_rays = 20000;
/* Rungs but the shipped one need no more to be told apart. */
static const uint64_t enough_rays = 200000;

/* What counts as a failure. */
typedef enum failure { MISSED, ENTERED_ONLY, DISTANCE_OFF } failure;

typedef struct family {
    const char *name, *what;
    int edges; /* 1: aimed at places along edges, 0: at vertices */
    int grid;  /* log2 of the cells to which its vertices are rounded; 0: not */
    failure counted;
} family;

static const family families[] = {
    {"vertices", "from inside at vertices: misses", 0, 0, MISSED},
    {"edges", "from inside at places along edges: misses", 1, 0, MISSED},
    {"snapped", "at edges of the rock rounded as floats far away are: misses", 1, 9, MISSED},
    {"outside", "from outside at edges: enters without leaving, or leaves only", 1, 0, ENTERED_ONLY},
    {"distance", "from inside at edges of a rock of large triangles: t off by more than 3e-7", 1, 0,
     DISTANCE_OFF},
};
enum { FAMILIES = sizeof families / sizeof *families };

typedef struct rung {
    const char *name, *what, *defines;
    int embree; /* 1: its default mode, 2: robust */
} rung;

static const rung rungs[] = {
    {"fast", "Moeller and Trumbore 1997, float", "#define FAST_TRIANGLES 1\n", 0},
    {"watertight", "Woop, Benthin and Wald 2013, float, t from weighted depths",
     "#define WEIGHTED_DEPTHS 1\n", 0},
    {"shipped", "the same with t of the plane, kept on the ray", NULL, 0},
    {"ordered", "and with edge products that no contraction can part", "#define ORDERED_EDGES 1\n", 0},
    {"double", "and with products of zero taken again in double", "#define DOUBLE_EDGES 1\n", 0},
    {"embree", "Embree's default mode", NULL, 1},
    {"embree-robust", "Embree's robust mode", NULL, 2},
};
enum { RUNGS = sizeof rungs / sizeof *rungs, SHIPPED = 2 };

typedef struct outcome {
    uint64_t rays, failures;
    double ms; /* of the processor where software GL runs there, else of the clock */
    const char *skipped;
} outcome;

typedef struct ladder {
    gw_bench *bench;
    uint64_t wanted; /* rays of the shipped rung */
    gw_scene *scene; /* of the family under way */
    gw_octree *octree;
    gw_renderer *renderer;
    gw_ray *rays; /* [BATCH] */
    gw_hit *hits;
    outcome outcomes[FAMILIES][RUNGS];
} ladder;

/* S. Vigna: splitmix64. */
static uint64_t mix(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static double share_of(uint64_t *state) {
    return (double)(mix(state) >> 11) * 0x1p-53;
}

static const float *corner(const gw_scene *scene, uint32_t triangle, uint32_t k) {
    return scene->positions + (size_t)scene->triangles[triangle][k % 3] * 3;
}

/* The ray of this number, the same whatever batch it is in: from near the middle, or from outside in any
 * direction, at a vertex or a place along an edge. */
static void make_ray(const gw_scene *scene, const family *f, uint64_t number, gw_ray *ray) {
    uint64_t random = number * 3 + 1;
    const uint32_t triangle = (uint32_t)(mix(&random) % scene->triangle_count),
                   k = (uint32_t)(mix(&random) % 3);
    const float *a = corner(scene, triangle, k), *b = corner(scene, triangle, k + 1);
    const double share = f->edges ? share_of(&random) : 0, reach = f->counted == ENTERED_ONLY ? 6 : 0.2;
    double from[3], length = 0;
    for (int i = 0; i < 3; i++) {
        from[i] = reach * (share_of(&random) - 0.5);
        length = hypot(length, from[i]);
    }
    for (int i = 0; i < 3; i++) {
        if (f->counted == ENTERED_ONLY)
            from[i] *= 3 / fmax(length, 1e-3);
        ray->origin[i] = (float)from[i];
        ray->direction[i] =
            (float)((1 - share) * (double)a[i] + share * (double)b[i] - (double)ray->origin[i]);
    }
    ray->minimum = 0;
    ray->maximum = INFINITY;
}

/* t of the triangle's plane in double. */
static double exact_distance(const gw_scene *scene, const gw_ray *ray, uint32_t triangle) {
    double ab[3], ac[3], above = 0, along = 0;
    for (int i = 0; i < 3; i++) {
        ab[i] = (double)corner(scene, triangle, 1)[i] - (double)corner(scene, triangle, 0)[i];
        ac[i] = (double)corner(scene, triangle, 2)[i] - (double)corner(scene, triangle, 0)[i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double normal = ab[j] * ac[k] - ab[k] * ac[j];
        above += ((double)corner(scene, triangle, 0)[i] - (double)ray->origin[i]) * normal;
        along += (double)ray->direction[i] * normal;
    }
    return above / along;
}

static uint64_t count_failures(const ladder *l, const family *f, size_t count) {
    uint64_t failures = 0;
    for (size_t i = 0; i < count; i++) {
        const gw_hit *hit = &l->hits[i];
        uint32_t fronts;
        memcpy(&fronts, &hit->t, sizeof fronts);
        if (f->counted == MISSED)
            failures += hit->triangle == GW_NO_TRIANGLE;
        else if (f->counted == ENTERED_ONLY)
            failures += (fronts > 0) != (hit->triangle > 0);
        else if (hit->triangle != GW_NO_TRIANGLE) {
            const double exact = exact_distance(l->scene, &l->rays[i], hit->triangle);
            failures += !(fabs((double)hit->t - exact) <= 3e-7 * fabs(exact));
        }
    }
    return failures;
}

static gw_code trace_batch(ladder *l, const family *f, const rung *r, gw_peer *peer, size_t count, double *ms,
                           gw_error *error) {
    if (peer)
        return gw_peer_trace(peer, GW_PEER_STREAM, l->rays, count, l->hits, error);
    const gw_trace_variant variant = {.kernel = f->counted == ENTERED_ONLY ? "bench/parity.comp" : NULL,
                                      .defines = r->defines};
    gw_trace_time time = {0};
    gw_counters counters = {0};
    gw_code code =
        gw_renderer_trace_variant(l->renderer, &variant, l->rays, count, l->hits, &counters, &time, error);
    *ms += gw_gl_limits_of(l->bench->model.device)->software ? time.processor_ms : time.wall_ms;
    if (!code && counters.step_cap_hits)
        code = gw_fail(error, GW_MACHINE, "%" PRIu64 " rays of family %s were cut off",
                       counters.step_cap_hits, f->name);
    return code;
}

static gw_code climb(ladder *l, const family *f, const rung *r, outcome *o, gw_error *error) {
    gw_peer *peer = NULL;
    if (r->embree) {
        gw_error missing = {0};
        if (f->counted == ENTERED_ONLY)
            o->skipped = "counts no crossings";
        else if (gw_peer_create(l->scene, r->embree == 2, &peer, &missing))
            o->skipped = "not installed";
        if (o->skipped)
            return GW_OK;
    }
    const uint64_t wanted = r == &rungs[SHIPPED] || l->wanted < enough_rays ? l->wanted : enough_rays;
    gw_code code = GW_OK;
    for (uint64_t begin = 0; begin < wanted && !code; begin += BATCH) {
        const size_t count = wanted - begin < BATCH ? (size_t)(wanted - begin) : BATCH;
        for (size_t i = 0; i < count; i++)
            make_ray(l->scene, f, begin + i, &l->rays[i]);
        double first = 0;
        if (!begin && !peer) /* which compiles */
            code = trace_batch(l, f, r, peer, count, &first, error);
        if (!code)
            code = trace_batch(l, f, r, peer, count, &o->ms, error);
        if (code)
            break;
        o->rays += count;
        o->failures += count_failures(l, f, count);
        gw_log_progress(&l->bench->console.log, f->name, (double)(begin + count) / (double)wanted);
    }
    gw_peer_destroy(&peer);
    if (!code)
        gw_log_write(&l->bench->console.log, GW_LOG_INFO, "%s, %s: %" PRIu64 " of %" PRIu64 " rays fail",
                     f->name, r->name, o->failures, o->rays);
    return code;
}

static gw_code open_family(ladder *l, const family *f, gw_error *error) {
    const gw_octree_options octree = {.settings = &l->bench->draw.settings, .log = &l->bench->console.log};
    const gw_renderer_options options = {.log = &l->bench->console.log};
    const uint32_t triangles = f->counted == DISTANCE_OFF ? LARGE_TRIANGLES
                               : l->bench->quick          ? QUICK_TRIANGLES
                                                          : TRIANGLES;
    gw_code code = gw_rock_scene(triangles, &l->scene, error);
    for (size_t i = 0; !code && i < (size_t)l->scene->vertex_count * 3; i++) {
        float *p = &l->scene->positions[i];
        if (f->grid)
            *p = ldexpf(roundf(ldexpf(*p, f->grid)), -f->grid);
    }
    if (!code)
        code = gw_octree_build(l->bench->model.device, l->scene, &octree, &l->octree, error);
    if (!code)
        code = gw_renderer_create(l->bench->model.device, l->scene, l->octree, &options, &l->renderer, error);
    return code;
}

static void close_family(ladder *l) {
    gw_renderer_destroy(&l->renderer);
    gw_octree_destroy(&l->octree);
    gw_scene_destroy(&l->scene);
}

static double per_million(const outcome *o) {
    return o->rays ? 1e6 * (double)o->failures / (double)o->rays : NAN;
}

static double us_per_ray(const outcome *o) {
    return o->rays ? 1e3 * o->ms / (double)o->rays : NAN;
}

static void report(const ladder *l) {
    json_t *rows = json_array();
    for (int f = 0; f < FAMILIES; f++)
        for (int r = 0; r < RUNGS; r++) {
            const outcome *o = &l->outcomes[f][r];
            json_array_append_new(
                rows, o->skipped
                          ? json_pack("{s:s, s:s, s:s}", "family", families[f].name, "rung", rungs[r].name,
                                      "skipped", o->skipped)
                          : json_pack("{s:s, s:s, s:I, s:I, s:f, s:f}", "family", families[f].name, "rung",
                                      rungs[r].name, "rays", (json_int_t)o->rays, "failures",
                                      (json_int_t)o->failures, "per_million", per_million(o), "ms", o->ms));
        }
    json_object_set_new(l->bench->report, "bench",
                        json_pack("{s:s, s:o}", "name", "precision", "rows", rows));
}

static gw_code write_rows(const ladder *l, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("family,rung,rays,failures,per_million,us_per_ray\n", stream);
    for (int f = 0; f < FAMILIES; f++)
        for (int r = 0; r < RUNGS; r++) {
            const outcome *o = &l->outcomes[f][r];
            if (!o->skipped)
                fprintf(stream, "%s,%s,%" PRIu64 ",%" PRIu64 ",%.3f,%.4f\n", families[f].name, rungs[r].name,
                        o->rays, o->failures, per_million(o), rungs[r].embree ? 0 : us_per_ray(o));
        }
    fclose(stream);
    gw_code code = gw_bench_write(l->bench, "precision", text, size, error);
    free(text);
    return code;
}

static void print_summary(const ladder *l) {
    printf("failures in a million rays; %" PRIu64 " rays of each family for the shipped rung\n%-14s",
           l->wanted, "");
    for (int f = 0; f < FAMILIES; f++)
        printf("%12s", families[f].name);
    printf("%12s\n", "time");
    for (int r = 0; r < RUNGS; r++) {
        double time = 0, shipped = 0;
        printf("%-14s", rungs[r].name);
        for (int f = 0; f < FAMILIES; f++) {
            const outcome *o = &l->outcomes[f][r];
            if (o->skipped)
                printf("%12s", "-");
            else
                printf("%12.1f", per_million(o));
            time += us_per_ray(o);
            shipped += us_per_ray(&l->outcomes[f][SHIPPED]);
        }
        if (rungs[r].embree)
            printf("%12s\n", "");
        else
            printf("%12.2f\n", time / shipped);
    }
    for (int f = 0; f < FAMILIES; f++)
        printf("  %s: %s\n", families[f].name, families[f].what);
    for (int r = 0; r < RUNGS; r++)
        printf("  %s: %s\n", rungs[r].name, rungs[r].what);
}

/* The shipped rung must not fail where it promises not to. */
static gw_code check_shipped(const ladder *l, gw_error *error) {
    for (int f = 0; f < FAMILIES; f++)
        if (families[f].counted != DISTANCE_OFF && l->outcomes[f][SHIPPED].failures)
            return gw_fail(error, GW_MACHINE, "%" PRIu64 " of %" PRIu64 " rays fail: %s",
                           l->outcomes[f][SHIPPED].failures, l->outcomes[f][SHIPPED].rays, families[f].what);
    return GW_OK;
}

static gw_code measure(ladder *l, gw_error *error) {
    gw_code code = GW_OK;
    for (int f = 0; f < FAMILIES && !code; f++) {
        code = open_family(l, &families[f], error);
        for (int r = 0; r < RUNGS && !code; r++)
            code = climb(l, &families[f], &rungs[r], &l->outcomes[f][r], error);
        close_family(l);
    }
    if (code)
        return code;
    report(l);
    code = write_rows(l, error);
    if (!code && !l->bench->draw.quiet) {
        gw_console_finish(&l->bench->console);
        print_summary(l);
    }
    return code ? code : check_shipped(l, error);
}

gw_code gw_bench_precision(gw_bench *bench, gw_error *error) {
    ladder *l = NULL;
    gw_code code = gw_allocate((void **)&l, 1, sizeof *l, "the precision ladder", error);
    if (code)
        return code;
    l->bench = bench;
    l->wanted = bench->rays ? bench->rays : bench->quick ? quick_rays : default_rays;
    code = gw_allocate((void **)&l->rays, BATCH, sizeof *l->rays, "rays", error);
    if (!code)
        code = gw_allocate((void **)&l->hits, BATCH, sizeof *l->hits, "hits", error);
    if (!code)
        code = measure(l, error);
    free(l->rays);
    free(l->hits);
    free(l);
    return code;
}
