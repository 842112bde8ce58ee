#include "build/octree_budget.h"

#include "build/gpu_types.h"

/* Buckets are floats of four bits: below 16 the gain itself, above its exponent and next four bits. */
enum { STEPS = 16, STEP_BITS = 4, ROOT = GW_BUDGET_BUCKETS - 1, DEEPEST = 15 };

uint64_t gw_octree_gain(uint32_t level, uint32_t pairs) {
    return (uint64_t)pairs << 2 * (DEEPEST - level);
}

uint32_t gw_octree_least_pairs(uint64_t gain, uint32_t level) {
    const uint32_t shift = 2 * (DEEPEST - level);
    const uint64_t pairs = (gain >> shift) + ((gain & ((UINT64_C(1) << shift) - 1)) != 0);
    return pairs < UINT32_MAX ? (uint32_t)pairs : UINT32_MAX;
}

static uint32_t bucket_of(uint64_t gain) {
    if (gain < STEPS)
        return (uint32_t)gain;
    const uint32_t exponent = 63u - (uint32_t)__builtin_clzll(gain) - STEP_BITS;
    return STEPS * (exponent + 1) + (uint32_t)(gain >> exponent) - STEPS;
}

/* The least gain of a bucket. */
static uint64_t gain_of(uint32_t bucket) {
    if (bucket < STEPS)
        return bucket;
    return (uint64_t)(STEPS + bucket % STEPS) << (bucket / STEPS - 1);
}

static void add(gw_octree_rows *sum, const gw_octree_rows *rows) {
    sum->nodes += rows->nodes;
    sum->references += rows->references;
    sum->boxes += rows->boxes;
}

void gw_octree_budget_add(gw_octree_budget *budget, uint32_t level, uint32_t pairs,
                          const gw_octree_rows *rows) {
    add(&budget->added[level == 0 ? (uint32_t)ROOT : bucket_of(gw_octree_gain(level, pairs))], rows);
}

void gw_octree_budget_join(gw_octree_budget *sum, const gw_octree_budget *part) {
    for (int i = 0; i < GW_BUDGET_BUCKETS; ++i)
        add(&sum->added[i], &part->added[i]);
}

/* The root and the reserved reference. */
static const gw_octree_rows bare = {.nodes = 1, .references = 1};

gw_octree_rows gw_octree_budget_rows(const gw_octree_budget *budget, uint64_t least_gain) {
    gw_octree_rows rows = bare;
    for (uint32_t i = 0; i < GW_BUDGET_BUCKETS; ++i)
        if (i == ROOT || gain_of(i) >= least_gain) /* all of a bucket or none: gains come from least_gain() */
            add(&rows, &budget->added[i]);
    return rows;
}

/* Sums of a part alone may be below zero: the cells above its own are another part's. */
static uint64_t at_least_none(int64_t rows) {
    return rows > 0 ? (uint64_t)rows : 0;
}

uint64_t gw_octree_rows_bytes(const gw_octree_rows *rows, const gw_octree_allowance *allowance) {
    return at_least_none(rows->nodes * (int64_t)allowance->node_bytes +
                         rows->references * (int64_t)sizeof(uint32_t) +
                         rows->boxes * (int64_t)sizeof(gw_box));
}

int gw_octree_rows_fit(const gw_octree_rows *rows, const gw_octree_allowance *allowance) {
    return gw_octree_rows_bytes(rows, allowance) <= allowance->bytes &&
           at_least_none(rows->nodes) <= allowance->texels &&
           at_least_none(rows->references) <= allowance->texels &&
           at_least_none(rows->boxes) <= allowance->texels / 2;
}

uint64_t gw_octree_least_gain(const gw_octree_budget *budget, const gw_octree_allowance *allowance) {
    uint64_t least = UINT64_MAX;
    gw_octree_rows rows = bare;
    /* Refining may also take boxes away, so a finer tree may fit where a coarser one does not: all are tried.
     */
    for (uint32_t i = GW_BUDGET_BUCKETS; i-- > 0;) {
        add(&rows, &budget->added[i]);
        if (gw_octree_rows_fit(&rows, allowance))
            least = gain_of(i);
    }
    return least;
}
