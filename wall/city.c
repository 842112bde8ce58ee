#include "wall/city.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MATERIAL_WINDOW, MATERIAL_STREET, MATERIAL_ROOF, MATERIAL_METAL, MATERIAL_WALLS, MATERIAL_COUNT = 8 };

static const gw_material materials[MATERIAL_COUNT] = {
    {.name = "window", .base_color = {0.02f, 0.03f, 0.05f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "street", .base_color = {0.1f, 0.1f, 0.1f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "roof", .base_color = {0.35f, 0.1f, 0.06f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "metal", .base_color = {0.9f, 0.9f, 0.9f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "plaster", .base_color = {0.85f, 0.8f, 0.7f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "brick", .base_color = {0.5f, 0.2f, 0.13f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "stone", .base_color = {0.6f, 0.6f, 0.62f, 1}, .roughness = 1, .base_color_texture = -1},
    {.name = "ochre", .base_color = {0.75f, 0.55f, 0.2f, 1}, .roughness = 1, .base_color_texture = -1},
};

static const double lot = 20, house = 13; /* m a side */

typedef struct city {
    gw_scene *scene;
    double *points; /* [vertex_count][3] */
    size_t point_capacity, triangle_capacity, material_capacity;
    gw_code code;
    gw_error *error;
} city;

/* 0..count-1 for a lot and a question (mixing of murmur3). */
static uint32_t choice(uint32_t x, uint32_t z, uint32_t question, uint32_t count) {
    uint32_t h = x * 0x8da6b343u ^ z * 0xd8163841u ^ question * 0xcb1ab31fu;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return (h ^ h >> 16) % count;
}

/* The parallelogram from corner along u and v, seen from the side of u x v. */
static void put_quad(city *c, const double corner[3], const double u[3], const double v[3],
                     uint32_t material) {
    gw_scene *scene = c->scene;
    const uint32_t first = scene->vertex_count, triangle = scene->triangle_count;
    if (!c->code)
        c->code =
            gw_grow((void **)&c->points, &c->point_capacity, first + 4, 3 * sizeof(double), "city", c->error);
    if (!c->code)
        c->code = gw_grow((void **)&scene->triangles, &c->triangle_capacity, triangle + 2,
                          sizeof *scene->triangles, "city", c->error);
    if (!c->code)
        c->code = gw_grow((void **)&scene->material_of, &c->material_capacity, triangle + 2,
                          sizeof *scene->material_of, "city", c->error);
    if (c->code)
        return;
    for (uint32_t i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            c->points[3 * (size_t)(first + i) + (size_t)k] =
                corner[k] + (i == 1 || i == 2 ? u[k] : 0) + (i >= 2 ? v[k] : 0);
    const uint32_t corners[2][3] = {{first, first + 1, first + 2}, {first, first + 2, first + 3}};
    for (uint32_t i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++)
            scene->triangles[triangle + i][k] = corners[i][k];
        scene->material_of[triangle + i] = material;
    }
    scene->vertex_count += 4;
    scene->triangle_count += 2;
}

/* Four walls of a box with its middle at (x, z) on the ground; each wall cut into columns x rows of
 * rectangles, of which every second one both ways is a window. */
static void put_walls(city *c, const double middle[2], double bottom, double width, double height,
                      const uint32_t cuts[2], uint32_t material) {
    static const double along[4][2] = {{1, 0}, {0, -1}, {-1, 0}, {0, 1}};
    const double half = 0.5 * width;
    for (int side = 0; side < 4; side++) {
        const double *a = along[side];
        /* The wall's outside is to the right of where it runs. */
        const double start[2] = {middle[0] - half * a[0] - half * a[1],
                                 middle[1] - half * a[1] + half * a[0]};
        const double u[3] = {a[0] * width / cuts[0], 0, a[1] * width / cuts[0]},
                     v[3] = {0, height / cuts[1], 0};
        for (uint32_t row = 0; row < cuts[1]; row++)
            for (uint32_t column = 0; column < cuts[0]; column++) {
                const double corner[3] = {start[0] + column * u[0], bottom + row * v[1],
                                          start[1] + column * u[2]};
                put_quad(c, corner, u, v, row % 2 && column % 2 ? MATERIAL_WINDOW : material);
            }
    }
}

static void put_flat(city *c, const double middle[2], double width, double height, uint32_t material) {
    const double corner[3] = {middle[0] - 0.5 * width, height, middle[1] + 0.5 * width}, u[3] = {width, 0, 0},
                 v[3] = {0, 0, -width};
    put_quad(c, corner, u, v, material);
}

static void put_house(city *c, const double middle[2], uint32_t x, uint32_t z) {
    static const uint32_t whole[2] = {1, 1};
    const uint32_t floors = 3 + choice(x, z, 0, 6), windows = 4 + choice(x, z, 1, 3);
    const uint32_t cuts[2] = {2 * windows + 1, 2 * floors + 1};
    const uint32_t wall = MATERIAL_WALLS + choice(x, z, 2, MATERIAL_COUNT - MATERIAL_WALLS);
    const double height = 3.2 * floors, cornice = 0.4;
    put_walls(c, middle, 0, house, height, cuts, wall);
    put_walls(c, middle, height, house + 0.6, cornice, whole, MATERIAL_METAL);
    put_flat(c, middle, house + 0.6, height + cornice, MATERIAL_ROOF);
    if (choice(x, z, 3, 2)) {
        put_walls(c, middle, height + cornice, 0.25, 7, whole, MATERIAL_METAL);
        put_flat(c, middle, 0.25, height + cornice + 7, MATERIAL_METAL);
    }
}

static gw_code set_light(gw_scene *scene, gw_error *error) {
    gw_code code = gw_allocate((void **)&scene->lights, 1, sizeof *scene->lights, "city", error);
    if (code)
        return code;
    scene->light_count = 1;
    scene->lights[0] =
        (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.48, -0.8, -0.36}, .color = {2.2f, 2.1f, 1.9f}};
    for (int k = 0; k < 3; k++) {
        scene->ambient[k] = 0.5f + 0.1f * (float)k;
        scene->background[k] = 0.3f + 0.2f * (float)k;
    }
    return GW_OK;
}

static gw_code make(city *c, uint32_t side) {
    gw_scene *scene = c->scene;
    char name[64];
    snprintf(name, sizeof name, "city of %u houses", side * side);
    scene->path = gw_copy_text(name);
    c->code = scene->path ? GW_OK : gw_fail(c->error, GW_MACHINE, "memory is out while making a city");
    if (!c->code)
        c->code = gw_allocate((void **)&scene->materials, MATERIAL_COUNT, sizeof *scene->materials, "city",
                              c->error);
    if (!c->code)
        c->code = set_light(scene, c->error);
    if (c->code)
        return c->code;
    scene->material_count = MATERIAL_COUNT;
    for (int i = 0; i < MATERIAL_COUNT; i++)
        scene->materials[i] = materials[i];
    const double ground[2] = {0, 0};
    put_flat(c, ground, lot * side, 0, MATERIAL_STREET);
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t x = 0; x < side; x++) {
            const double middle[2] = {lot * (x - 0.5 * (side - 1)), lot * (z - 0.5 * (side - 1))};
            put_house(c, middle, x, z);
        }
    return c->code ? c->code : gw_scene_finish(scene, c->points, c->error);
}

gw_code gw_city_scene(uint32_t side, gw_scene **out, gw_error *error) {
    city c = {.error = error};
    *out = NULL;
    if (side < 2 || side > 64)
        return gw_fail(error, GW_BAD_INPUT, "a city has 2 to 64 houses a side, not %u", side);
    gw_code code = gw_allocate((void **)&c.scene, 1, sizeof *c.scene, "a city", error);
    if (!code)
        code = make(&c, side);
    free(c.points);
    if (code)
        gw_scene_destroy(&c.scene);
    *out = c.scene;
    return code;
}
