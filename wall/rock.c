#include "wall/rock.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { OCTAVES = 10, MOST_TRIANGLES = 20000000 };

/* A number in -1..1 for a point of the integer lattice (mixing of murmur3). */
static double lattice_noise(int32_t x, int32_t y, int32_t z) {
    uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return (double)(h ^ h >> 16) / 2147483647.5 - 1.0;
}

/* Smooth between the lattice's eight points. */
static double smooth_noise(const double p[3]) {
    int32_t cell[3];
    double weight[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        double low = floor(p[i]), t = p[i] - low;
        cell[i] = (int32_t)low;
        weight[i] = t * t * (3 - 2 * t);
    }
    for (int corner = 0; corner < 8; corner++) {
        double share = 1;
        for (int i = 0; i < 3; i++)
            share *= corner >> i & 1 ? weight[i] : 1 - weight[i];
        sum += share *
               lattice_noise(cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
    }
    return sum;
}

/* From the cube's surface to the rock's. Equal points of the cube give equal points, so its faces' grids
 * join. */
static void place(const double cube[3], double out[3]) {
    double length = sqrt(cube[0] * cube[0] + cube[1] * cube[1] + cube[2] * cube[2]);
    double radius = 1, size = 0.25, scale = 1.7;
    for (int octave = 0; octave < OCTAVES; octave++) {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = cube[i] / length * scale + 17.0 * octave;
        radius += size * smooth_noise(p);
        size *= 0.5;
        scale *= 2;
    }
    for (int i = 0; i < 3; i++)
        out[i] = cube[i] / length * radius;
}

/* Points and triangles of one face of the cube: axis is where it looks, sign to which side. */
static void put_face(gw_scene *scene, double *world, uint32_t n, int face) {
    int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t first = (uint32_t)face * (n + 1) * (n + 1), triangle = (uint32_t)face * 2 * n * n;
    for (uint32_t row = 0; row <= n; row++)
        for (uint32_t column = 0; column <= n; column++) {
            double cube[3];
            cube[axis] = face % 2 ? 1 : -1;
            cube[u] = (2.0 * column - n) / n;
            cube[v] = (2.0 * row - n) / n;
            place(cube, world + 3 * (size_t)(first + row * (n + 1) + column));
        }
    for (uint32_t row = 0; row < n; row++)
        for (uint32_t column = 0; column < n; column++) {
            uint32_t a = first + row * (n + 1) + column, b = a + 1, c = a + n + 1, d = c + 1;
            uint32_t inside[2][3] = {{a, b, d}, {a, d, c}};
            for (int k = 0; k < 2; k++, triangle++) {
                scene->triangles[triangle][0] = inside[k][0];
                scene->triangles[triangle][1] = inside[k][face % 2 ? 1 : 2];
                scene->triangles[triangle][2] = inside[k][face % 2 ? 2 : 1];
            }
        }
}

static gw_code make(gw_scene *scene, uint32_t n, double **world, gw_error *error) {
    char name[64];
    scene->vertex_count = 6 * (n + 1) * (n + 1);
    scene->triangle_count = 12 * n * n;
    scene->material_count = 1;
    snprintf(name, sizeof name, "rock of %u triangles", scene->triangle_count);
    scene->path = gw_copy_text(name);
    gw_code code = scene->path ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while making a rock");
    if (code == GW_OK)
        code =
            gw_allocate((void **)world, scene->vertex_count, 3 * sizeof **world, "the rock's points", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->triangles, scene->triangle_count, sizeof *scene->triangles,
                           "the rock's triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->material_of, scene->triangle_count, sizeof *scene->material_of,
                           "the rock's triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->materials, 1, sizeof *scene->materials, "the rock's material",
                           error);
    if (code != GW_OK)
        return code;
    scene->materials[0] = (gw_material){
        .name = "rock", .base_color = {0.5f, 0.45f, 0.4f, 1}, .roughness = 0.9f, .base_color_texture = -1};
    for (int face = 0; face < 6; face++)
        put_face(scene, *world, n, face);
    return gw_scene_finish(scene, *world, error);
}

gw_code gw_rock_scene(uint32_t triangles, gw_scene **out, gw_error *error) {
    double *world = NULL;
    uint32_t n = 1;
    *out = NULL;
    if (triangles < 12 || triangles > MOST_TRIANGLES)
        return gw_fail(error, GW_BAD_INPUT, "a rock has 12 to %d triangles, not %u", MOST_TRIANGLES,
                       triangles);
    while (12 * n * n < triangles)
        n++;
    gw_code code = gw_allocate((void **)out, 1, sizeof **out, "a rock", error);
    if (code == GW_OK)
        code = make(*out, n, &world, error);
    free(world);
    if (code != GW_OK)
        gw_scene_destroy(out);
    return code;
}
