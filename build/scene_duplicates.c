#include "build/scene_duplicates.h"

#include "base/memory.h"
#include "build/components.h"
#include "build/mesh_sides.h"
#include "build/scene_order.h"
#include "build/weld.h"

#include <stdlib.h>
#include <string.h>

/* Of a component, at its least vertex. */
enum { OPEN_WITH = 1, OPEN_WITHOUT = 2 };

typedef struct search {
    gw_scene *scene;
    const uint8_t *marked;
    gw_scene mesh;          /* a view of the scene with positions welded: triangles and welded only */
    uint32_t *component_of; /* [mesh.welded_count] */
    uint8_t *openness;      /* [mesh.welded_count] */
} search;

static gw_code weld_positions(search *self, const uint32_t *rows, uint32_t row_count, gw_error *error) {
    uint32_t *positions = NULL;
    gw_code code = gw_allocate((void **)&positions, row_count, GW_POSITION_WORDS * sizeof *positions,
                               "positions", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->mesh.welded, row_count, sizeof *self->mesh.welded,
                           "welded positions", error);
    for (size_t row = 0; code == GW_OK && row < row_count; row++)
        memcpy(positions + row * GW_POSITION_WORDS, rows + row * GW_VERTEX_WORDS,
               GW_POSITION_WORDS * sizeof *positions);
    if (code == GW_OK)
        code = gw_weld(positions, row_count, GW_POSITION_WORDS, self->mesh.welded, &self->mesh.welded_count,
                       error);
    free(positions);
    return code;
}

/* Which components are open with and without the marked triangles: along some edge more triangles run one way
 * than the other. */
static gw_code find_openness(search *self, gw_error *error) {
    const size_t count = (size_t)self->scene->triangle_count * 3;
    gw_keyed *sides = NULL;
    gw_code code = gw_allocate((void **)&self->openness, self->mesh.welded_count, 1, "components", error);
    if (code == GW_OK)
        code = gw_components(&self->mesh, &self->component_of, error);
    if (code == GW_OK)
        code = gw_mesh_sides(&self->mesh, &sides, error);
    for (size_t begin = 0, end; code == GW_OK && begin < count; begin = end) {
        int64_t with = 0, without = 0;
        for (end = begin; end < count && sides[end].key == sides[begin].key; end++) {
            const int way = sides[end].value & 1u ? 1 : -1;
            with += way;
            without += self->marked[sides[end].value >> 1] ? 0 : way;
        }
        self->openness[self->component_of[sides[begin].key >> 32]] |=
            (uint8_t)((with ? OPEN_WITH : 0) | (without ? OPEN_WITHOUT : 0));
    }
    free(sides);
    return code;
}

static void drop(const search *self) {
    gw_scene *scene = self->scene;
    uint32_t kept = 0;
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
        const uint32_t component = self->component_of[self->mesh.welded[scene->triangles[t][0]]];
        if (self->marked[t] && self->openness[component] != OPEN_WITHOUT)
            continue;
        memmove(scene->triangles[kept], scene->triangles[t], sizeof *scene->triangles);
        scene->material_of[kept++] = scene->material_of[t];
    }
    scene->dropped.duplicate += scene->triangle_count - kept;
    scene->triangle_count = kept;
}

gw_code gw_scene_drop_duplicates(gw_scene *scene, const uint32_t *rows, uint32_t row_count,
                                 const uint8_t *marked, gw_error *error) {
    search self = {.scene = scene, .marked = marked};
    if (scene->triangle_count == 0 || !memchr(marked, 1, scene->triangle_count))
        return GW_OK;
    self.mesh.triangles = scene->triangles;
    self.mesh.triangle_count = scene->triangle_count;
    gw_code code = weld_positions(&self, rows, row_count, error);
    if (code == GW_OK)
        code = find_openness(&self, error);
    if (code == GW_OK)
        drop(&self);
    free(self.mesh.welded);
    free(self.component_of);
    free(self.openness);
    return code;
}
