/* What no modeller draws and every file holds: no numbers, points as triangles, runaway vertices, copies,
 * sheets a float apart, one triangle over everything. */
#include "tests/support/device.h"

#include "tests/support/cases.h"
#include "tests/support/meshes.h"

#include <math.h>

/* A ball, and about it what must be dropped, if asked for: returns how many triangles that is. */
static size_t add_ball(gw_mesh *mesh, int with_rubbish) {
    const double origin[3] = {0, 0, 0};
    gw_mesh_add_sphere(mesh, origin, 1.0, 0.1, 16, 10);
    if (!with_rubbish)
        return 0;
    const double bad[][3] = {{NAN, 0, 0}, {0, INFINITY, 0}, {0, 0, -INFINITY}, {1e30, 0, 0}, {0, -1e30, 0}};
    size_t before = mesh->triangle_count;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        gw_mesh_triangle(mesh, (uint32_t)i, (uint32_t)i + 1,
                         gw_mesh_point(mesh, bad[i][0], bad[i][1], bad[i][2]));
    gw_mesh_triangle(mesh, 3, 3, 7);
    gw_mesh_triangle(mesh, gw_mesh_point(mesh, 0.1, 0.1, 0.1), gw_mesh_point(mesh, 0.2, 0.2, 0.2),
                     gw_mesh_point(mesh, 0.4, 0.4, 0.4));
    gw_mesh_triangle(mesh, gw_mesh_point(mesh, 0.3, 0, 0), gw_mesh_point(mesh, 0.3, 0, 0),
                     gw_mesh_point(mesh, 0.5, 0, 0));
    for (int i = 0; i < 10000; ++i) /* copies */
        gw_mesh_triangle(mesh, mesh->triangles[20][1], mesh->triangles[20][2], mesh->triangles[20][0]);
    return mesh->triangle_count - before;
}

static void the_rest_is_as_if_rubbish_had_not_been(void **state) {
    (void)state;
    gw_mesh clean = {0}, dirty = {0};
    add_ball(&clean, 0);
    size_t rubbish = add_ball(&dirty, 1);
    gw_settings settings;
    gw_settings_init(&settings);
    gw_scene *a = gw_mesh_take(&clean), *naive = NULL, *b = NULL;
    check_ok(gw_mesh_scene(&dirty, &naive, &error)); /* without looking for outliers */
    print_message("a runaway vertex that is kept: %llu triangles collapse, %u are left\n",
                  (unsigned long long)naive->dropped.collapsed, naive->triangle_count);
    assert_true(naive->triangle_count < 10);
    gw_scene_destroy(&naive);
    check_ok(gw_mesh_scene_without(&dirty, settings.outlier_extents, &b, &error));
    gw_mesh_finish(&dirty);
    assert_int_equal(gw_dropped_total(&b->dropped), rubbish);
    assert_int_equal(b->dropped.non_finite, 3);
    assert_int_equal(b->dropped.outlier, 2);
    assert_int_equal(b->dropped.duplicate, 10000);
    assert_int_equal(b->dropped.repeated_vertex + b->dropped.zero_area, 3);
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_int_equal(a->exponent, b->exponent);
    assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof(float));
    assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
    gw_scene_destroy(&a);
    gw_scene_destroy(&b);
}

/* Pairs of large sheets so many floats apart, tilted or not, beside one another. */
enum { PAIRS = 16, RAYS_A_PAIR = 200 };
static int floats_apart(int pair) {
    return 1 << pair % 8;
}

static gw_scene *sheets(void) {
    gw_mesh mesh = {0};
    for (int i = 0; i < PAIRS; ++i) {
        double x = -1 + 2.0 * (i % 4) / 4, y = -1 + 2.0 * (i / 4) / 4, tilt = i >= 8 ? 0.3 : 0;
        for (int sheet = 0; sheet < 2; ++sheet) {
            float z = 0.37f;
            for (int n = 0; n < sheet * floats_apart(i); ++n)
                z = nextafterf(z, 1.0f);
            double corner[3] = {x + 0.02, y + 0.02, (double)z}, u[3] = {0.46, 0, tilt},
                   v[3] = {0, 0.46, tilt * 0.7};
            gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
        }
    }
    gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, -1, -1, -1), gw_mesh_point(&mesh, -1, -0.9, -1),
                     gw_mesh_point(&mesh, -0.9, -1, -1));
    gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, 1, 1, 1), gw_mesh_point(&mesh, 1, 0.9, 1),
                     gw_mesh_point(&mesh, 0.9, 1, 1));
    return gw_mesh_take(&mesh);
}

static double height_of(const gw_scene *scene, uint32_t triangle) {
    double least = INFINITY;
    for (int k = 0; k < 3; ++k)
        least = fmin(least, (double)scene->positions[(size_t)scene->triangles[triangle][k] * 3 + 2]);
    return least;
}

/* Rays that meet the lower sheet first, slanted, from below; how many name the upper one, of flat and of
 * tilted pairs. */
static void count_upper(const gw_case *c, const char *defines, size_t wrong[2]) {
    enum { COUNT = PAIRS * RAYS_A_PAIR };
    gw_ray *rays = calloc(COUNT, sizeof *rays);
    assert_non_null(rays);
    uint64_t random = 5;
    for (int i = 0; i < COUNT; ++i) {
        int pair = i / RAYS_A_PAIR;
        double place[3] = {-1 + 0.5 * (pair % 4) + 0.06 + 0.16 * gw_test_random(&random),
                           -1 + 0.5 * (pair / 4) + 0.06 + 0.16 * gw_test_random(&random), 0.4},
               at[3];
        gw_case_rebase(c->scene, place, at);
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = k == 2 ? -3.0f : (float)(at[k] + 0.5 * (gw_test_random(&random) - 0.5));
            rays[i].direction[k] = (float)at[k] - rays[i].origin[k];
        }
        rays[i].maximum = INFINITY;
    }
    gw_hit *hits = gw_case_trace(c, defines, rays, COUNT);
    wrong[0] = wrong[1] = 0;
    for (int i = 0; i < COUNT; ++i) {
        int pair = i / RAYS_A_PAIR;
        double lower = ldexp((double)0.37f - c->scene->centre[2], -c->scene->exponent);
        assert_true(hits[i].triangle != GW_NO_TRIANGLE);
        wrong[pair >= 8] += height_of(c->scene, hits[i].triangle) > lower;
    }
    free(hits);
    free(rays);
}

/* Flat sheets are told apart from one float on; tilted ones as far as the bound of the plane's t goes. t from
 * weighted depths, as the watertight test's paper has it, cannot tell either. */
static void the_nearer_of_two_sheets_is_met(void **state) {
    (void)state;
    gw_case c;
    gw_case_open(&c, device, sheets(), 6);
    size_t shipped[2], contracted[2], naive[2];
    count_upper(&c, NULL, shipped);
    count_upper(&c, "#define CONTRACTED 1\n", contracted);
    count_upper(&c, "#define WEIGHTED_DEPTHS 1\n", naive);
    print_message("of %d rays at flat pairs and as many at tilted ones the farther sheet is named by: "
                  "shipped %zu, %zu; t from "
                  "weighted depths %zu, %zu\n",
                  PAIRS / 2 * RAYS_A_PAIR, shipped[0], shipped[1], naive[0], naive[1]);
    assert_int_equal(shipped[0], 0);
    assert_memory_equal(shipped, contracted, sizeof shipped);
    assert_true(naive[0] > 0 && shipped[1] < naive[1]);
    gw_case_close(&c);
}

/* A triangle over everything is in few cells more than there are: cells are cut where small triangles are,
 * not where the large one is. */
static void one_triangle_over_all_is_cheap(void **state) {
    (void)state;
    enum { TINY = 20000 };
    uint32_t references[2];
    for (int large = 0; large < 2; ++large) {
        gw_mesh mesh = {0};
        uint64_t random = 9;
        for (int i = 0; i < TINY; ++i) {
            double p[3];
            for (int k = 0; k < 3; ++k)
                p[k] = 1.9 * (gw_test_random(&random) - 0.5);
            gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, p[0], p[1], p[2]),
                             gw_mesh_point(&mesh, p[0] + 1e-4, p[1], p[2]),
                             gw_mesh_point(&mesh, p[0], p[1] + 1e-4, p[2] + 1e-5));
        }
        gw_mesh_add_tetrahedron(&mesh, (const double[]){-0.95, -0.95, -0.95}, 0.02);
        gw_mesh_add_tetrahedron(&mesh, (const double[]){0.95, 0.95, 0.95}, 0.02);
        if (large)
            gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, -0.9, -0.9, -0.9),
                             gw_mesh_point(&mesh, 0.9, -0.9, 0.1), gw_mesh_point(&mesh, -0.9, 0.9, 0.9));
        gw_case c;
        gw_case_open(&c, device, gw_mesh_take(&mesh), 9);
        references[large] = c.octree->reference_count;
        gw_case_close(&c);
    }
    print_message("references: %u, with a triangle over all %u; a cell of every voxel of it would be %d\n",
                  references[0], references[1], 1 << 18);
    assert_true(references[1] < references[0] + TINY / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rest_is_as_if_rubbish_had_not_been),
        cmocka_unit_test(the_nearer_of_two_sheets_is_met),
        cmocka_unit_test(one_triangle_over_all_is_cheap),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
