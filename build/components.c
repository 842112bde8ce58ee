#include "build/components.h"

#include "base/memory.h"

/* Disjoint sets with path halving; the least vertex is the root. */
static uint32_t find_root(uint32_t *parent, uint32_t v) {
    while (parent[v] != v) {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

gw_code gw_components(const gw_scene *scene, uint32_t **out, gw_error *error) {
    gw_code code = gw_allocate((void **)out, scene->welded_count, sizeof **out, "components", error);
    uint32_t *parent = *out;
    if (code != GW_OK)
        return code;
    for (uint32_t v = 0; v < scene->welded_count; v++)
        parent[v] = v;
    for (uint32_t t = 0; t < scene->triangle_count; t++)
        for (int k = 1; k < 3; k++) {
            const uint32_t a = find_root(parent, scene->welded[scene->triangles[t][0]]);
            const uint32_t b = find_root(parent, scene->welded[scene->triangles[t][k]]);
            if (a < b)
                parent[b] = a;
            else
                parent[a] = b;
        }
    for (uint32_t v = 0; v < scene->welded_count; v++)
        parent[v] = find_root(parent, v);
    return GW_OK;
}
