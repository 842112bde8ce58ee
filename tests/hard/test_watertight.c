/* Rays from inside a closed surface, aimed at its vertices and edges, never pass, whatever the surface is
 * made of: bumps, fans of a thousand triangles about one vertex, slivers a millionth as wide as long. Rays
 * from outside that enter leave again. Naive tests, run over the same rays by the same traversal, do let some
 * through: the rays are hard enough to tell. */
#include "tests/support/device.h"

#include "tests/support/cases.h"
#include "tests/support/meshes.h"

#include <math.h>

enum { ON_EDGE = 3, SEED = 7 };

static const double origin[3] = {0, 0, 0};

static gw_scene *bumpy_ball(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, origin, 1.0, 0.15, 48, 30);
    return gw_mesh_take(&mesh);
}

static gw_scene *ball(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, origin, 1.0, 0, 24, 24);
    return gw_mesh_take(&mesh);
}

static gw_scene *two_fans(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, origin, 1.0, 0, 1000, 2);
    return gw_mesh_take(&mesh);
}

/* A ball whose meridians and circles of latitude come in pairs, a millionth apart: slivers and specks between
 * large triangles, all of them closed. */
static gw_scene *ball_of_slivers(void) {
    enum { AROUND = 28, RINGS = 18 };
    const double pi = 3.14159265358979323846, apart = 1e-6;
    gw_mesh mesh = {0};
    uint32_t points[RINGS][AROUND], top = gw_mesh_point(&mesh, 0, 1, 0);
    for (int ring = 0; ring < RINGS; ++ring)
        for (int i = 0; i < AROUND; ++i) {
            double a = 4 * pi * (i / 2) / AROUND + i % 2 * apart;
            double b = 2 * pi * (ring / 2 + 1) / (RINGS + 2) + ring % 2 * apart;
            points[ring][i] = gw_mesh_point(&mesh, sin(b) * cos(a), cos(b), sin(b) * sin(a));
        }
    uint32_t bottom = gw_mesh_point(&mesh, 0, -1, 0);
    for (int i = 0; i < AROUND; ++i) {
        int next = (i + 1) % AROUND;
        gw_mesh_triangle(&mesh, top, points[0][next], points[0][i]);
        for (int ring = 0; ring + 1 < RINGS; ++ring) {
            gw_mesh_triangle(&mesh, points[ring][i], points[ring][next], points[ring + 1][i]);
            gw_mesh_triangle(&mesh, points[ring][next], points[ring + 1][next], points[ring + 1][i]);
        }
        gw_mesh_triangle(&mesh, points[RINGS - 1][i], points[RINGS - 1][next], bottom);
    }
    return gw_mesh_take(&mesh);
}

static void no_ray_leaves_through(gw_scene *scene, const char *name) {
    gw_case c;
    gw_case_open(&c, device, scene, 8);
    double middle[3];
    gw_case_rebase(c.scene, origin, middle);
    size_t count;
    gw_ray *rays = gw_aim_at_features(c.scene, middle, 0.2, ON_EDGE, SEED, &count);
    for (int r = 0; r < GW_SOUND_RUNGS; ++r) {
        size_t misses = gw_case_misses(&c, gw_sound_rungs[r].defines, rays, count);
        print_message("%s, %s: %zu rays at vertices and edges, %zu misses\n", name, gw_sound_rungs[r].name,
                      count, misses);
        assert_int_equal(misses, 0);
    }
    free(rays);
    gw_case_close(&c);
}

static void bumps_hold(void **state) {
    (void)state;
    no_ray_leaves_through(bumpy_ball(), "bumpy ball");
}

static void fans_of_a_thousand_hold(void **state) {
    (void)state;
    no_ray_leaves_through(two_fans(), "two fans");
}

static void slivers_hold(void **state) {
    (void)state;
    no_ray_leaves_through(ball_of_slivers(), "ball of slivers");
}

/* They hit where they were aimed: t is about 1. */
static void rays_end_where_they_were_aimed(void **state) {
    (void)state;
    gw_case c;
    gw_case_open(&c, device, ball(), 6);
    size_t count;
    gw_ray *rays = gw_aim_at_features(c.scene, origin, 0.2, ON_EDGE, SEED, &count);
    gw_hit *hits = gw_case_trace(&c, NULL, rays, count);
    for (size_t i = 0; i < count; ++i)
        assert_true(fabsf(hits[i].t - 1.0f) < 0.01f);
    free(hits);
    free(rays);
    gw_case_close(&c);
}

/* From outside, at the vertices and edges of a convex surface: what enters leaves again. */
static gw_ray *rays_from_outside(const gw_scene *scene, size_t *count) {
    gw_ray *rays = gw_aim_at_features(scene, origin, 1.0, ON_EDGE, SEED + 1, count);
    for (size_t i = 0; i < *count; ++i) {
        double length = 0, at[3];
        for (int k = 0; k < 3; ++k)
            length = hypot(length, (double)rays[i].origin[k]);
        for (int k = 0; k < 3; ++k) {
            at[k] = (double)rays[i].origin[k] + (double)rays[i].direction[k];
            rays[i].origin[k] = (float)(3.0 / length * (double)rays[i].origin[k]);
            rays[i].direction[k] = (float)(at[k] - (double)rays[i].origin[k]);
        }
    }
    return rays;
}

static void what_enters_leaves_again(void **state) {
    (void)state;
    size_t fast = 0, normal = 0, all = 0;
    for (int which = 0; which < 2; ++which) {
        gw_case c;
        gw_case_open(&c, device, which ? ball_of_slivers() : ball(), 6);
        size_t count;
        gw_ray *rays = rays_from_outside(c.scene, &count);
        for (int r = 0; r < GW_SOUND_RUNGS; ++r)
            assert_int_equal(gw_case_odd(&c, gw_sound_rungs[r].defines, rays, count), 0);
        fast += gw_case_odd(&c, "#define FAST_TRIANGLES 1\n", rays, count);
        normal += gw_case_odd(&c, "#define FACING_BY_NORMAL 1\n", rays, count);
        all += count;
        free(rays);
        gw_case_close(&c);
    }
    print_message("%zu rays from outside: 0 enter without leaving; Moeller-Trumbore: %zu, facing told by the "
                  "normal: %zu\n",
                  all, fast, normal);
    assert_true(fast > 0 && normal > 0);
}

static void naive_tests_let_rays_through(void **state) {
    (void)state;
    static const gw_rung naive[] = {{"Moeller-Trumbore", "#define FAST_TRIANGLES 1\n"},
                                    {"without precise", "#define CONTRACTED_PRECISE 1\n"}};
    gw_case c;
    gw_case_open(&c, device, bumpy_ball(), 8);
    double middle[3];
    gw_case_rebase(c.scene, origin, middle);
    size_t count;
    gw_ray *rays = gw_aim_at_features(c.scene, middle, 0.2, ON_EDGE, SEED, &count);
    for (int i = 0; i < 2; ++i) {
        size_t misses = gw_case_misses(&c, naive[i].defines, rays, count);
        print_message("%s: %zu of %zu miss\n", naive[i].name, misses, count);
        assert_true(misses > 0);
    }
    free(rays);
    gw_case_close(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bumps_hold),
        cmocka_unit_test(fans_of_a_thousand_hold),
        cmocka_unit_test(slivers_hold),
        cmocka_unit_test(rays_end_where_they_were_aimed),
        cmocka_unit_test(what_enters_leaves_again),
        cmocka_unit_test(naive_tests_let_rays_through),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
