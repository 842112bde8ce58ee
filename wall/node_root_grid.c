/* A grid above the shipped nodes, see node_forms.h. */
#include "wall/node_forms.h"

#include "base/memory.h"
#include "shaders/bench/node_forms.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

typedef struct grid_entry {
    uint32_t word, bits;
} grid_entry;

typedef struct grid_builder {
    const gw_octree *octree;
    uint32_t level, side;
    grid_entry *entries;
} grid_builder;

/* A cell of some level down to the grid's. */
typedef struct grid_cell {
    uint32_t level, at[3];
} grid_cell;

static void fill_cell(const grid_builder *b, const grid_cell *cell, grid_entry entry) {
    uint32_t up = b->level - cell->level, side = 1u << up;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                size_t row = ((size_t)(cell->at[2] << up) + z) * b->side + (cell->at[1] << up) + y;
                b->entries[row * b->side + (cell->at[0] << up) + x] = entry;
            }
}

static void fill_below(const grid_builder *b, uint32_t index, const grid_cell *cell) {
    const gw_node *node = &b->octree->nodes[index];
    uint32_t kind = GW_NODE_KIND(node->bits), valid = GW_NODE_VALID(node->bits);
    if (kind != GW_KIND_INNER || cell->level == b->level) {
        uint32_t word = kind == GW_KIND_INNER ? node->link << 8 | valid : node->link;
        fill_cell(b, cell,
                  (grid_entry){word, (b->octree->depth - cell->level) | GW_GRID_PRESENT | kind << 16});
        return;
    }
    uint32_t child = node->link;
    for (uint32_t octant = 0; octant < 8; octant++) {
        grid_cell below = {cell->level + 1,
                           {cell->at[0] * 2 + (octant & 1u), cell->at[1] * 2 + (octant >> 1 & 1u),
                            cell->at[2] * 2 + (octant >> 2)}};
        if (valid >> octant & 1u)
            fill_below(b, child++, &below);
        else
            fill_cell(b, &below, (grid_entry){0, b->octree->depth - below.level});
    }
}

gw_code gw_form_root_grid(const gw_octree *octree, uint32_t level, gw_node_form *out, gw_error *error) {
    grid_builder b = {.octree = octree, .level = level, .side = 1u << level};
    memset(out, 0, sizeof *out);
    if (level < 1 || level >= octree->depth)
        return gw_fail(error, GW_MACHINE, "a root grid of level %u needs an octree deeper than %u levels",
                       level, octree->depth);
    if (octree->node_count > 1u << 24)
        return gw_fail(error, GW_MACHINE, "a root grid's entries address 2^24 nodes, the octree has %u",
                       octree->node_count);
    size_t count = (size_t)b.side * b.side * b.side;
    gw_code code = gw_allocate((void **)&b.entries, count, sizeof *b.entries, "the root grid", error);
    if (code)
        return code;
    fill_below(&b, 0, &(grid_cell){0, {0, 0, 0}});
    *out = (gw_node_form){.arrays = {{b.entries, count * sizeof *b.entries, GL_RG32UI, 4, GW_PART_GRID}},
                          .array_count = 1,
                          .voxels = octree->node_count};
    return GW_OK;
}

void gw_node_form_finish(gw_node_form *form) {
    for (int i = 0; i < GW_FORM_ARRAYS; i++)
        free(form->arrays[i].data);
    memset(form, 0, sizeof *form);
}
