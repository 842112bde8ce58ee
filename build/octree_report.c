#include "build/octree_report.h"

#include <string.h>

enum { FIRST_CLASSES = 4 }; /* one for each of the first lengths */

static uint32_t class_of(uint32_t length) {
    uint32_t list_class = length - 1;
    if (length <= FIRST_CLASSES)
        return list_class;
    for (list_class = FIRST_CLASSES; length > 1u << (list_class - 1); list_class++) {
    }
    return list_class;
}

void gw_list_class_range(uint32_t list_class, uint32_t range[2]) {
    const int exact = list_class < FIRST_CLASSES;
    range[0] = exact ? list_class + 1 : (1u << (list_class - 2)) + 1;
    range[1] = exact ? list_class + 1 : 1u << (list_class - 1);
}

static uint32_t list_length(const gw_octree *octree, gw_node node) {
    const uint32_t first = gw_octree_first_reference(octree, &node);
    uint32_t length = 1;
    while (first > 0 && !(octree->references[first + length - 1] & GW_REFERENCE_LAST))
        length++;
    return length;
}

void gw_octree_report_make(const gw_octree *octree, gw_octree_report *out) {
    memset(out, 0, sizeof *out);
    for (uint32_t level = 0; level <= octree->depth; level++)
        for (uint32_t i = octree->level_begin[level]; i < octree->level_begin[level + 1]; i++) {
            gw_octree_level_report *here = &out->levels[level];
            out->level_count = level + 1;
            if (GW_NODE_KIND(octree->nodes[i].bits) == GW_KIND_INNER) {
                here->inner++;
                continue;
            }
            const uint32_t length = list_length(octree, octree->nodes[i]), list_class = class_of(length);
            here->leaves++;
            here->triangles += length;
            out->lists[list_class]++;
            out->list_classes = out->list_classes > list_class ? out->list_classes : list_class + 1;
        }
}
