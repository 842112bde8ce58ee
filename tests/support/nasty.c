/* See nasty.h. */
#include "tests/support/nasty.h"

#include <math.h>
#include <string.h>

static double between(uint64_t *random, double low, double high) {
    return low + (high - low) * gw_test_random(random);
}

static int whole_between(uint64_t *random, int low, int high) {
    return low + (int)(gw_test_random(random) * (high - low + 1));
}

/* Keeps the rebased scene on the lattice: the box is [-1,1]^3 whatever else is in it. */
static void add_anchors(gw_mesh *mesh) {
    for (int side = -1; side <= 1; side += 2)
        gw_mesh_triangle(mesh, gw_mesh_point(mesh, side, side, side),
                         gw_mesh_point(mesh, side * 0.984375, side, side),
                         gw_mesh_point(mesh, side, side * 0.984375, side * 0.96875));
}

/* Corners on multiples of 1/16 of the scene: in the planes, on the edges and at the corners of cells. */
static void add_lattice(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 60; i++) {
        uint32_t v[3];
        for (int k = 0; k < 3; k++)
            v[k] = gw_mesh_point(mesh, whole_between(random, -8, 8) / 8.0, whole_between(random, -8, 8) / 8.0,
                                 whole_between(random, -8, 8) / 8.0);
        gw_mesh_triangle(mesh, v[0], v[1], v[2]);
    }
}

/* Rectangles that lie in cell planes. */
static void add_coplanar(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 6; i++) {
        int axis = whole_between(random, 0, 2);
        double corner[3], u[3] = {0}, v[3] = {0};
        for (int k = 0; k < 3; k++)
            corner[k] = whole_between(random, -4, 2) / 4.0;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 0.5;
        gw_mesh_add_grid(mesh, corner, u, v, (uint32_t)whole_between(random, 1, 3), 2);
    }
}

/* Long thin triangles, a millionth as wide as long. */
static void add_needles(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 50; i++) {
        double a[3], b[3], c[3], width = pow(10, between(random, -6, -2));
        for (int k = 0; k < 3; k++) {
            a[k] = between(random, -1, 1);
            b[k] = between(random, -1, 1);
            c[k] = fmin(1, fmax(-1, b[k] + width * between(random, -1, 1)));
        }
        gw_mesh_triangle(mesh, gw_mesh_point(mesh, a[0], a[1], a[2]), gw_mesh_point(mesh, b[0], b[1], b[2]),
                         gw_mesh_point(mesh, c[0], c[1], c[2]));
    }
}

/* From a millionth of the scene to all of it. */
static void add_sizes(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 60; i++) {
        double size = pow(10, between(random, -6, 0)), corner[3];
        uint32_t v[3];
        for (int k = 0; k < 3; k++)
            corner[k] = between(random, -1 + size, 1 - size);
        for (int k = 0; k < 3; k++)
            v[k] = gw_mesh_point(mesh, corner[0] + size * between(random, -1, 1),
                                 corner[1] + size * between(random, -1, 1),
                                 corner[2] + size * between(random, -1, 1));
        gw_mesh_triangle(mesh, v[0], v[1], v[2]);
    }
}

/* One vertex with many triangles round it. */
static void add_fan(gw_mesh *mesh, uint64_t *random) {
    int count = whole_between(random, 3, 48);
    double size = pow(10, between(random, -2, -0.5)), centre[3];
    for (int k = 0; k < 3; k++)
        centre[k] = between(random, -0.6, 0.6);
    uint32_t hub = gw_mesh_point(mesh, centre[0], centre[1], centre[2]), first = 0, last = 0;
    for (int i = 0; i <= count; i++) {
        double angle = 6.283185307179586 * i / count;
        uint32_t rim = i == count
                           ? first
                           : gw_mesh_point(mesh, centre[0] + size * cos(angle), centre[1] + size * sin(angle),
                                           centre[2] + 0.1 * size * gw_test_random(random));
        if (i == 0)
            first = rim;
        else
            gw_mesh_triangle(mesh, hub, last, rim);
        last = rim;
    }
}

static void add_small_things(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 6; i++) {
        double centre[3], size = pow(10, between(random, -4, -1));
        for (int k = 0; k < 3; k++)
            centre[k] = between(random, -0.8, 0.8);
        gw_mesh_add_tetrahedron(mesh, centre, size);
    }
}

/* Triangles that are there already, turned and turned over. */
static void add_copies(gw_mesh *mesh, uint64_t *random) {
    for (int i = 0; i < 30; i++) {
        uint32_t t[3];
        int side = whole_between(random, 1, 2);
        memcpy(t, mesh->triangles[(size_t)(gw_test_random(random) * (double)mesh->triangle_count)], sizeof t);
        gw_mesh_triangle(mesh, t[0], t[side], t[3 - side]);
    }
}

void gw_mesh_add_nasty(gw_mesh *mesh, uint64_t *random) {
    void (*const ingredients[])(gw_mesh *, uint64_t *) = {add_lattice, add_coplanar, add_needles,
                                                          add_sizes,   add_fan,      add_small_things};
    enum { COUNT = sizeof ingredients / sizeof *ingredients };
    int chosen = whole_between(random, 1, (1 << COUNT) - 1);
    add_anchors(mesh);
    for (int i = 0; i < COUNT; i++)
        if (chosen >> i & 1)
            ingredients[i](mesh, random);
    if (gw_test_random(random) < 0.5)
        add_copies(mesh, random);
}
