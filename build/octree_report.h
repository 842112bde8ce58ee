/* The shape of a finished octree by level and by length of lists, and the bytes of its parts. Any thread. */
#ifndef GW_BUILD_OCTREE_REPORT_H
#define GW_BUILD_OCTREE_REPORT_H

#include "build/octree.h"

#include <stdint.h>

/* Leaves by number of triangles: 1, 2, 3, 4, 5 to 8, 9 to 16 and on in powers of two. */
enum { GW_LIST_CLASSES = 32 };

typedef struct gw_octree_level_report {
    uint64_t inner, leaves;
    uint64_t triangles; /* in the leaves of this level, once for every leaf that lists them */
} gw_octree_level_report;

typedef struct gw_octree_report {
    uint32_t level_count; /* levels that have nodes */
    gw_octree_level_report levels[GW_OCTREE_MAXIMUM_DEPTH + 1];
    uint64_t lists[GW_LIST_CLASSES];
    uint32_t list_classes; /* one past the last that is not empty */
} gw_octree_report;

void gw_octree_report_make(const gw_octree *octree, gw_octree_report *out);

/* Least and greatest number of triangles of a class. */
void gw_list_class_range(uint32_t list_class, uint32_t range[2]);

#endif
