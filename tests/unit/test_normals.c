/* Smooth normals: creases stay, curves become smooth, and the order of triangles does not matter. */
#include "tests/support/check.h"

#include "build/source_model.h"
#include "tests/support/meshes.h"

#include <math.h>

static gw_source_model *model_of(const gw_mesh *mesh) {
    gw_source_model *model = NULL;
    check_ok(gw_source_model_create(&model, &error));
    gw_scene *scene = model->scene;
    scene->vertex_count = (uint32_t)mesh->point_count;
    scene->triangle_count = (uint32_t)mesh->triangle_count;
    model->world = malloc(mesh->point_count * 24);
    scene->triangles = malloc(mesh->triangle_count * 12);
    scene->material_of = calloc(mesh->triangle_count, 4);
    scene->materials = calloc(1, sizeof *scene->materials);
    assert_true(model->world && scene->triangles && scene->material_of && scene->materials);
    memcpy(model->world, mesh->points, mesh->point_count * 24);
    memcpy(scene->triangles, mesh->triangles, mesh->triangle_count * 12);
    scene->material_count = 1;
    scene->materials[0].base_color_texture = -1;
    return model;
}

static void box(gw_mesh *mesh) {
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    uint32_t points[8];
    for (uint32_t i = 0; i < 8; i++)
        points[i] = gw_mesh_point(mesh, i & 1, i >> 1 & 1, i >> 2);
    for (int q = 0; q < 6; q++) {
        gw_mesh_triangle(mesh, points[quads[q][0]], points[quads[q][1]], points[quads[q][2]]);
        gw_mesh_triangle(mesh, points[quads[q][0]], points[quads[q][2]], points[quads[q][3]]);
    }
}

static void a_box_keeps_its_edges(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    box(&mesh);
    gw_source_model *model = model_of(&mesh);
    check_ok(gw_source_model_smooth_normals(model, 60.0, &error));
    assert_int_equal(model->scene->vertex_count, 24);
    for (uint32_t t = 0; t < model->scene->triangle_count; t++) {
        const uint32_t *corners = model->scene->triangles[t];
        const double *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = model->world + corners[k] * 3;
        for (int axis = 0; axis < 3; axis++) { /* the face's own normal, out of the box */
            const int y = (axis + 1) % 3, z = (axis + 2) % 3;
            const double n =
                (p[1][y] - p[0][y]) * (p[2][z] - p[0][z]) - (p[1][z] - p[0][z]) * (p[2][y] - p[0][y]);
            for (int k = 0; k < 3; k++)
                assert_true(fabs((double)model->scene->normals[corners[k] * 3 + (uint32_t)axis] - n) < 1e-6);
        }
    }
    gw_source_model_destroy(&model);
    model = model_of(&mesh);
    check_ok(
        gw_source_model_smooth_normals(model, 120.0, &error)); /* a crease angle beyond all edges: no split */
    assert_int_equal(model->scene->vertex_count, 8);
    const float *corner = model->scene->normals; /* of (0, 0, 0): three equal angles */
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabs((double)corner[axis] + 1.0 / sqrt(3.0)) < 1e-6);
    gw_source_model_destroy(&model);
    gw_mesh_finish(&mesh);
}

static void a_sphere_becomes_smooth(void **state) {
    (void)state;
    static const double centre[3] = {3, -2, 1};
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, centre, 2.0, 0.0, 48, 24);
    gw_source_model *model = model_of(&mesh);
    check_ok(gw_source_model_smooth_normals(model, 60.0, &error));
    assert_int_equal(model->scene->vertex_count, mesh.point_count);
    for (uint32_t v = 0; v < model->scene->vertex_count; v++) {
        double cosine = 0.0;
        for (uint32_t i = 0; i < 3; i++)
            cosine += (double)model->scene->normals[v * 3 + i] * (model->world[v * 3 + i] - centre[i]) / 2.0;
        assert_true(cosine > 0.999);
    }
    gw_source_model_destroy(&model);
    gw_mesh_finish(&mesh);
}

static gw_scene *finish(gw_source_model *model) {
    check_ok(gw_scene_finish(model->scene, model->world, &error));
    gw_scene *scene = model->scene;
    model->scene = NULL;
    gw_source_model_destroy(&model);
    return scene;
}

static void order_does_not_matter(void **state) {
    (void)state;
    static const double centre[3] = {0, 0, 0};
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, centre, 1.0, 0.4, 40, 20);
    box(&mesh);
    gw_source_model *model = model_of(&mesh);
    check_ok(gw_source_model_smooth_normals(model, 60.0, &error));
    gw_scene *reference = finish(model);
    for (uint64_t turn = 1; turn <= 5; turn++) {
        uint64_t random = turn;
        model = model_of(&mesh);
        for (size_t i = mesh.triangle_count; i > 1; i--) {
            const size_t k = (size_t)(gw_test_random(&random) * (double)i);
            uint32_t swap[3];
            memcpy(swap, model->scene->triangles[i - 1], 12);
            memcpy(model->scene->triangles[i - 1], model->scene->triangles[k], 12);
            memcpy(model->scene->triangles[k], swap, 12);
        }
        check_ok(gw_source_model_smooth_normals(model, 60.0, &error));
        gw_scene *scene = finish(model);
        assert_true(gw_hash_equal(scene->hash, reference->hash));
        gw_scene_destroy(&scene);
    }
    gw_scene_destroy(&reference);
    gw_mesh_finish(&mesh);
}

/* One vertex of thousands of triangles is smoothed without looking for creases, and says so. */
static void a_crowded_vertex_is_named(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    const uint32_t tip = gw_mesh_point(&mesh, 0, 0, 1);
    uint32_t last = gw_mesh_point(&mesh, 1, 0, 0);
    for (int i = 1; i <= 3000; i++) {
        const double angle = i * 0.002;
        const uint32_t next = gw_mesh_point(&mesh, cos(angle), sin(angle), 0);
        gw_mesh_triangle(&mesh, tip, last, next);
        last = next;
    }
    gw_source_model *model = model_of(&mesh);
    check_ok(gw_source_model_smooth_normals(model, 60.0, &error));
    assert_int_equal(model->scene->note_count, 1);
    assert_non_null(strstr(model->scene->notes[0], "1 vertices"));
    gw_source_model_destroy(&model);
    gw_mesh_finish(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_keeps_its_edges),
        cmocka_unit_test(a_sphere_becomes_smooth),
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(a_crowded_vertex_is_named),
    };
    return cmocka_run_group_tests_name("normals", tests, NULL, NULL);
}
