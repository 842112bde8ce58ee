/* Refinement within the memory budget (build/octree_budget.h). */
#include "build/octree_internal.h"

#include <inttypes.h>

/* References of a cell that is a leaf. */
static int64_t list_of(uint32_t pairs) {
    return pairs > 1 ? pairs : 0;
}

void gw_octree_note(gw_octree_builder *builder, const gw_octree_refined *refined) {
    const uint32_t level = refined->level, most = (uint32_t)builder->settings->dense_leaf;
    /* Of levels that are not kept, all cells are the builder's own. */
    const uint32_t(*cells)[2] =
        level <= builder->split_level ? (const uint32_t(*)[2])builder->levels[level].cells : NULL;
    uint32_t end = refined->reference_end, child = refined->child_count;
    for (uint32_t i = refined->cell_count; i-- > 0;) {
        const int own = !cells || gw_octree_owns(builder, level, cells[refined->nodes[i]]);
        /* The root is never a leaf. */
        gw_octree_rows rows = {.references = level > 0 ? -list_of(refined->pairs[i]) : 0};
        while (child > refined->parents[i][0]) {
            const uint32_t *data = refined->children[--child], kind = GW_NODE_KIND(data[1]);
            const uint32_t length = kind == GW_KIND_INNER  ? data[0]
                                    : kind == GW_LEAF_LIST ? end - data[0]
                                                           : 1;
            const gw_octree_rows boxes = {.boxes = (int64_t)gw_octree_boxes_of(length, most)};
            end = kind == GW_LEAF_LIST ? data[0] : end;
            rows.nodes++;
            rows.references += list_of(length);
            if (own && kind == GW_LEAF_LIST && boxes.boxes > 0)
                gw_octree_budget_add(&builder->budget, level + 1, length, &boxes);
        }
        if (own)
            gw_octree_budget_add(&builder->budget, level, refined->pairs[i], &rows);
    }
}

static void say_budget(const gw_octree_builder *builder, const gw_octree_rows *all,
                       const gw_octree_rows *rows) {
    const double mebibyte = 1048576.0;
    gw_log_write(builder->log, GW_LOG_WARNING,
                 "the octree would take %.1f MiB, %" PRId64 " nodes and %" PRId64 " references: %" PRIu64
                 " cells that gain least are not refined, it takes %.1f MiB "
                 "(octree_memory, or what this driver reads: %" PRIu64 " of each)",
                 (double)gw_octree_rows_bytes(all, &builder->allowance) / mebibyte, all->nodes,
                 all->references, builder->statistics.stopped_budget,
                 (double)gw_octree_rows_bytes(rows, &builder->allowance) / mebibyte,
                 builder->allowance.texels);
}

gw_code gw_octree_refine_within(gw_octree_builder *builder, gw_error *error) {
    gw_code code = gw_octree_refine(builder, error);
    if (code != GW_OK)
        return code;
    const uint64_t least = gw_octree_least_gain(&builder->budget, &builder->allowance);
    if (least == 0 && !builder->counting)
        return GW_OK;
    const gw_octree_rows all = gw_octree_budget_rows(&builder->budget, 0),
                         coarsest = gw_octree_budget_rows(&builder->budget, UINT64_MAX),
                         rows = gw_octree_budget_rows(&builder->budget, least);
    if (least == UINT64_MAX)
        return gw_fail(
            error, GW_MACHINE,
            "the octree takes %.3f MiB already with one level, octree_memory allows %g; raise it, or "
            "reduce the model",
            (double)gw_octree_rows_bytes(&coarsest, &builder->allowance) / 1048576.0,
            builder->settings->octree_memory);
    gw_octree_builder_clear(builder);
    builder->least_gain = least;
    builder->may_count = 0;
    code = gw_octree_refine(builder, error);
    if (code == GW_OK && least > 0)
        say_budget(builder, &all, &rows);
    return code;
}
