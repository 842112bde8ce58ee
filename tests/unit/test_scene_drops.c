/* Which triangles a scene loses and which it must not: outliers and duplicates. */
#include "tests/support/check.h"

#include "base/settings.h"
#include "build/mesh_report.h"
#include "build/scene.h"
#include "tests/support/meshes.h"

#include <float.h>
#include <math.h>

static double default_extents(void) {
    gw_settings settings;
    gw_settings_init(&settings);
    return settings.outlier_extents;
}

/* A raw scene of a mesh, not yet finished, with two materials. */
static gw_scene *raw_scene(const gw_mesh *mesh, double outlier_extents) {
    gw_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    scene->vertex_count = (uint32_t)mesh->point_count;
    scene->triangle_count = (uint32_t)mesh->triangle_count;
    scene->triangles = malloc(mesh->triangle_count * sizeof *scene->triangles);
    scene->material_of = calloc(mesh->triangle_count, sizeof *scene->material_of);
    scene->materials = calloc(2, sizeof *scene->materials);
    assert_true(scene->triangles && scene->material_of && scene->materials);
    memcpy(scene->triangles, mesh->triangles, mesh->triangle_count * sizeof *scene->triangles);
    scene->material_count = 2;
    scene->materials[0].base_color_texture = scene->materials[1].base_color_texture = -1;
    scene->materials[1].roughness = 0.5f;
    scene->outlier_extents = outlier_extents;
    return scene;
}

/* --- outliers
 * -------------------------------------------------------------------------------------------------------- */

static void add_model(gw_mesh *mesh, double radius) {
    const double centre[3] = {3, -2, 1};
    gw_mesh_add_sphere(mesh, centre, radius, 0.1, 32, 16);
}

static void add_triangle_at(gw_mesh *mesh, double x, double y, double z, double size) {
    gw_mesh_triangle(mesh, gw_mesh_point(mesh, x, y, z), gw_mesh_point(mesh, x + size, y, z),
                     gw_mesh_point(mesh, x, y + size, z));
}

static const double far_places[][3] = {{1e12, 0, 0}, {0, -1e30, 0}, {-3e8, 1e290, 5}, {0, 0, DBL_MAX}};

/* Without the rule the model collapses to a point and only the stray triangle is left, or nothing is; with it
 * the model is as if the stray triangle had never been. */
static void a_stray_triangle_does_not_cost_the_model(void **state) {
    gw_mesh model = {0};
    (void)state;
    add_model(&model, 0.5);
    gw_scene *alone = raw_scene(&model, default_extents());
    check_ok(gw_scene_finish(alone, model.points, &error));
    assert_int_equal(alone->triangle_count, model.triangle_count);
    for (size_t i = 0; i < sizeof far_places / sizeof *far_places; i++) {
        const double *p = far_places[i], size = 0.01 * fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
        gw_error ignored = {0};
        gw_mesh mesh = {0};
        add_model(&mesh, 0.5);
        add_triangle_at(&mesh, p[0], p[1], p[2], -size);
        gw_scene *naive = raw_scene(&mesh, 0);
        if (gw_scene_finish(naive, mesh.points, &ignored) == GW_OK) {
            assert_int_equal(naive->triangle_count, 1);
            assert_int_equal(naive->dropped.collapsed, model.triangle_count);
        }
        gw_scene *scene = raw_scene(&mesh, default_extents());
        check_ok(gw_scene_finish(scene, mesh.points, &error));
        assert_int_equal(scene->dropped.outlier, 1);
        assert_int_equal(scene->triangle_count, alone->triangle_count);
        assert_true(gw_hash_equal(scene->hash, alone->hash));
        assert_int_equal(scene->note_count, 1);
        assert_non_null(strstr(scene->notes[0], "outlier_extents=0"));
        gw_scene_destroy(&naive);
        gw_scene_destroy(&scene);
        gw_mesh_finish(&mesh);
    }
    gw_scene_destroy(&alone);
    gw_mesh_finish(&model);
}

/* A few vertices at 1e30 within the model's own triangles. */
static void runaway_vertices_cost_their_triangles_only(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    add_model(&mesh, 0.5);
    const uint32_t runaway = mesh.triangles[100][1];
    mesh.points[runaway * 3 + 1] = 1e30;
    uint64_t touching = 0;
    for (size_t t = 0; t < mesh.triangle_count; t++)
        touching += mesh.triangles[t][0] == runaway || mesh.triangles[t][1] == runaway ||
                    mesh.triangles[t][2] == runaway;
    gw_scene *scene = raw_scene(&mesh, default_extents());
    check_ok(gw_scene_finish(scene, mesh.points, &error));
    assert_true(touching >= 4);
    assert_int_equal(scene->dropped.outlier, touching);
    assert_int_equal(scene->triangle_count, mesh.triangle_count - touching);
    gw_scene_destroy(&scene);
    gw_mesh_finish(&mesh);
}

/* A statuette of 2 cm on a ground of 10 km under a sky of 20 km, and far from the origin: all of it stays. */
static void grounds_and_skies_stay(void **state) {
    const double corner[3] = {-5000, 0, -5000}, u[3] = {10000, 0, 0}, v[3] = {0, 0, 10000},
                 centre[3] = {3, 0, 1};
    gw_mesh mesh = {0};
    (void)state;
    add_model(&mesh, 0.01);
    gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
    gw_mesh_add_sphere(&mesh, centre, 10000, 0, 8, 4);
    for (double shift = 0; shift < 2e6; shift += 1e6) {
        for (size_t p = 0; p < mesh.point_count; p++)
            mesh.points[p * 3] += shift;
        gw_scene *scene = raw_scene(&mesh, default_extents());
        check_ok(gw_scene_finish(scene, mesh.points, &error));
        assert_int_equal(scene->dropped.outlier, 0);
        gw_scene_destroy(&scene);
    }
    gw_mesh_finish(&mesh);
}

/* Two halves of a scene are no outliers of each other, however far apart; few triangles have no bulk. */
static void what_has_no_bulk_stays(void **state) {
    gw_mesh halves = {0}, few = {0};
    (void)state;
    add_model(&halves, 0.5);
    for (size_t p = 0; p < halves.point_count; p += 2)
        halves.points[p * 3] += 1e12;
    for (int i = 0; i < 7; i++)
        add_triangle_at(&few, pow(1e3, i), 0, 0, pow(1e3, i));
    gw_mesh *meshes[] = {&halves, &few};
    for (int i = 0; i < 2; i++) {
        gw_scene *scene = raw_scene(meshes[i], default_extents());
        check_ok(gw_scene_finish(scene, meshes[i]->points, &error));
        assert_int_equal(scene->dropped.outlier, 0);
        gw_scene_destroy(&scene);
        gw_mesh_finish(meshes[i]);
    }
}

/* --- duplicates
 * -------------------------------------------------------------------------------------------------------- */

/* One triangle four times: as it is, with corners rotated, turned over, and with the other material. */
static gw_scene *copies(gw_alpha_mode mode, int same_materials) {
    gw_mesh mesh = {0};
    const uint32_t a = gw_mesh_point(&mesh, 0, 0, 0), b = gw_mesh_point(&mesh, 1, 0, 0),
                   c = gw_mesh_point(&mesh, 0, 1, 0);
    gw_mesh_triangle(&mesh, a, b, c);
    gw_mesh_triangle(&mesh, b, c, a);
    gw_mesh_triangle(&mesh, c, b, a);
    gw_mesh_triangle(&mesh, a, b, c);
    gw_scene *scene = raw_scene(&mesh, 0);
    scene->material_of[3] = 1;
    scene->materials[0].alpha_mode = mode;
    if (same_materials)
        scene->materials[1] = scene->materials[0];
    check_ok(gw_scene_finish(scene, mesh.points, &error));
    gw_mesh_finish(&mesh);
    return scene;
}

static void equal_triangles_are_dropped_unless_blended(void **state) {
    (void)state;
    const struct {
        gw_alpha_mode mode;
        int same_materials;
        uint32_t left;
    } cases[] = {{GW_ALPHA_OPAQUE, 0, 3}, {GW_ALPHA_MASK, 0, 3}, {GW_ALPHA_BLEND, 0, 4},
                 {GW_ALPHA_OPAQUE, 1, 2}, {GW_ALPHA_MASK, 1, 2}, {GW_ALPHA_BLEND, 1, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gw_scene *scene = copies(cases[i].mode, cases[i].same_materials);
        assert_int_equal(scene->triangle_count, cases[i].left);
        assert_int_equal(scene->dropped.duplicate, 4 - cases[i].left);
        gw_scene_destroy(&scene);
    }
}

/* A sphere with a fold: one face again, there and back. The surface is closed with all three, and would not
 * be if the equal two became one. A whole sphere twice may lose its double: it stays closed. */
static void closed_surfaces_stay_closed(void **state) {
    const double centre[3] = {0, 0, 0};
    (void)state;
    for (int folded = 0; folded < 2; folded++) {
        gw_mesh mesh = {0};
        gw_mesh_report report;
        gw_mesh_add_sphere(&mesh, centre, 1, 0.1, 12, 6);
        const size_t faces = mesh.triangle_count;
        if (folded) {
            const uint32_t *t = mesh.triangles[30], corners[3] = {t[0], t[1], t[2]};
            gw_mesh_triangle(&mesh, corners[1], corners[2], corners[0]);
            gw_mesh_triangle(&mesh, corners[2], corners[1], corners[0]);
        } else {
            gw_mesh_add_sphere(&mesh, centre, 1, 0.1, 12, 6);
        }
        gw_scene *scene = raw_scene(&mesh, 0);
        check_ok(gw_scene_finish(scene, mesh.points, &error));
        assert_int_equal(scene->dropped.duplicate, folded ? 0 : faces);
        check_ok(gw_mesh_report_make(scene, &report, &error));
        assert_int_equal(report.closed_components, 1);
        assert_int_equal(report.closed_triangles, scene->triangle_count);
        gw_scene_destroy(&scene);
        gw_mesh_finish(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stray_triangle_does_not_cost_the_model),
        cmocka_unit_test(runaway_vertices_cost_their_triangles_only),
        cmocka_unit_test(grounds_and_skies_stay),
        cmocka_unit_test(what_has_no_bulk_stays),
        cmocka_unit_test(equal_triangles_are_dropped_unless_blended),
        cmocka_unit_test(closed_surfaces_stay_closed),
    };
    return cmocka_run_group_tests_name("scene_drops", tests, NULL, NULL);
}
