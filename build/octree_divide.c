#include "build/octree_part.h"

#include "build/octree_internal.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So many cells of a surface a part, on the whole, make the ranges even. */
enum { CELLS_PER_PART = 1024, DEEPEST_SPLIT = 7 };
/* A triangle whose box covers more cells of the split level weighs about alike in every part and is left out.
 */
enum { CELLS_COUNTED = 64 };
/* A triangle is passed on until its cells are about its own size: by then few others share them. */
enum { WIDEST_SHARED = 3 };

/* A surface has about 4^level cells at a level. */
static uint32_t split_level_of(uint32_t part_count, uint32_t depth) {
    uint32_t level = 0;
    while (level < DEEPEST_SPLIT && level + 1 < depth &&
           (uint64_t)1 << (2 * level) < (uint64_t)part_count * CELLS_PER_PART)
        level++;
    return part_count > 1 ? level : 0;
}

/* A triangle's bounding box in cells of some level, both ends inclusive. */
typedef struct box {
    uint32_t low[3], high[3];
} box;

static uint32_t coordinate(float p, uint32_t side) {
    double place = floor(((double)p + 1) * 0.5 * side);
    return place < 0 ? 0 : place >= side ? side - 1 : (uint32_t)place;
}

static box box_of(const gw_scene *scene, uint32_t triangle, uint32_t side) {
    box b;
    for (int axis = 0; axis < 3; ++axis) {
        float least = 2, most = -2;
        for (int k = 0; k < 3; ++k) {
            float p = scene->positions[(size_t)scene->triangles[triangle][k] * 3 + (size_t)axis];
            least = p < least ? p : least;
            most = p > most ? p : most;
        }
        b.low[axis] = coordinate(least, side);
        b.high[axis] = coordinate(most, side);
    }
    return b;
}

/* The cells of the box, and the widest side in cells, `shift` levels above the level in which it is given. */
static uint64_t cells_of(const box *b, uint32_t shift, uint32_t *widest) {
    uint64_t cells = 1;
    *widest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        uint32_t side = (b->high[axis] >> shift) - (b->low[axis] >> shift) + 1;
        cells *= side;
        *widest = side > *widest ? side : *widest;
    }
    return cells;
}

/* Adds the pairs that the triangle will probably make below the split level to each cell there that it may
 * touch. */
static void count_triangle(const gw_scene *scene, uint32_t triangle, uint32_t level, uint32_t depth,
                           uint64_t *pairs) {
    const box b = box_of(scene, triangle, (uint32_t)1 << depth);
    const uint32_t split = depth - level;
    uint32_t widest;
    uint64_t cells = cells_of(&b, split, &widest), expected = cells;
    if (cells > CELLS_COUNTED)
        return;
    for (uint32_t shift = split; shift-- > 0 && widest < WIDEST_SHARED;)
        expected += cells_of(&b, shift, &widest);
    expected = (expected + cells - 1) / cells;
    for (uint32_t z = b.low[2] >> split; z <= b.high[2] >> split; ++z)
        for (uint32_t y = b.low[1] >> split; y <= b.high[1] >> split; ++y)
            for (uint32_t x = b.low[0] >> split; x <= b.high[0] >> split; ++x)
                pairs[gw_octree_cell_key((const uint32_t[2]){x | y << 16, z})] += expected;
}

/* Part p begins at the first cell before which p / part_count of all pairs lie. */
static void cut(const uint64_t *pairs, uint64_t cell_count, gw_octree_division *division) {
    uint64_t total = 0, before = 0;
    uint32_t part = 1;
    for (uint64_t i = 0; i < cell_count; ++i)
        total += pairs[i];
    for (uint64_t i = 0; i < cell_count; ++i) {
        while (part < division->part_count && before * division->part_count >= total * part)
            division->begin[part++] = i;
        division->pairs[part - 1] += pairs[i];
        before += pairs[i];
    }
    while (part <= division->part_count)
        division->begin[part++] = cell_count;
}

gw_code gw_octree_divide(const gw_scene *scene, const gw_settings *settings, uint32_t part_count,
                         gw_octree_division *out, gw_error *error) {
    uint64_t *pairs = NULL;
    memset(out, 0, sizeof *out);
    out->part_count = part_count;
    out->level = split_level_of(part_count, (uint32_t)settings->octree_depth);
    uint64_t cell_count = (uint64_t)1 << (3 * out->level);
    gw_code code = gw_allocate((void **)&pairs, (size_t)cell_count, sizeof *pairs, "pairs by cell", error);
    if (code)
        return code;
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        count_triangle(scene, t, out->level, (uint32_t)settings->octree_depth, pairs);
    cut(pairs, cell_count, out);
    free(pairs);
    return GW_OK;
}
