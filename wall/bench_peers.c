/* `gazewall bench peers`: the same primary rays through this octree, on the GL device, and through Embree, on
 * the processor, in turns. Embree is loaded when asked for, so that the program runs where it is not
 * installed. */
#include "wall/bench_view.h"

#include "base/clock.h"
#include "base/memory.h"
#include "render/features.h"
#include "render/renderer.h"
#include "wall/peer.h"
#include "wall/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Hits nearer together than this, relative to the distance, are the same surface: the two programs round
 * differently, and at a shared edge either triangle is right. */
static const double same_distance = 1e-4;

/* A ray so near to an edge, in rebased units, may be rounded to either side of it: coordinates are floats up
 * to about 2, and a dozen of their last bits go into an edge function. */
static const double rounding = 1e-6;

/* What is aimed at: our rate of rays over the peer's, and the peer's time for a full frame over ours for a
 * foveated one. */
static const double rate_target = 0.7, foveated_target = 3.0;

/* And the most that a foveated frame may take of the time of one with a ray for every pixel, ours too. */
static const double share_target = 0.15;

typedef struct comparison {
    uint64_t rays, both_miss, same;
    uint64_t neighbour; /* other triangle at the same distance: shared edges, coincident surfaces */
    /* One program hits a triangle that the other passes, and the ray goes by its edge within rounding. */
    uint64_t edge_ours, edge_theirs;
    uint64_t unexplained;      /* anything else that differs */
    double largest_difference; /* relative, among `same` and `neighbour` */
} comparison;

typedef struct peers {
    gw_bench *bench;
    gw_renderer *renderer;
    gw_peer *peer;
    int by_processor; /* 1: times are the process's processors' */
    size_t count;
    gw_ray *rays;
    gw_hit *ours, *theirs;
    double our_ms[1000], their_ms[1000];
    double stream_ms[1000]; /* of theirs, in packets */
    double kernel_ms[1000]; /* of ours, without copying rays and hits to and from the device */
    gw_bench_view view;     /* whose rays they are */
    gw_frame_state state;   /* of the foveated frame */
    gw_frame_state full;    /* of one that nobody looks at: a ray through triangles for every pixel */
    uint8_t *picture;
    uint64_t foveated_rays;
    double foveated_ms[1000], full_ms[1000];
} peers;

/* Software GL traces on the processors of this process as the peer does, and others may use them, too. */
static int64_t clock_of(const peers *p) {
    return p->by_processor ? gw_processor_ns() : gw_now_ns();
}

/* Sampling, tracing, shading, reconstruction and the way back of the pixels. */
static gw_code draw(peers *p, const gw_frame_state *state, uint64_t *rays, double *ms, gw_error *error) {
    gw_counters counters = {0};
    int64_t begin = clock_of(p);
    gw_code code = gw_renderer_frame(p->renderer, &p->view.placement, &p->view.plane, &p->view.rectangle,
                                     state, p->picture, &counters, error);
    *ms = (double)(clock_of(p) - begin) * 1e-6;
    *rays = counters.rays;
    return code;
}

static gw_code trace_both(peers *p, uint32_t repeats, gw_error *error) {
    gw_code code = gw_allocate((void **)&p->ours, p->count, sizeof *p->ours, "hits", error);
    if (!code)
        code = gw_allocate((void **)&p->theirs, p->count, sizeof *p->theirs, "hits", error);
    static const gw_trace_variant shipped;
    /* Run 0 warms up both: kernels, caches, threads. */
    for (uint32_t i = 0; i <= repeats && !code; i++) {
        int64_t begin = clock_of(p);
        gw_trace_time kernels = {0};
        code = gw_renderer_trace_variant(p->renderer, &shipped, p->rays, p->count, p->ours, NULL, &kernels,
                                         error);
        int64_t middle = clock_of(p);
        if (!code)
            code = gw_peer_trace(p->peer, GW_PEER_STREAM, p->rays, p->count, p->theirs, error);
        int64_t packed = clock_of(p);
        if (!code)
            code = gw_peer_trace(p->peer, GW_PEER_SINGLE, p->rays, p->count, p->theirs, error);
        int64_t end = clock_of(p);
        double foveated = 0, full = 0;
        uint64_t all_rays;
        if (!code)
            code = draw(p, &p->full, &all_rays, &full, error);
        if (!code)
            code = draw(p, &p->state, &p->foveated_rays, &foveated, error);
        if (i > 0) {
            p->full_ms[i - 1] = full;
            p->foveated_ms[i - 1] = foveated;
            p->our_ms[i - 1] = (double)(middle - begin) * 1e-6;
            p->kernel_ms[i - 1] = p->by_processor ? kernels.processor_ms : kernels.wall_ms;
            p->stream_ms[i - 1] = (double)(packed - middle) * 1e-6;
            p->their_ms[i - 1] = (double)(end - packed) * 1e-6;
        }
        gw_log_progress(&p->bench->console.log, "tracing in turns", (double)(i + 1) / (repeats + 1));
    }
    return code;
}

/* Distance between a ray's line and the nearest edge of a triangle, in rebased units. */
static double edge_distance(const gw_scene *scene, const gw_ray *ray, uint32_t triangle) {
    double nearest = INFINITY;
    for (int corner = 0; corner < 3; corner++) {
        const float *a = scene->positions + (size_t)scene->triangles[triangle][corner] * 3;
        const float *b = scene->positions + (size_t)scene->triangles[triangle][(corner + 1) % 3] * 3;
        double edge[3], across[3], length = 0, along = 0;
        for (int i = 0; i < 3; i++)
            edge[i] = (double)b[i] - (double)a[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            across[i] = (double)ray->direction[j] * edge[k] - (double)ray->direction[k] * edge[j];
            length += across[i] * across[i];
            along += across[i] * ((double)a[i] - (double)ray->origin[i]);
        }
        if (length > 0)
            nearest = fmin(nearest, fabs(along) / sqrt(length));
    }
    return nearest;
}

/* The two programs do not meet the same surface: is the nearer triangle one whose edge the ray touches? */
static void explain(const peers *p, size_t i, comparison *c) {
    const gw_hit *ours = &p->ours[i], *theirs = &p->theirs[i];
    int we_are_nearer = ours->t < theirs->t;
    uint32_t triangle = we_are_nearer ? ours->triangle : theirs->triangle;
    if (edge_distance(p->bench->model.scene, &p->rays[i], triangle) > rounding)
        c->unexplained++;
    else if (we_are_nearer)
        c->edge_ours++;
    else
        c->edge_theirs++;
}

static comparison compare_hits(const peers *p) {
    comparison c = {.rays = p->count};
    for (size_t i = 0; i < p->count; i++) {
        const gw_hit *a = &p->ours[i], *b = &p->theirs[i];
        int hit_a = a->triangle != GW_NO_TRIANGLE, hit_b = b->triangle != GW_NO_TRIANGLE;
        double apart = fabs((double)a->t - (double)b->t) / fmax(fabs((double)b->t), 1e-6);
        if (!hit_a && !hit_b) {
            c.both_miss++;
        } else if (hit_a != hit_b || apart > same_distance) {
            explain(p, i, &c);
        } else {
            c.largest_difference = fmax(c.largest_difference, apart);
            c.same += a->triangle == b->triangle;
            c.neighbour += a->triangle != b->triangle;
        }
    }
    return c;
}

static void report_peers(peers *p, const comparison *c, uint32_t repeats, const gw_spread *ours,
                         const gw_spread *theirs) {
    double rays = (double)p->count, kernels = gw_spread_of(p->kernel_ms, repeats).median;
    double foveated = gw_spread_of(p->foveated_ms, repeats).median;
    double stream = gw_spread_of(p->stream_ms, repeats).median;
    double full = gw_spread_of(p->full_ms, repeats).median;
    json_t *hits = json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f}", "rays", (json_int_t)c->rays,
                             "both_miss", (json_int_t)c->both_miss, "same", (json_int_t)c->same, "neighbour",
                             (json_int_t)c->neighbour, "edge_ours", (json_int_t)c->edge_ours, "edge_theirs",
                             (json_int_t)c->edge_theirs, "unexplained", (json_int_t)c->unexplained,
                             "largest_difference", c->largest_difference);
    json_object_set_new(
        p->bench->report, "bench",
        json_pack("{s:s, s:s, s:s, s:s, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o, s:f, s:f, s:f, s:f, "
                  "s:{s:f, s:I, s:f, s:f, s:f, s:f, s:f}}",
                  "name", "peers", "clock", p->by_processor ? "processor" : "wall", "peer",
                  gw_peer_name(p->peer), "peer_mode", "rtcIntersect1, robust", "repeats", (int)repeats,
                  "our_median_ms", ours->median, "their_median_ms", theirs->median, "our_rays_per_s",
                  rays / (ours->median * 1e-3), "their_rays_per_s", rays / (theirs->median * 1e-3), "ratio",
                  ours->median / theirs->median, "our_kernels_median_ms", kernels, "ratio_of_kernels",
                  kernels / theirs->median, "hits", hits, "rate_over_peer", theirs->median / ours->median,
                  "rate_target", rate_target, "their_stream_median_ms", stream, "rate_over_peer_stream",
                  stream / ours->median, "foveated", "median_ms", foveated, "rays",
                  (json_int_t)p->foveated_rays, "peer_full_over_foveated", theirs->median / foveated,
                  "target", foveated_target, "full_median_ms", full, "share_of_full", foveated / full,
                  "share_target", share_target));
}

static gw_code write_rows(const peers *p, uint32_t repeats, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("run,our_ms,their_ms,their_stream_ms,our_foveated_ms,our_full_ms\n", stream);
    for (uint32_t i = 0; i < repeats; i++)
        fprintf(stream, "%" PRIu32 ",%.3f,%.3f,%.3f,%.3f,%.3f\n", i, p->our_ms[i], p->their_ms[i],
                p->stream_ms[i], p->foveated_ms[i], p->full_ms[i]);
    fclose(stream);
    gw_code code = gw_bench_write(p->bench, "peers", text, size, error);
    free(text);
    return code;
}

static void print_target(const char *what, double value, double target) {
    printf("  %s %.2f, target %.1f: %s\n", what, value, target, value >= target ? "met" : "not met");
}

static void print_share(double foveated, double full) {
    printf("  a ray for every pixel %.1f ms; the foveated frame takes %.0f %% of that, target %.0f %%: %s\n",
           full, 100 * foveated / full, 100 * share_target,
           foveated <= share_target * full ? "met" : "not met");
}

static void print_summary(const peers *p, const comparison *c, uint32_t repeats, const gw_spread *ours,
                          const gw_spread *theirs) {
    double rays = (double)p->count, kernels = gw_spread_of(p->kernel_ms, repeats).median;
    const gw_spread foveated = gw_spread_of(p->foveated_ms, repeats);
    const gw_spread stream = gw_spread_of(p->stream_ms, repeats);
    printf("%s: %zu primary rays, in turns, by the %s clock, median (from to)\n", p->bench->model.scene->path,
           p->count, p->by_processor ? "processor" : "wall");
    printf("  gazewall   %8.1f ms (%.1f to %.1f), %.2f million rays/s on %s\n", ours->median, ours->minimum,
           ours->maximum, rays / ours->median * 1e-3, gw_gl_limits_of(p->bench->model.device)->renderer);
    printf("   kernels   %8.1f ms, %.2f million rays/s: without copying rays and hits\n", kernels,
           rays / kernels * 1e-3);
    printf("  %-10s %8.1f ms (%.1f to %.1f), %.2f million rays/s, rtcIntersect1, robust\n",
           gw_peer_name(p->peer), theirs->median, theirs->minimum, theirs->maximum,
           rays / theirs->median * 1e-3);
    printf("   packets   %8.1f ms (%.1f to %.1f), %.2f million rays/s, rtcIntersect1M, coherent, robust\n",
           stream.median, stream.minimum, stream.maximum, rays / stream.median * 1e-3);
    printf("  ratio of the medians %.2f, without copies %.2f\n", ours->median / theirs->median,
           kernels / theirs->median);
    print_target("our rate over theirs", theirs->median / ours->median, rate_target);
    printf("  our rate over that of their packets %.2f\n", stream.median / ours->median);
    printf("  foveated   %8.1f ms (%.1f to %.1f), %.1f %% of the rays: sampled, traced, shaded, "
           "reconstructed; without "
           "shadows and mirrors\n",
           foveated.median, foveated.minimum, foveated.maximum, 100.0 * (double)p->foveated_rays / rays);
    print_share(foveated.median, gw_spread_of(p->full_ms, repeats).median);
    print_target("their full frame over our foveated one", theirs->median / foveated.median, foveated_target);
    printf("  their full frame of packets over our foveated one %.2f\n", stream.median / foveated.median);
    printf("  hits: %" PRIu64 " the same, %" PRIu64 " both miss, %" PRIu64
           " the neighbour at the same distance; distances within %.1e\n"
           "  an edge that only we hit %" PRIu64 ", that only they hit %" PRIu64 "; not explained %" PRIu64
           "\n",
           c->same, c->both_miss, c->neighbour, c->largest_difference, c->edge_ours, c->edge_theirs,
           c->unexplained);
}

static gw_code measure(peers *p, gw_error *error) {
    gw_bench *bench = p->bench;
    uint32_t repeats = bench->repeats ? bench->repeats : bench->quick ? 2 : 7;
    gw_renderer_options options = gw_bench_rendering(bench, 0);
    options.forbid_features |= GW_FEATURE_SHADOWS | GW_SECONDARY_FEATURES; /* the peer traces primary rays */
    gw_bench_path path = {.scene = bench->model.scene};
    gw_bench_ray_size(bench, path.size);
    gw_code code = gw_peer_create(bench->model.scene, 1, &p->peer, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &options,
                                  &p->renderer, error);
    if (!code)
        code = gw_bench_rays(bench, &p->rays, &p->count, error);
    if (!code)
        code = gw_bench_view_at(&path, 0, &p->view, error);
    if (!code)
        code = gw_allocate((void **)&p->picture, p->count, 4, "the picture", error);
    if (code)
        return code;
    p->by_processor = gw_gl_limits_of(bench->model.device)->software;
    p->state = gw_bench_target_state(bench, &p->view);
    p->full = gw_bench_state(bench, &p->view, 0);
    code = trace_both(p, repeats, error);
    if (code)
        return code;
    comparison c = compare_hits(p);
    gw_spread ours = gw_spread_of(p->our_ms, repeats), theirs = gw_spread_of(p->their_ms, repeats);
    report_peers(p, &c, repeats, &ours, &theirs);
    code = write_rows(p, repeats, error);
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_summary(p, &c, repeats, &ours, &theirs);
    }
    return code;
}

gw_code gw_bench_peers(gw_bench *bench, gw_error *error) {
    peers *p = NULL;
    gw_code code = gw_allocate((void **)&p, 1, sizeof *p, "the comparison", error);
    if (code)
        return code;
    p->bench = bench;
    code = measure(p, error);
    gw_renderer_destroy(&p->renderer);
    gw_peer_destroy(&p->peer);
    free(p->rays);
    free(p->ours);
    free(p->theirs);
    free(p->picture);
    free(p);
    return code;
}
