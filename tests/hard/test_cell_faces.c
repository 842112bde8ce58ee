/* Triangles in the planes of cells, at every level and one ulp beside them, and rays in those planes, along
 * edges and through corners of cells, with components that are zero, negative zero or subnormal, from places
 * on faces and a million roots away. Each is met as brute force meets it, to the bit, and never wrongly in
 * double precision. The naive rule, that a hit counts only in the cell whose list is tested, loses hits in
 * cell faces. */
#include "tests/support/device.h"

#include "tests/support/cases.h"
#include "tests/support/double_hits.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { DEPTH = 8, SEED = 23, RANDOM_RAYS = 1500 };
/* Roots: up to there every hit is brute force's. A scene as far as that is a twentieth of a pixel wide. */
static const double farthest = 65536;

typedef struct ray_list {
    gw_ray *rays;
    size_t count, capacity;
} ray_list;

static void add_ray(ray_list *list, const float origin[3], const float direction[3]) {
    if (list->count == list->capacity) {
        list->capacity = list->capacity ? 2 * list->capacity : 1024;
        list->rays = realloc(list->rays, list->capacity * sizeof *list->rays);
        assert_non_null(list->rays);
    }
    gw_ray *ray = &list->rays[list->count++];
    *ray = (gw_ray){.maximum = INFINITY};
    for (int k = 0; k < 3; ++k) {
        ray->origin[k] = origin[k];
        ray->direction[k] = direction[k];
    }
}

/* The plane of a quad: the odd multiple of 2^-level that is nearest to this place, or a float beside it. */
static double plane_of(int level, int beside) {
    float plane = ldexpf(2.0f * floorf(ldexpf(0.3f, level - 1)) + 1.0f, -level);
    return (double)(beside < 0 ? nextafterf(plane, -1.0f) : beside > 0 ? nextafterf(plane, 1.0f) : plane);
}

/* Quads across every axis in planes of every level, between corners of cells; the root's own faces, too. */
static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    for (int side = -1; side <= 1; side += 2)
        gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, side, side, side),
                         gw_mesh_point(&mesh, side * 0.5, side, side),
                         gw_mesh_point(&mesh, side, side * 0.5, side));
    for (int axis = 0; axis < 3; ++axis)
        for (int level = 1; level < DEPTH; ++level)
            for (int beside = -1; beside <= 1; ++beside) {
                double corner[3], u[3] = {0}, v[3] = {0};
                corner[axis] = plane_of(level, beside) * (level % 2 ? 1 : -1);
                corner[(axis + 1) % 3] = -0.875 + level * 0.125;
                corner[(axis + 2) % 3] = -0.75 + 0.5 * beside;
                u[(axis + 1) % 3] = v[(axis + 2) % 3] = 0.25;
                gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
            }
    return gw_mesh_take(&mesh);
}

static const float *corner_of(const gw_scene *scene, uint32_t triangle, uint32_t k) {
    return scene->positions + (size_t)scene->triangles[triangle][k] * 3;
}

/* Six axis-parallel rays to each place, from outside, from a cell face beside it and from the place itself;
 * the other components as small as they come. */
static void add_parallel_rays(ray_list *list, const float place[3]) {
    static const float least[] = {0.0f, -0.0f, 1e-38f, -1e-45f};
    for (int way = 0; way < 6; ++way)
        for (int from = 0; from < 3; ++from) {
            float origin[3] = {place[0], place[1], place[2]}, direction[3];
            int axis = way / 2;
            float sign = way % 2 ? 1.0f : -1.0f;
            for (int k = 0; k < 3; ++k)
                direction[k] = k == axis ? sign : least[(way + from + k) % 4];
            origin[axis] = from == 0   ? -3.0f * sign
                           : from == 1 ? ldexpf(roundf(16 * place[axis]) - sign, -4)
                                       : place[axis];
            add_ray(list, origin, direction);
        }
}

static ray_list make_rays(const gw_scene *scene) {
    ray_list list = {0};
    uint64_t random = SEED;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        float middle[3], edge[3];
        for (int k = 0; k < 3; ++k) {
            edge[k] = 0.5f * (corner_of(scene, t, 0)[k] + corner_of(scene, t, 1)[k]);
            middle[k] =
                (corner_of(scene, t, 0)[k] + corner_of(scene, t, 1)[k] + corner_of(scene, t, 2)[k]) / 3.0f;
        }
        add_parallel_rays(&list, corner_of(scene, t, 0));
        add_parallel_rays(&list, edge);
        add_parallel_rays(&list, middle);
    }
    /* Diagonals of cells, from corner to corner. */
    for (int i = 0; i < 400; ++i) {
        float origin[3], direction[3];
        for (int k = 0; k < 3; ++k) {
            origin[k] = ldexpf(floorf((float)(64 * gw_test_random(&random)) - 32), -5);
            direction[k] = gw_test_random(&random) < 0.5 ? -1.0f : 1.0f;
            if (i % 3 == 0 && k == i % 9 / 3)
                direction[k] = i % 2 ? 0.0f : -0.0f;
        }
        add_ray(&list, origin, direction);
    }
    /* Grazing, and aimed from afar. */
    for (int i = 0; i < RANDOM_RAYS; ++i) {
        uint32_t t = (uint32_t)(gw_test_random(&random) * scene->triangle_count);
        const float *at = corner_of(scene, t, (uint32_t)i % 3);
        double away = i % 5 == 0 ? farthest : pow(10, -3 + 3 * gw_test_random(&random));
        float origin[3], direction[3];
        for (int k = 0; k < 3; ++k) {
            double beside = 2 * gw_test_random(&random) - 1;
            beside *= i % 3 == k ? pow(10, -3 - 4 * gw_test_random(&random)) : 1; /* nearly in the plane */
            origin[k] = (float)((double)at[k] + away * beside);
            direction[k] = at[k] - origin[k];
        }
        add_ray(&list, origin, direction);
    }
    return list;
}

static size_t unlike(const gw_hit *a, const gw_hit *b, size_t count) {
    size_t different = 0;
    for (size_t i = 0; i < count; ++i)
        different += memcmp(&a[i], &b[i], sizeof *a) != 0;
    return different;
}

static void check_in_double(const gw_case *c, const ray_list *list, const gw_hit *hits) {
    size_t wrong = 0, hit = 0;
    for (size_t i = 0; i < list->count; ++i) {
        hit += hits[i].triangle != GW_NO_TRIANGLE;
        assert_true(hits[i].t >= 0);
        if (gw_double_judge(c->scene, &list->rays[i], &hits[i]).verdict == GW_DOUBLE_WRONG) {
            const gw_ray *r = &list->rays[i];
            if (wrong++ < 5)
                print_message("from %a %a %a along %a %a %a: triangle %u at %a\n", (double)r->origin[0],
                              (double)r->origin[1], (double)r->origin[2], (double)r->direction[0],
                              (double)r->direction[1], (double)r->direction[2], hits[i].triangle,
                              (double)hits[i].t);
        }
    }
    print_message("%zu rays in and at faces of cells, %zu hits, %zu wrong in double\n", list->count, hit,
                  wrong);
    assert_true(hit > list->count / 4);
    assert_int_equal(wrong, 0);
}

static void faces_of_cells_are_met(void **state) {
    (void)state;
    gw_case c;
    gw_case_open(&c, device, make_scene(), DEPTH);
    ray_list list = make_rays(c.scene);
    gw_hit *brute = gw_case_brute(&c, list.rays, list.count);
    for (int r = 0; r < 2;
         ++r) { /* shipped, and contracted: the triangle test is the same, so must the hits be */
        gw_hit *hits = gw_case_trace(&c, gw_sound_rungs[r].defines, list.rays, list.count);
        assert_int_equal(unlike(brute, hits, list.count), 0);
        free(hits);
    }
    check_in_double(&c, &list, brute);
    free(brute);
    free(list.rays);
    gw_case_close(&c);
}

/* Triangles only in the cells that they touch to the last bit, hits only in the cell that is tested. */
static void naive_faces_lose_hits(void **state) {
    (void)state;
    char folder[512];
    gw_gl *naive_device = NULL;
    gw_gl_options options = {
        .shader_folder = gw_naive_shaders(folder, "bare", "build/triangle_box.glsl", "BOXES_AS_THEY_ARE")};
    check_ok(gw_gl_create(&options, &naive_device, &error));
    gw_case c;
    gw_case_open(&c, naive_device, make_scene(), DEPTH);
    ray_list list = make_rays(c.scene);
    gw_hit *brute = gw_case_brute(&c, list.rays, list.count);
    gw_hit *bare = gw_case_trace(&c, NULL, list.rays, list.count);
    gw_hit *within = gw_case_trace(&c, "#define HITS_WITHIN_CELLS 1\n", list.rays, list.count);
    size_t lost_bare = unlike(brute, bare, list.count), lost_within = unlike(brute, within, list.count);
    print_message("boxes that are not widened: %zu of %zu rays find another hit or none; and hits only "
                  "within the cell that is "
                  "tested: %zu\n",
                  lost_bare, list.count, lost_within);
    assert_true(lost_bare > 0 || lost_within > 0);
    free(within);
    free(bare);
    free(brute);
    free(list.rays);
    gw_case_close(&c);
    gw_gl_destroy(&naive_device);
}

/* Every step leaves a cell: a ray takes no more of them than there are cells along it, in planes of cells,
 * too. */
static void steps_are_bounded(void **state) {
    (void)state;
    gw_case c;
    gw_case_open(&c, device, make_scene(), DEPTH);
    ray_list list = make_rays(c.scene);
    gw_hit *hits = calloc(list.count, sizeof *hits);
    assert_non_null(hits);
    for (size_t i = 0; i < list.count; i += 97) {
        gw_counters counters = {0};
        gw_trace_time time = {0};
        check_ok(gw_renderer_trace_variant(c.renderer, &(gw_trace_variant){.count = 1}, &list.rays[i], 1,
                                           hits, &counters, &time, &error));
        /* Down to a cell and on: once for each of 3 * 2^depth planes, and down again from the root. */
        assert_true(counters.steps <= 2 * 3 * (1u << DEPTH) + DEPTH);
        assert_int_equal(counters.step_cap_hits, 0);
    }
    free(hits);
    free(list.rays);
    gw_case_close(&c);
}

/* At a ball, well inside its outline, from so far: rays that find nothing; other is how many find not what
 * brute force does. */
static size_t count_lost(const gw_case *c, double away, size_t count, size_t *other) {
    gw_ray *rays = calloc(count, sizeof *rays);
    assert_non_null(rays);
    uint64_t random = SEED;
    for (size_t i = 0; i < count; ++i) {
        double from[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            from[k] = gw_test_random(&random) - 0.5;
            length = hypot(length, from[k]);
        }
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = (float)(from[k] / length * away);
            rays[i].direction[k] = (float)(0.5 * (gw_test_random(&random) - 0.5)) - rays[i].origin[k];
        }
        rays[i].maximum = INFINITY;
    }
    gw_hit *hits = gw_case_trace(c, NULL, rays, count), *brute = gw_case_brute(c, rays, count);
    size_t lost = 0;
    *other = unlike(hits, brute, count);
    for (size_t i = 0; i < count; ++i) {
        lost += hits[i].triangle == GW_NO_TRIANGLE;
        assert_true(i >= 1000 || gw_double_judge(c->scene, &rays[i], &hits[i]).verdict != GW_DOUBLE_WRONG);
    }
    if (away <= farthest)
        assert_int_equal(gw_case_odd(c, NULL, rays, count), 0);
    free(brute);
    free(hits);
    free(rays);
    return lost;
}

/* A float's direction at a million roots is a sixteenth of the root wide: there hits are what float can tell,
 * and no longer what brute force makes of it. */
static void far_rays_meet_what_they_should(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 1.0, 0, 24, 12);
    gw_case c;
    gw_case_open(&c, device, gw_mesh_take(&mesh), 6);
    for (double away = 16; away <= 1e6; away *= 16) {
        size_t other, lost = count_lost(&c, away, 6000, &other);
        print_message("%g roots away: %zu of 6000 rays lost, %zu unlike brute force\n", away, lost, other);
        if (away <= farthest)
            assert_true(lost == 0 && other == 0);
    }
    size_t other, lost = count_lost(&c, 1e6, 6000, &other);
    print_message("1e6 roots away: %zu of 6000 rays lost, %zu unlike brute force\n", lost, other);
    assert_true(lost < 6000 / 200);
    gw_case_close(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_of_cells_are_met), cmocka_unit_test(steps_are_bounded),
        cmocka_unit_test(far_rays_meet_what_they_should),
        cmocka_unit_test(naive_faces_lose_hits), /* last: it has a device of its own */
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
