#include "tests/support/meshes.h"

#include "tests/support/random.h"

#include "base/memory.h"
#include "tests/support/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void must(gw_code code) {
    if (code != GW_OK)
        abort();
}

void gw_mesh_finish(gw_mesh *mesh) {
    free(mesh->points);
    free(mesh->triangles);
    *mesh = (gw_mesh){0};
}

uint32_t gw_mesh_point(gw_mesh *mesh, double x, double y, double z) {
    size_t at = mesh->point_count++;
    must(gw_grow((void **)&mesh->points, &mesh->point_capacity, mesh->point_count, 3 * sizeof(double),
                 "points", NULL));
    mesh->points[at * 3] = x;
    mesh->points[at * 3 + 1] = y;
    mesh->points[at * 3 + 2] = z;
    return (uint32_t)at;
}

void gw_mesh_triangle(gw_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
    size_t at = mesh->triangle_count++;
    must(gw_grow((void **)&mesh->triangles, &mesh->triangle_capacity, mesh->triangle_count,
                 sizeof *mesh->triangles, "triangles", NULL));
    mesh->triangles[at][0] = a;
    mesh->triangles[at][1] = b;
    mesh->triangles[at][2] = c;
}

static uint32_t sphere_point(gw_mesh *mesh, const double centre[3], double radius, double ripple, double a,
                             double b) {
    double r =
        radius *
        (1 + ripple * (0.6 * sin(7 * a) * sin(5 * b) + 0.3 * sin(23 * a + 3 * b) * sin(19 * b) * sin(b)));
    return gw_mesh_point(mesh, centre[0] + r * sin(b) * cos(a), centre[1] + r * cos(b),
                         centre[2] + r * sin(b) * sin(a));
}

void gw_mesh_add_sphere(gw_mesh *mesh, const double centre[3], double radius, double ripple, uint32_t around,
                        uint32_t rings) {
    const double pi = 3.14159265358979323846;
    uint32_t top = sphere_point(mesh, centre, radius, 0, 0, 0);
    uint32_t first = (uint32_t)mesh->point_count;
    for (uint32_t ring = 1; ring < rings; ++ring)
        for (uint32_t i = 0; i < around; ++i)
            sphere_point(mesh, centre, radius, ripple, 2 * pi * i / around, pi * ring / rings);
    uint32_t bottom = sphere_point(mesh, centre, radius, 0, 0, pi);
    uint32_t last = first + (rings - 2) * around;
    for (uint32_t i = 0; i < around; ++i) {
        uint32_t next = (i + 1) % around;
        gw_mesh_triangle(mesh, top, first + next, first + i);
        for (uint32_t ring = 0; ring + 2 < rings; ++ring) {
            uint32_t here = first + ring * around, below = here + around;
            gw_mesh_triangle(mesh, here + i, here + next, below + i);
            gw_mesh_triangle(mesh, here + next, below + next, below + i);
        }
        gw_mesh_triangle(mesh, last + i, last + next, bottom);
    }
}

void gw_mesh_add_grid(gw_mesh *mesh, const double corner[3], const double edge_u[3], const double edge_v[3],
                      uint32_t columns, uint32_t rows) {
    uint32_t first = (uint32_t)mesh->point_count;
    for (uint32_t j = 0; j <= rows; ++j)
        for (uint32_t i = 0; i <= columns; ++i) {
            double p[3];
            for (int k = 0; k < 3; ++k)
                p[k] = corner[k] + edge_u[k] * i / columns + edge_v[k] * j / rows;
            gw_mesh_point(mesh, p[0], p[1], p[2]);
        }
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i) {
            uint32_t a = first + j * (columns + 1) + i, b = a + columns + 1;
            gw_mesh_triangle(mesh, a, a + 1, b);
            gw_mesh_triangle(mesh, a + 1, b + 1, b);
        }
}

void gw_mesh_add_box(gw_mesh *mesh, const double low[3], const double high[3]) {
    static const uint8_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    uint32_t corner[8];
    for (int i = 0; i < 8; ++i)
        corner[i] =
            gw_mesh_point(mesh, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    for (int f = 0; f < 6; ++f) {
        gw_mesh_triangle(mesh, corner[faces[f][0]], corner[faces[f][1]], corner[faces[f][2]]);
        gw_mesh_triangle(mesh, corner[faces[f][0]], corner[faces[f][2]], corner[faces[f][3]]);
    }
}

void gw_mesh_add_tetrahedron(gw_mesh *mesh, const double centre[3], double size) {
    static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    uint32_t v[4];
    for (int i = 0; i < 4; ++i)
        v[i] = gw_mesh_point(mesh, centre[0] + size * corner[i][0], centre[1] + size * corner[i][1],
                             centre[2] + size * corner[i][2]);
    gw_mesh_triangle(mesh, v[0], v[1], v[2]);
    gw_mesh_triangle(mesh, v[0], v[3], v[1]);
    gw_mesh_triangle(mesh, v[0], v[2], v[3]);
    gw_mesh_triangle(mesh, v[1], v[3], v[2]);
}

static gw_code fill_arrays(const gw_mesh *mesh, gw_scene *scene, gw_error *error) {
    scene->vertex_count = (uint32_t)mesh->point_count;
    scene->triangle_count = (uint32_t)mesh->triangle_count;
    scene->material_count = 1;
    gw_code code =
        gw_allocate((void **)&scene->positions, mesh->point_count, 3 * sizeof(float), "positions", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->normals, mesh->point_count, 3 * sizeof(float), "normals", error);
    if (code == GW_OK)
        code =
            gw_allocate((void **)&scene->texcoords, mesh->point_count, 2 * sizeof(float), "texcoords", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->triangles, mesh->triangle_count, sizeof *scene->triangles,
                           "triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->material_of, mesh->triangle_count, sizeof(uint32_t), "materials",
                           error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->materials, 1, sizeof *scene->materials, "materials", error);
    return code;
}

gw_code gw_mesh_scene(const gw_mesh *mesh, gw_scene **out, gw_error *error) {
    return gw_mesh_scene_without(mesh, 0, out, error);
}

gw_code gw_mesh_scene_without(const gw_mesh *mesh, double outlier_extents, gw_scene **out, gw_error *error) {
    gw_scene *scene = NULL;
    gw_code code = gw_allocate((void **)&scene, 1, sizeof *scene, "scene", error);
    if (code == GW_OK)
        code = fill_arrays(mesh, scene, error);
    if (code == GW_OK) {
        memcpy(scene->triangles, mesh->triangles, mesh->triangle_count * sizeof *mesh->triangles);
        scene->materials[0] = (gw_material){
            .name = "grey", .base_color = {0.5f, 0.5f, 0.5f, 1}, .roughness = 1, .base_color_texture = -1};
        scene->path = gw_copy_text("test");
        scene->outlier_extents = outlier_extents;
        for (int k = 0; k < 3; ++k)
            scene->ambient[k] = 1;
        code = gw_scene_finish(scene, mesh->points, error);
    }
    if (code != GW_OK)
        gw_scene_destroy(&scene);
    *out = scene;
    return code;
}

gw_scene *gw_mesh_take(gw_mesh *mesh) {
    gw_scene *scene = NULL;
    check_ok(gw_mesh_scene(mesh, &scene, &error));
    gw_mesh_finish(mesh);
    return scene;
}

double gw_test_random(uint64_t *state) {
    return random_unit(state);
}
