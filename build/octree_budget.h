/* The memory budget of the octree build: where refinement stops so that the arrays fit.
 *
 * The gain of refining a cell is pairs * 4^(15 - level): the triangle tests that its children may save, times
 * how many rays its face meets. A child's gain is a quarter of its parent's at most, so the cells with a gain
 * of at least g are a tree for every g. While a tree is refined, what each cell adds to the arrays is summed
 * by the bucket of its gain; from these sums follow the sizes of all the trees that stop earlier, and the
 * least g whose tree fits. Boxes over a list count as refining its leaf: they are
 * made where the leaf has the gain. Sums of parts add up, whatever the parts. Plain values; any thread. */
#ifndef GW_BUILD_OCTREE_BUDGET_H
#define GW_BUILD_OCTREE_BUDGET_H

#include <stdint.h>

enum { GW_BUDGET_BUCKETS = 929 }; /* sixteen to a doubling of the gain; the last is the root's */

/* Rows of the octree's arrays. */
typedef struct gw_octree_rows {
    int64_t nodes, references, boxes;
} gw_octree_rows;

typedef struct gw_octree_budget {
    gw_octree_rows added[GW_BUDGET_BUCKETS]; /* by refining the cells of the bucket */
} gw_octree_budget;

typedef struct gw_octree_allowance {
    uint64_t bytes;      /* of all arrays together */
    uint64_t texels;     /* of one array, as the driver reads it: a node, a reference, half a box */
    uint64_t node_bytes; /* of a node with its payload and emission */
} gw_octree_allowance;

/* Of refining a cell of the level that holds `pairs` triangles. */
uint64_t gw_octree_gain(uint32_t level, uint32_t pairs);

/* Pairs from which a cell of the level has the gain. */
uint32_t gw_octree_least_pairs(uint64_t gain, uint32_t level);

/* Adds what refining a cell of the level, or boxes over its list, adds; level 0 is the root, which is always
 * refined. */
void gw_octree_budget_add(gw_octree_budget *budget, uint32_t level, uint32_t pairs,
                          const gw_octree_rows *rows);
void gw_octree_budget_join(gw_octree_budget *sum, const gw_octree_budget *part);

/* The tree in which every cell of the counted one with a gain of at least `least_gain` is refined. */
gw_octree_rows gw_octree_budget_rows(const gw_octree_budget *budget, uint64_t least_gain);
int gw_octree_rows_fit(const gw_octree_rows *rows, const gw_octree_allowance *allowance);
uint64_t gw_octree_rows_bytes(const gw_octree_rows *rows, const gw_octree_allowance *allowance);

/* The least gain whose tree fits, 0 if all of it does; UINT64_MAX if not even the root's children do. */
uint64_t gw_octree_least_gain(const gw_octree_budget *budget, const gw_octree_allowance *allowance);

#endif
