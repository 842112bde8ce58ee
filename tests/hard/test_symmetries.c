/* The same surface moved, scaled, turned and mirrored: no ray passes in any of them, and a scale by
 * a power of two changes no bit. */
#include "tests/support/device.h"

#include "tests/support/cases.h"
#include "tests/support/meshes.h"

#include <math.h>

enum { AROUND = 18, RINGS = 12, ON_EDGE = 2, SEED = 11, DEPTH = 6 };

/* Axis k of the copy is axis of[k] of the original, times sign[k]. */
typedef struct symmetry {
    int of[3];
    double sign[3];
} symmetry;

static symmetry symmetry_of(int number) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    symmetry s;
    for (int k = 0; k < 3; ++k) {
        s.of[k] = orders[number / 8][k];
        s.sign[k] = number >> k & 1 ? -1 : 1;
    }
    return s;
}

/* A bumpy ball within [-1,1]^3, which two tetrahedra in opposite corners span. */
static void add_ball(gw_mesh *mesh) {
    const double origin[3] = {0, 0, 0};
    gw_mesh_add_sphere(mesh, origin, 0.7, 0.12, AROUND, RINGS);
    for (int side = -1; side <= 1; side += 2)
        gw_mesh_triangle(mesh, gw_mesh_point(mesh, side, side, side),
                         gw_mesh_point(mesh, side, side, side * 0.99),
                         gw_mesh_point(mesh, side, side * 0.99, side));
}

static gw_scene *turned_ball(const symmetry *s) {
    gw_mesh mesh = {0};
    add_ball(&mesh);
    for (size_t i = 0; i < mesh.point_count; ++i) {
        double *p = mesh.points + i * 3, old[3];
        memcpy(old, p, sizeof old);
        for (int k = 0; k < 3; ++k)
            p[k] = s->sign[k] * old[s->of[k]];
    }
    return gw_mesh_take(&mesh);
}

static gw_ray *turned_rays(const gw_ray *rays, size_t count, const symmetry *s) {
    gw_ray *out = calloc(count, sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < count; ++i) {
        out[i] = rays[i];
        for (int k = 0; k < 3; ++k) {
            out[i].origin[k] = (float)s->sign[k] * rays[i].origin[s->of[k]];
            out[i].direction[k] = (float)s->sign[k] * rays[i].direction[s->of[k]];
        }
    }
    return out;
}

/* Of two distances, in units of the last place of the first. */
static double ulps_apart(float a, float b) {
    return fabs((double)a - (double)b) / ((double)nextafterf(a, INFINITY) - (double)a);
}

/* Hits of the rays on the ball turned so. */
static gw_hit *turned_hits(const gw_ray *rays, size_t count, int number) {
    const symmetry s = symmetry_of(number);
    gw_case c;
    gw_case_open(&c, device, turned_ball(&s), DEPTH);
    gw_ray *turned = turned_rays(rays, count, &s);
    gw_hit *hits = gw_case_trace(&c, number % 2 ? "#define CONTRACTED 1\n" : NULL, turned, count);
    free(turned);
    gw_case_close(&c);
    return hits;
}

static void all_48_symmetries_hold(void **state) {
    (void)state;
    const double middle[3] = {0, 0, 0};
    const symmetry none = symmetry_of(0);
    gw_scene *ball = turned_ball(&none);
    size_t count = 0;
    gw_ray *rays = gw_aim_at_features(ball, middle, 0.2, ON_EDGE, SEED, &count);
    gw_hit *wanted = turned_hits(rays, count, 0);
    double most = 0;
    for (int number = 0; number < 48; ++number) {
        gw_hit *hits = turned_hits(rays, count, number);
        for (size_t i = 0; i < count; ++i) {
            assert_true(hits[i].triangle != GW_NO_TRIANGLE);
            /* Triangles start with another corner, and sums of three are taken in another order. */
            most = fmax(most, ulps_apart(wanted[i].t, hits[i].t));
        }
        free(hits);
    }
    print_message("48 symmetries of %zu rays at vertices and edges: 0 misses, distances within %.1f ulp\n",
                  count, most);
    assert_true(most <= 16);
    free(wanted);
    free(rays);
    gw_scene_destroy(&ball);
}

/* A scale by a power of two is nothing but an exponent: the scene that is traced is the same to the bit. */
static void powers_of_two_change_no_bit(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    add_ball(&mesh);
    gw_scene *plain = NULL;
    check_ok(gw_mesh_scene(&mesh, &plain, &error));
    for (int k = -60; k <= 60; k += 12) {
        gw_mesh scaled = {0};
        add_ball(&scaled);
        for (size_t i = 0; i < scaled.point_count * 3; ++i)
            scaled.points[i] = ldexp(scaled.points[i], k);
        gw_scene *scene = gw_mesh_take(&scaled);
        assert_int_equal(scene->exponent, plain->exponent + k);
        assert_int_equal(scene->vertex_count, plain->vertex_count);
        assert_int_equal(scene->triangle_count, plain->triangle_count);
        assert_memory_equal(scene->positions, plain->positions, plain->vertex_count * 3 * sizeof(float));
        assert_memory_equal(scene->triangles, plain->triangles,
                            plain->triangle_count * sizeof *plain->triangles);
        gw_scene_destroy(&scene);
    }
    gw_scene_destroy(&plain);
    gw_mesh_finish(&mesh);
}

/* Far from the origin: a model of a kilometre whose corners a file keeps as floats, and one of a metre as
 * doubles. What the file rounds is rounded; what is closed in the file stays closed. */
static void far_places_hold(void **state) {
    (void)state;
    static const double places[][3] = {{1e6, 1e6, 1e6}, {148376, 1234, -223423}, {-1e5, 3e3, 1e3}};
    size_t naive = 0;
    for (int i = 0; i < 6; ++i) {
        const double *place = places[i / 2], size = i % 2 ? 1.0 : 1000.0;
        gw_mesh mesh = {0};
        add_ball(&mesh);
        for (size_t v = 0; v < mesh.point_count; ++v)
            for (int k = 0; k < 3; ++k) {
                double p = size * mesh.points[v * 3 + (size_t)k] + place[k];
                mesh.points[v * 3 + (size_t)k] = i % 2 ? p : (double)(float)p;
            }
        gw_case c;
        gw_case_open(&c, device, gw_mesh_take(&mesh), DEPTH);
        double middle[3];
        gw_case_rebase(c.scene, place, middle);
        size_t count;
        gw_ray *rays = gw_aim_at_features(c.scene, middle, 0.2, ON_EDGE, SEED, &count);
        assert_int_equal(gw_case_misses(&c, NULL, rays, count), 0);
        assert_int_equal(gw_case_misses(&c, "#define CONTRACTED 1\n", rays, count), 0);
        naive += gw_case_misses(&c, "#define FAST_TRIANGLES 1\n", rays, count);
        free(rays);
        gw_case_close(&c);
    }
    print_message("six far places: 0 misses; Moeller-Trumbore: %zu\n", naive);
    assert_true(naive > 0);
}

/* What happens without rebasing: at a million, floats cannot hold a metre's triangles. */
static void floats_alone_lose_the_shape(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    add_ball(&mesh);
    size_t moved = 0;
    for (size_t i = 0; i < mesh.point_count * 3; ++i)
        moved += fabs((double)((float)(mesh.points[i] + 1e6) - 1e6f) - mesh.points[i]) > 1e-3;
    print_message("floats about the origin: %zu of %zu coordinates off by more than a millimetre\n", moved,
                  mesh.point_count * 3);
    assert_true(moved > mesh.point_count);
    gw_mesh_finish(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_48_symmetries_hold),
        cmocka_unit_test(powers_of_two_change_no_bit),
        cmocka_unit_test(far_places_hold),
        cmocka_unit_test(floats_alone_lose_the_shape),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
