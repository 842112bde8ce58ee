/* See root_grid.h. */
#include "render/root_grid.h"

enum { FINEST_LEVEL = 6, ALIGNMENT = 2 /* nodes; buffers are rounded up to 16 bytes */ };

typedef struct grid_cell {
    uint32_t level, at[3];
} grid_cell;

typedef struct grid_fill {
    const gw_octree *octree;
    uint32_t level;
    gw_node *entries;
} grid_fill;

size_t gw_root_grid_size(uint32_t level) {
    return level > 0 ? (size_t)1 << 3 * level : 0;
}

uint32_t gw_root_grid_level(const gw_octree *octree) {
    uint32_t level = FINEST_LEVEL;
    while (level > 0 && (level >= octree->depth || gw_root_grid_size(level) * 2 > octree->node_count))
        level--;
    /* The largest octrees keep indices on the stack, which entries of a grid do not have; others put an
     * entry's index there. */
    return gw_root_grid_begin(octree) + gw_root_grid_size(level) <= 1u << 24 ? level : 0;
}

size_t gw_root_grid_begin(const gw_octree *octree) {
    return ((size_t)octree->node_count + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static void fill_cell(const grid_fill *fill, const grid_cell *cell, gw_node entry) {
    uint32_t up = fill->level - cell->level, side = 1u << up;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++) {
            size_t row = (((size_t)(cell->at[2] << up) + z) << fill->level) + (cell->at[1] << up) + y;
            for (uint32_t x = 0; x < side; x++)
                fill->entries[(row << fill->level) + (cell->at[0] << up) + x] = entry;
        }
}

/* At most as deep as the grid's level. */
static void fill_below(const grid_fill *fill, uint32_t index, const grid_cell *cell) {
    const gw_node *node = &fill->octree->nodes[index];
    const uint32_t scale = fill->octree->depth - cell->level;
    const uint32_t kind = GW_NODE_KIND(node->bits), valid = GW_NODE_VALID(node->bits);
    if (kind != GW_KIND_INNER || cell->level == fill->level) {
        uint32_t bits = kind << 16 | valid | scale << GW_GRID_ENTRY_SCALE_SHIFT;
        fill_cell(fill, cell, (gw_node){.link = node->link, .bits = bits});
        return;
    }
    uint32_t child = node->link;
    for (uint32_t octant = 0; octant < 8; octant++) {
        grid_cell below = {cell->level + 1,
                           {cell->at[0] * 2 + (octant & 1u), cell->at[1] * 2 + (octant >> 1 & 1u),
                            cell->at[2] * 2 + (octant >> 2)}};
        if (valid >> octant & 1u)
            fill_below(fill, child++, &below);
        else
            fill_cell(fill, &below, (gw_node){.bits = scale << GW_GRID_ENTRY_SCALE_SHIFT});
    }
}

void gw_root_grid_fill(const gw_octree *octree, uint32_t level, gw_node *out) {
    const grid_fill fill = {octree, level, out};
    fill_below(&fill, 0, &(grid_cell){0, {0, 0, 0}});
}
