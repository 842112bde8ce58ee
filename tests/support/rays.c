/* See rays.h. */
#include "tests/support/rays.h"

#include "tests/support/check.h"
#include "tests/support/meshes.h"

#include <math.h>

static float between(uint64_t *random, double low, double high) {
    return (float)(low + (high - low) * gw_test_random(random));
}

gw_scene *gw_test_scene(uint64_t seed) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0.1, 0.2, -0.1}, 0.4, 0.2, 40, 24);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.5, -0.9}, (const double[]){1.8, 0, 0},
                     (const double[]){0, 0, 1.8}, 24, 24);
    gw_mesh_add_grid(&mesh, (const double[]){-0.875, -0.5, -0.875}, (const double[]){0, 1.0, 0},
                     (const double[]){0, 0, 1.75}, 2, 2);
    uint64_t random = seed;
    for (int i = 0; i < 120; ++i) {
        double centre[3];
        for (int k = 0; k < 3; ++k)
            centre[k] = 1.7 * (gw_test_random(&random) - 0.5);
        gw_mesh_add_tetrahedron(&mesh, centre, 0.002 + 0.03 * gw_test_random(&random));
    }
    return gw_mesh_take(&mesh);
}

static const float *vertex(const gw_scene *scene, uint32_t triangle, uint32_t corner) {
    return scene->positions + (size_t)scene->triangles[triangle][corner] * 3;
}

static uint32_t any_triangle(const gw_scene *scene, uint64_t *random) {
    return (uint32_t)(gw_test_random(random) * scene->triangle_count);
}

/* Kinds of origin: anywhere inside, far outside, on corners of cells, on a triangle's vertex. */
static void put_origin(const gw_scene *scene, gw_ray *ray, uint64_t *random, int kind) {
    uint32_t triangle = any_triangle(scene, random);
    for (uint32_t k = 0; k < 3; ++k) {
        float cell = between(random, -32.0, 32.0);
        ray->origin[k] = kind == 0   ? between(random, -0.95, 0.95)
                         : kind == 1 ? between(random, -4.0, 4.0)
                         : kind == 2 ? floorf(cell) / 32.0f
                                     : vertex(scene, triangle, 1)[k];
    }
}

/* Kinds of direction: any, at a vertex, at an edge's middle, along an axis, one zero component, diagonal,
 * nearly zero components. */
static void put_direction(const gw_scene *scene, gw_ray *ray, uint64_t *random, int kind) {
    static const float tiny[] = {0.0f, -0.0f, 1e-38f, -1e-45f, 1e-20f, -1e-12f};
    uint32_t triangle = any_triangle(scene, random);
    uint32_t axis = (uint32_t)(gw_test_random(random) * 3.0);
    for (uint32_t k = 0; k < 3; ++k) {
        float sign = gw_test_random(random) < 0.5 ? -1.0f : 1.0f;
        float small = tiny[(int)(gw_test_random(random) * 6.0)];
        float at_vertex = vertex(scene, triangle, 0)[k] - ray->origin[k];
        float at_edge =
            0.5f * (vertex(scene, triangle, 0)[k] + vertex(scene, triangle, 1)[k]) - ray->origin[k];
        float free_value = between(random, -1.0, 1.0);
        float along = k == axis ? sign : small;
        ray->direction[k] = kind == 0   ? free_value
                            : kind == 1 ? at_vertex
                            : kind == 2 ? at_edge
                            : kind == 3 ? along
                            : kind == 4 ? (k == axis ? small : free_value)
                            : kind == 5 ? sign
                                        : (k == axis ? at_vertex : small);
    }
}

gw_ray *gw_test_rays(const gw_scene *scene, size_t count, uint64_t seed) {
    gw_ray *rays = calloc(count, sizeof *rays);
    assert_non_null(rays);
    uint64_t random = seed;
    for (size_t i = 0; i < count; ++i) {
        put_origin(scene, &rays[i], &random, (int)(i % 4));
        put_direction(scene, &rays[i], &random, (int)(i / 4 % 7));
        rays[i].maximum = INFINITY;
    }
    return rays;
}
