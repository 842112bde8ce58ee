#include "build/mesh_sides.h"

#include "base/memory.h"

gw_code gw_mesh_sides(const gw_scene *scene, gw_keyed **out, gw_error *error) {
    const size_t count = (size_t)scene->triangle_count * 3;
    gw_code code = gw_allocate((void **)out, count, sizeof **out, "mesh edges", error);
    for (uint32_t t = 0; code == GW_OK && t < scene->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const uint64_t a = scene->welded[scene->triangles[t][k]];
            const uint64_t b = scene->welded[scene->triangles[t][(k + 1) % 3]];
            (*out)[(size_t)t * 3 + (size_t)k] =
                (gw_keyed){a < b ? a << 32 | b : b << 32 | a, t << 1 | (a < b)};
        }
    return code == GW_OK ? gw_radix_sort(*out, count, error) : code;
}
