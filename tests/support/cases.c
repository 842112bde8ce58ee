/* See cases.h. */
#include "tests/support/cases.h"

#include "tests/support/check.h"
#include "tests/support/meshes.h"

#include <math.h>

const gw_rung gw_sound_rungs[GW_SOUND_RUNGS] = {
    {"shipped", NULL},
    {"contracted", "#define CONTRACTED 1\n"},
    {"double", "#define DOUBLE_EDGES 1\n"},
    {"ordered, contracted even under precise", "#define ORDERED_EDGES 1\n#define CONTRACTED_PRECISE 1\n"},
};

void gw_case_open(gw_case *c, gw_gl *device, gw_scene *scene, int depth) {
    gw_settings settings;
    gw_settings_init(&settings);
    settings.octree_depth = depth;
    *c = (gw_case){.scene = scene};
    check_ok(gw_octree_build(device, scene, &(gw_octree_options){.settings = &settings}, &c->octree, &error));
    check_ok(gw_renderer_create(device, scene, c->octree, NULL, &c->renderer, &error));
}

void gw_case_close(gw_case *c) {
    gw_renderer_destroy(&c->renderer);
    gw_octree_destroy(&c->octree);
    gw_scene_destroy(&c->scene);
}

static gw_hit *trace(const gw_case *c, const gw_trace_variant *variant, const gw_ray *rays, size_t count) {
    gw_hit *hits = calloc(count, sizeof *hits);
    assert_non_null(hits);
    gw_counters counters = {0};
    gw_trace_time time = {0};
    check_ok(gw_renderer_trace_variant(c->renderer, variant, rays, count, hits, &counters, &time, &error));
    assert_int_equal(counters.step_cap_hits, 0);
    return hits;
}

gw_hit *gw_case_trace(const gw_case *c, const char *defines, const gw_ray *rays, size_t count) {
    return trace(c, &(gw_trace_variant){.defines = defines}, rays, count);
}

gw_hit *gw_case_brute(const gw_case *c, const gw_ray *rays, size_t count) {
    gw_hit *hits = calloc(count, sizeof *hits);
    assert_non_null(hits);
    check_ok(gw_renderer_trace(c->renderer, GW_TRACE_BRUTE_FORCE, rays, count, hits, NULL, &error));
    return hits;
}

size_t gw_case_misses(const gw_case *c, const char *defines, const gw_ray *rays, size_t count) {
    gw_hit *hits = gw_case_trace(c, defines, rays, count);
    size_t misses = 0;
    for (size_t i = 0; i < count; ++i)
        misses += hits[i].triangle == GW_NO_TRIANGLE;
    free(hits);
    return misses;
}

size_t gw_case_odd(const gw_case *c, const char *defines, const gw_ray *rays, size_t count) {
    gw_hit *counts =
        trace(c, &(gw_trace_variant){.kernel = "bench/parity.comp", .defines = defines}, rays, count);
    size_t odd = 0;
    for (size_t i = 0; i < count; ++i) {
        uint32_t fronts;
        memcpy(&fronts, &counts[i].t, sizeof fronts);
        odd += (fronts > 0) != (counts[i].triangle > 0);
    }
    free(counts);
    return odd;
}

void gw_case_rebase(const gw_scene *scene, const double point[3], double out[3]) {
    for (int k = 0; k < 3; ++k)
        out[k] = ldexp(point[k] - scene->centre[k], -scene->exponent);
}

static const float *position(const gw_scene *scene, uint32_t triangle, uint32_t corner) {
    return scene->positions + (size_t)scene->triangles[triangle][corner] * 3;
}

gw_ray *gw_aim_at_features(const gw_scene *scene, const double from[3], double spread, uint32_t on_edge,
                           uint64_t seed, size_t *count) {
    *count = (size_t)scene->triangle_count * 3 * (on_edge + 1);
    gw_ray *rays = calloc(*count, sizeof *rays), *ray = rays;
    assert_non_null(rays);
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            const float *a = position(scene, t, k), *b = position(scene, t, (k + 1) % 3);
            for (uint32_t j = 0; j <= on_edge; ++j, ++ray) {
                double share = j == 0 ? 0.0 : gw_test_random(&seed);
                for (int i = 0; i < 3; ++i) {
                    ray->origin[i] = (float)(from[i] + spread * (gw_test_random(&seed) - 0.5));
                    double at = (1.0 - share) * (double)a[i] + share * (double)b[i];
                    ray->direction[i] = (float)(at - (double)ray->origin[i]);
                }
                ray->maximum = INFINITY;
            }
        }
    return rays;
}
