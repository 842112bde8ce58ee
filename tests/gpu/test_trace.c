/* The octree's traversal against brute force with the same triangle test: the same bits on every ray, the
 * hard ones too. Rays and meshes are random from a printed seed. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/rays.h"
#include "tests/support/renders.h"

#include <math.h>

enum { RAYS = 12000, SEED = 20261122 };

static gw_stage stage;
static gw_renderer *renderer;
static gw_ray *rays;
static size_t ray_count;

static int open_stage(void **state) {
    (void)state;
    print_message("seed %d\n", SEED);
    check_ok(gw_stage_open(&stage, gw_test_scene(SEED), NULL, (const char *const[]){"octree_depth=9", NULL},
                           &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
    rays = gw_test_rays(stage.scene, RAYS, SEED + 1);
    ray_count = RAYS;
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    free(rays);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static gw_hit *trace(gw_renderer *by, gw_trace_method method, const gw_ray *of, size_t count,
                     gw_counters *counters) {
    gw_hit *hits = calloc(count, sizeof *hits);
    assert_non_null(hits);
    check_ok(gw_renderer_trace(by, method, of, count, hits, counters, &error));
    return hits;
}

static void expect_same(const gw_hit *wanted, const gw_hit *got, size_t count) {
    for (size_t i = 0; i < count; ++i)
        if (memcmp(&wanted[i], &got[i], sizeof *got))
            fail_msg("ray %zu: origin %a %a %a direction %a %a %a: triangle %u at %a, expected %u at %a", i,
                     (double)rays[i].origin[0], (double)rays[i].origin[1], (double)rays[i].origin[2],
                     (double)rays[i].direction[0], (double)rays[i].direction[1], (double)rays[i].direction[2],
                     got[i].triangle, (double)got[i].t, wanted[i].triangle, (double)wanted[i].t);
}

static void the_octree_answers_as_brute_force(void **state) {
    (void)state;
    gw_counters counters = {0};
    gw_hit *octree = trace(renderer, GW_TRACE_OCTREE, rays, ray_count, &counters);
    gw_hit *brute = trace(renderer, GW_TRACE_BRUTE_FORCE, rays, ray_count, NULL);
    expect_same(brute, octree, ray_count);
    size_t hit = 0;
    for (size_t i = 0; i < ray_count; ++i)
        hit += octree[i].triangle != GW_NO_TRIANGLE;
    print_message("%zu of %zu rays hit\n", hit, ray_count);
    assert_true(hit > ray_count / 4 && hit < ray_count);
    assert_int_equal(counters.step_cap_hits, 0);
    assert_int_equal(counters.resumed, 0);
    free(octree);
    free(brute);
}

static void suspended_rays_go_on_as_if_nothing_had_happened(void **state) {
    (void)state;
    gw_renderer *short_winded = NULL;
    gw_renderer_options options = {.loop_budget = 32, .count = 1};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &short_winded, &error));
    gw_counters counters = {0};
    gw_hit *whole = trace(renderer, GW_TRACE_OCTREE, rays, ray_count, NULL);
    gw_hit *pieces = trace(short_winded, GW_TRACE_OCTREE, rays, ray_count, &counters);
    expect_same(whole, pieces, ray_count);
    assert_true(counters.resumed > ray_count / 10);
    assert_int_equal(counters.step_cap_hits, 0);
    assert_true(counters.steps > 0 && counters.node_loads > 0 && counters.triangle_tests > 0);
    free(whole);
    free(pieces);
    gw_renderer_destroy(&short_winded);
}

static void wide_node_words_change_nothing(void **state) {
    (void)state;
    gw_renderer *wide = NULL;
    gw_renderer_options options = {.force_features = GW_ALL_FEATURES};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &wide, &error));
    gw_hit *narrow_hits = trace(renderer, GW_TRACE_OCTREE, rays, ray_count, NULL);
    gw_hit *wide_hits = trace(wide, GW_TRACE_OCTREE, rays, ray_count, NULL);
    expect_same(narrow_hits, wide_hits, ray_count);
    free(narrow_hits);
    free(wide_hits);
    gw_renderer_destroy(&wide);
}

static void rays_that_are_not_numbers_miss(void **state) {
    (void)state;
    const float bad[] = {NAN, INFINITY, -INFINITY};
    gw_ray odd[20];
    size_t count = 0;
    for (int b = 0; b < 3; ++b)
        for (int k = 0; k < 6; ++k) {
            gw_ray ray = {.origin = {0.1f, 0.2f, -0.1f}, .direction = {0.3f, 0.5f, 0.7f}, .maximum = 100.0f};
            if (k < 3)
                ray.origin[k] = bad[b];
            else
                ray.direction[k - 3] = bad[b];
            odd[count++] = ray;
        }
    odd[count++] = (gw_ray){.origin = {0.1f, 0.2f, -0.1f}, .maximum = 100.0f};
    odd[count++] =
        (gw_ray){.origin = {0.1f, 0.2f, -0.1f}, .direction = {-0.0f, 0.0f, -0.0f}, .maximum = 100.0f};
    for (int method = 0; method < 2; ++method) {
        gw_hit *hits = trace(renderer, (gw_trace_method)method, odd, count, NULL);
        for (size_t i = 0; i < count; ++i) {
            assert_int_equal(hits[i].triangle, GW_NO_TRIANGLE);
            assert_true(hits[i].t == 100.0f);
        }
        free(hits);
    }
}

static void distances_scale_exactly_with_the_direction(void **state) {
    (void)state;
    static const int exponents[] = {-60, -1, 7, 60};
    gw_hit *plain = trace(renderer, GW_TRACE_OCTREE, rays, 2000, NULL);
    gw_ray *scaled = calloc(2000, sizeof *scaled);
    assert_non_null(scaled);
    for (size_t e = 0; e < 4; ++e) {
        for (size_t i = 0; i < 2000; ++i) {
            scaled[i] = rays[i];
            for (int k = 0; k < 3; ++k) {
                /* What would become subnormal is left out, it does not scale exactly. */
                float d = fabsf(rays[i].direction[k]) < 1e-18f ? 0.0f : rays[i].direction[k];
                scaled[i].direction[k] = ldexpf(d, exponents[e]);
            }
        }
        gw_hit *hits = trace(renderer, GW_TRACE_OCTREE, scaled, 2000, NULL);
        for (size_t i = 0; i < 2000; ++i) {
            if (i / 4 % 7 == 3 || i / 4 % 7 == 4 || i / 4 % 7 == 6)
                continue; /* directions that hold tiny components */
            assert_int_equal(hits[i].triangle, plain[i].triangle);
            if (hits[i].triangle != GW_NO_TRIANGLE)
                assert_true(hits[i].t == ldexpf(plain[i].t, -exponents[e]));
        }
        free(hits);
    }
    free(scaled);
    free(plain);
}

static void only_hits_between_minimum_and_maximum_count(void **state) {
    (void)state;
    gw_hit *first = trace(renderer, GW_TRACE_OCTREE, rays, 400, NULL);
    gw_ray *behind = calloc(400, sizeof *behind);
    assert_non_null(behind);
    for (size_t i = 0; i < 400; ++i) {
        behind[i] = rays[i];
        behind[i].minimum = first[i].triangle == GW_NO_TRIANGLE ? 0.0f : first[i].t;
    }
    gw_hit *second = trace(renderer, GW_TRACE_OCTREE, behind, 400, NULL);
    gw_hit *brute = trace(renderer, GW_TRACE_BRUTE_FORCE, behind, 400, NULL);
    expect_same(brute, second, 400);
    for (size_t i = 0; i < 400; ++i)
        assert_true(second[i].triangle == GW_NO_TRIANGLE || second[i].t > first[i].t);
    for (size_t i = 0; i < 400; ++i) {
        behind[i].minimum = 0.0f;
        behind[i].maximum = first[i].triangle == GW_NO_TRIANGLE ? 1.0f : 0.5f * first[i].t;
    }
    gw_hit *none = trace(renderer, GW_TRACE_OCTREE, behind, 400, NULL);
    for (size_t i = 0; i < 400; ++i)
        if (first[i].triangle != GW_NO_TRIANGLE)
            assert_int_equal(none[i].triangle, GW_NO_TRIANGLE);
    free(behind);
    free(first);
    free(second);
    free(brute);
    free(none);
}

/* Segments for shadows: between random points, and hard rays that end just before, at, or just behind their
 * nearest hit, or a hit further on. */
static gw_ray *make_segments(void) {
    gw_ray *segments = calloc(ray_count, sizeof *segments);
    gw_hit *nearest = trace(renderer, GW_TRACE_BRUTE_FORCE, rays, ray_count, NULL);
    uint64_t random = SEED + 7;
    assert_non_null(segments);
    for (size_t i = 0; i < ray_count; ++i) {
        float t = nearest[i].t;
        const float ends[] = {nextafterf(t, 0.0f), t, nextafterf(t, INFINITY), 3.0f * t};
        segments[i] = rays[i];
        if (i % 2 == 0 && nearest[i].triangle != GW_NO_TRIANGLE) {
            segments[i].maximum = ends[i / 2 % 4];
            continue;
        }
        for (int k = 0; k < 3; ++k)
            segments[i].direction[k] = (float)(1.8 * gw_test_random(&random) - 0.9) - segments[i].origin[k];
        segments[i].minimum = (float)(0.3 * gw_test_random(&random));
        segments[i].maximum = 1.0f;
    }
    free(nearest);
    return segments;
}

static void expect_met(const gw_ray *segments, const gw_hit *nearest, const gw_hit *any) {
    for (size_t i = 0; i < ray_count; ++i) {
        int met = any[i].triangle != GW_NO_TRIANGLE;
        if (met != (nearest[i].triangle != GW_NO_TRIANGLE) || (met && !(any[i].t >= nearest[i].t)) ||
            (met && !(any[i].t > segments[i].minimum && any[i].t <= segments[i].maximum)))
            fail_msg("segment %zu: any hit is %u at %a, the nearest %u at %a", i, any[i].triangle,
                     (double)any[i].t, nearest[i].triangle, (double)nearest[i].t);
    }
}

static void any_hit_is_found_where_there_is_one(void **state) {
    (void)state;
    gw_renderer *counting = NULL, *pieces = NULL;
    gw_renderer_options count = {.count = 1}, forced = {.loop_budget = 32, .force_features = GW_ALL_FEATURES};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &count, &counting, &error));
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &forced, &pieces, &error));
    gw_ray *segments = make_segments();
    gw_counters any_work = {0}, nearest_work = {0}, pieces_work = {0};
    gw_hit *brute = trace(renderer, GW_TRACE_BRUTE_FORCE, segments, ray_count, NULL);
    gw_hit *nearest = trace(counting, GW_TRACE_OCTREE, segments, ray_count, &nearest_work);
    gw_hit *any = trace(counting, GW_TRACE_ANY, segments, ray_count, &any_work);
    gw_hit *resumed = trace(pieces, GW_TRACE_ANY, segments, ray_count, &pieces_work);
    expect_met(segments, brute, any);
    assert_memory_equal(any, resumed, ray_count * sizeof *any);
    size_t met = 0, other = 0;
    for (size_t i = 0; i < ray_count; ++i) {
        met += any[i].triangle != GW_NO_TRIANGLE;
        other += any[i].triangle != nearest[i].triangle;
    }
    print_message("%zu of %zu segments meet something, %zu not the nearest; %llu tests instead of %llu\n",
                  met, ray_count, other, (unsigned long long)any_work.triangle_tests,
                  (unsigned long long)nearest_work.triangle_tests);
    assert_true(met > ray_count / 4 && met < ray_count * 3 / 4 && other > 0);
    assert_true(any_work.triangle_tests < nearest_work.triangle_tests && any_work.steps < nearest_work.steps);
    assert_int_equal(any_work.step_cap_hits, 0);
    assert_true(pieces_work.resumed > ray_count / 10);
    gw_hit *freed[] = {brute, nearest, any, resumed};
    for (size_t i = 0; i < 4; ++i)
        free(freed[i]);
    free(segments);
    gw_renderer_destroy(&counting);
    gw_renderer_destroy(&pieces);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_octree_answers_as_brute_force),
        cmocka_unit_test(suspended_rays_go_on_as_if_nothing_had_happened),
        cmocka_unit_test(wide_node_words_change_nothing),
        cmocka_unit_test(rays_that_are_not_numbers_miss),
        cmocka_unit_test(distances_scale_exactly_with_the_direction),
        cmocka_unit_test(only_hits_between_minimum_and_maximum_count),
        cmocka_unit_test(any_hit_is_found_where_there_is_one),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
