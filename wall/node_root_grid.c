/* A grid above the shipped nodes, see node_forms.h. */
#include "wall/node_forms.h"

#include "base/memory.h"
#include "render/root_grid.h"
#include "shaders/bench/node_forms.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

typedef struct grid_entry {
    uint32_t word, bits;
} grid_entry;

/* What the shipped grid's entry (shaders/common/shared.h) says, in this form's words. The scale of an empty
 * cell is its own here and that of the cell above it there. */
static grid_entry entry_of(gw_node node) {
    const uint32_t kind = GW_NODE_KIND(node.bits), valid = GW_NODE_VALID(node.bits);
    const uint32_t scale = node.bits >> GW_GRID_ENTRY_SCALE_SHIFT;
    if (kind == GW_KIND_INNER && !valid)
        return (grid_entry){0, scale - 1};
    return (grid_entry){kind == GW_KIND_INNER ? node.link << 8 | valid : node.link,
                        scale | GW_GRID_PRESENT | kind << 16};
}

gw_code gw_form_root_grid(const gw_octree *octree, uint32_t level, gw_node_form *out, gw_error *error) {
    gw_node *nodes = NULL;
    grid_entry *entries = NULL;
    memset(out, 0, sizeof *out);
    if (level < 1 || level >= octree->depth)
        return gw_fail(error, GW_MACHINE, "a root grid of level %u needs an octree deeper than %u levels",
                       level, octree->depth);
    if (octree->node_count > 1u << 24)
        return gw_fail(error, GW_MACHINE, "a root grid's entries address 2^24 nodes, the octree has %u",
                       octree->node_count);
    size_t count = gw_root_grid_size(level);
    gw_code code = gw_allocate((void **)&nodes, count, sizeof *nodes, "the root grid", error);
    if (!code)
        code = gw_allocate((void **)&entries, count, sizeof *entries, "the root grid", error);
    if (!code) {
        gw_root_grid_fill(octree, level, nodes);
        for (size_t i = 0; i < count; i++)
            entries[i] = entry_of(nodes[i]);
    }
    free(nodes);
    if (code)
        return code;
    *out = (gw_node_form){.arrays = {{entries, count * sizeof *entries, GL_RG32UI, 4, GW_PART_GRID}},
                          .array_count = 1,
                          .voxels = octree->node_count};
    return GW_OK;
}

void gw_node_form_finish(gw_node_form *form) {
    for (int i = 0; i < GW_FORM_ARRAYS; i++)
        free(form->arrays[i].data);
    memset(form, 0, sizeof *form);
}
