/* The mesh report on meshes of which every figure is known. */
#include "tests/support/check.h"

#include "build/mesh_report.h"
#include "tests/support/meshes.h"

#include <math.h>

static gw_mesh_report report_of(gw_mesh *mesh) {
    gw_scene *scene = NULL;
    gw_mesh_report report;
    check_ok(gw_mesh_scene(mesh, &scene, &error));
    check_ok(gw_mesh_report_make(scene, &report, &error));
    gw_scene_destroy(&scene);
    gw_mesh_finish(mesh);
    return report;
}

static void turn_over(uint32_t triangle[3]) {
    const uint32_t swap = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = swap;
}

static void a_closed_surface_is_closed(void **state) {
    const double centre[3] = {1, 2, 3};
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, centre, 1, 0.1, 20, 10); /* 2 * 20 * 9 triangles */
    gw_mesh_report r = report_of(&mesh);
    assert_int_equal(r.edges, 540); /* half of three a triangle */
    assert_int_equal(r.boundary_edges + r.inconsistent_edges + r.non_manifold_edges + r.t_junctions, 0);
    assert_int_equal(r.coincident + r.slivers, 0);
    assert_int_equal(r.components, 1);
    assert_int_equal(r.closed_components, 1);
    assert_int_equal(r.closed_triangles, 360);
    assert_int_equal(r.largest_component, 360);
    assert_int_equal(r.inside_out, 0);
}

static void a_hole_and_a_turned_triangle_open_it(void **state) {
    const double centre[3] = {0, 0, 0}, other[3] = {4, 0, 0};
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, centre, 1, 0, 20, 10);
    const size_t half = mesh.triangle_count;
    gw_mesh_add_sphere(&mesh, other, 1, 0, 20, 10);
    turn_over(mesh.triangles[100]);
    mesh.triangle_count--; /* the last of the second sphere */
    gw_mesh_report r = report_of(&mesh);
    assert_int_equal(r.inconsistent_edges, 3);
    assert_int_equal(r.boundary_edges, 3);
    assert_int_equal(r.components, 2);
    assert_int_equal(r.closed_components, 0);
    assert_int_equal(r.largest_component, half);
}

static void a_surface_turned_inside_out_is_found(void **state) {
    const double centre[3] = {5, 0, 0}, other[3] = {-9, 1, 0};
    gw_mesh mesh = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, centre, 1, 0, 20, 10);
    for (size_t t = 0; t < mesh.triangle_count; t++)
        turn_over(mesh.triangles[t]);
    gw_mesh_add_sphere(&mesh, other, 1, 0, 20, 10);
    gw_mesh_report r = report_of(&mesh);
    assert_int_equal(r.closed_components, 2);
    assert_int_equal(r.inside_out, 1);
}

/* Two tetrahedra that share an edge: it has four triangles, two each way, and the surface stays closed. Three
 * triangles on an edge do not balance. */
static void edges_of_many_triangles(void **state) {
    gw_mesh pair = {0}, book = {0};
    (void)state;
    for (int side = 0; side < 2; side++) {
        const double x = side ? -1 : 1;
        const uint32_t a = gw_mesh_point(&pair, 0, 0, 0), b = gw_mesh_point(&pair, 0, 0, 1),
                       c = gw_mesh_point(&pair, x, 0.5 * x, 0), d = gw_mesh_point(&pair, x, -0.5 * x, 0);
        gw_mesh_triangle(&pair, a, b, c);
        gw_mesh_triangle(&pair, b, a, d);
        gw_mesh_triangle(&pair, c, b, d);
        gw_mesh_triangle(&pair, a, c, d);
    }
    gw_mesh_report r = report_of(&pair);
    assert_int_equal(r.non_manifold_edges, 1);
    assert_int_equal(r.edges, 11);
    assert_int_equal(r.components, 1);
    assert_int_equal(r.closed_components, 1);
    const uint32_t a = gw_mesh_point(&book, 0, 0, 0), b = gw_mesh_point(&book, 0, 0, 1);
    for (int page = 0; page < 3; page++)
        gw_mesh_triangle(&book, a, b, gw_mesh_point(&book, cos(page), sin(page), 0.5));
    r = report_of(&book);
    assert_int_equal(r.non_manifold_edges, 1);
    assert_int_equal(r.boundary_edges, 6);
    assert_int_equal(r.closed_components, 0);
}

/* A large triangle whose side is met by three small ones: one T-junction edge, at any angle; where the vertex
 * is off the line by more than rounding, or only beyond an end, there is none. */
static void t_junctions_are_cracks_only_on_the_line(void **state) {
    const struct {
        double along, off;
        uint64_t found;
    } cases[] = {{0.5, 0, 1}, {0.25, 1e-8, 1}, {0.5, 1e-3, 0}, {1.5, 0, 0}, {-0.5, 0, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (double angle = 0; angle < 6.2; angle += 0.7) {
            const double c = cos(angle), s = sin(angle), x = 2 * cases[i].along, y = cases[i].off;
            gw_mesh mesh = {0};
            const uint32_t from = gw_mesh_point(&mesh, 0, 0, 0.3),
                           to = gw_mesh_point(&mesh, 2 * c, 2 * s, 0.3),
                           third = gw_mesh_point(&mesh, c - s, s + c, 0.3),
                           on = gw_mesh_point(&mesh, x * c - y * s, x * s + y * c, 0.3),
                           below = gw_mesh_point(&mesh, x * c + s, x * s - c, 0.3),
                           beside = gw_mesh_point(&mesh, x * c + s + 0.1, x * s - c, 0.9);
            gw_mesh_triangle(&mesh, from, to, third);
            gw_mesh_triangle(&mesh, on, below, beside);
            assert_int_equal(report_of(&mesh).t_junctions, cases[i].found);
        }
}

static void coincident_triangles_are_told_apart(void **state) {
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    gw_mesh_report r;
    (void)state;
    const uint32_t a = gw_mesh_point(&mesh, 0, 0, 0), b = gw_mesh_point(&mesh, 1, 0, 0),
                   c = gw_mesh_point(&mesh, 0, 1, 0), d = gw_mesh_point(&mesh, 0, 0, 1);
    gw_mesh_triangle(&mesh, a, b, c);
    gw_mesh_triangle(&mesh, b, d, c);
    gw_mesh_triangle(&mesh, a, c, b);
    gw_mesh_triangle(&mesh, c, a, b); /* the same as the first: dropped by the import */
    check_ok(gw_mesh_scene(&mesh, &scene, &error));
    assert_int_equal(scene->dropped.duplicate, 1);
    check_ok(gw_mesh_report_make(scene, &r, &error));
    assert_int_equal(r.coincident, 1);
    assert_int_equal(r.coincident_turned, 1);
    assert_int_equal(r.coincident_materials, 0);
    assert_int_equal(r.closed_components, 0);
    gw_scene_destroy(&scene);
    gw_mesh_finish(&mesh);
}

static void slivers_are_counted(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    const double heights[] = {2.0 / 900, 2.0 / 1100, 1e-4, 1};
    for (int i = 0; i < 4; i++)
        gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, 0, i, 0), gw_mesh_point(&mesh, 2, i, 0),
                         gw_mesh_point(&mesh, 0.7, i, heights[i]));
    gw_mesh_report r = report_of(&mesh);
    assert_int_equal(r.slivers, 2);
    assert_int_equal(r.components, 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_closed_surface_is_closed),
        cmocka_unit_test(a_hole_and_a_turned_triangle_open_it),
        cmocka_unit_test(a_surface_turned_inside_out_is_found),
        cmocka_unit_test(edges_of_many_triangles),
        cmocka_unit_test(t_junctions_are_cracks_only_on_the_line),
        cmocka_unit_test(coincident_triangles_are_told_apart),
        cmocka_unit_test(slivers_are_counted),
    };
    return cmocka_run_group_tests_name("mesh_report", tests, NULL, NULL);
}
