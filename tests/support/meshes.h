/* Small scenes by formula for tests: raw meshes in scene metres that become finished scenes. One thread. */
#ifndef GW_TESTS_SUPPORT_MESHES_H
#define GW_TESTS_SUPPORT_MESHES_H

#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>
#include <stdint.h>

/* A growing triangle soup with shared vertices. */
typedef struct gw_mesh {
    double *points; /* [point_count][3] */
    size_t point_count, point_capacity;
    uint32_t (*triangles)[3];
    size_t triangle_count, triangle_capacity;
} gw_mesh;

void gw_mesh_finish(gw_mesh *mesh);
uint32_t gw_mesh_point(gw_mesh *mesh, double x, double y, double z); /* aborts the test when memory is out */
void gw_mesh_triangle(gw_mesh *mesh, uint32_t a, uint32_t b, uint32_t c);

/* Closed, star-shaped surface about the centre with two pole fans of `around` triangles; radius varies by
 * formula (render.md, section 8): 2 * around * (rings - 1) triangles. */
void gw_mesh_add_sphere(gw_mesh *mesh, const double centre[3], double radius, double ripple, uint32_t around,
                        uint32_t rings);
/* Rectangle of columns x rows x 2 triangles from corner along two edges. */
void gw_mesh_add_grid(gw_mesh *mesh, const double corner[3], const double edge_u[3], const double edge_v[3],
                      uint32_t columns, uint32_t rows);
/* Box of twelve triangles, its edges along the axes. */
void gw_mesh_add_box(gw_mesh *mesh, const double low[3], const double high[3]);
/* Tetrahedron with vertices at centre + size * a regular one's. */
void gw_mesh_add_tetrahedron(gw_mesh *mesh, const double centre[3], double size);

/* A finished scene with one grey material. The mesh is left alone. */
gw_code gw_mesh_scene(const gw_mesh *mesh, gw_scene **out, gw_error *error);
/* The same without what lies farther out than the setting outlier_extents says. */
gw_code gw_mesh_scene_without(const gw_mesh *mesh, double outlier_extents, gw_scene **out, gw_error *error);

/* The same for tests that end when it fails; the mesh is emptied. */
gw_scene *gw_mesh_take(gw_mesh *mesh);

/* Random numbers that are the same everywhere: state in, 0 <= value < 1 out. */
double gw_test_random(uint64_t *state);

#endif
