/* What the stages of the octree build share; private to build/octree*.c. One thread, the one that owns the GL
 * device. */
#ifndef GW_BUILD_OCTREE_INTERNAL_H
#define GW_BUILD_OCTREE_INTERNAL_H

#include "build/octree.h"

#include <stddef.h>
#include <stdint.h>

/* One level while it grows: parts are refined depth first in Morton order, so appending keeps every level in
 * order. */
typedef struct gw_octree_level {
    size_t node_count, node_capacity, cell_capacity;
    gw_node *nodes;       /* link: child or reference index relative to its level until assembly */
    uint32_t (*cells)[2]; /* x | y << 16, z */
    size_t reference_count, reference_capacity;
    uint32_t *references;
} gw_octree_level;

typedef struct gw_octree_builder {
    gw_gl *device;
    const gw_scene *scene;
    const gw_settings *settings;
    const gw_log *log;
    uint32_t depth;
    uint64_t pair_limit;    /* pairs in one buffer */
    uint64_t cell_limit;    /* cells refined at once */
    gw_gl_buffer triangles; /* RGBA32F, 3 texels: vertices; w: component's longest side, its triangles, 0 */
    gw_gl_buffer topology;  /* RGBA32UI: three welded vertices, component */
    gw_octree_level levels[GW_OCTREE_MAXIMUM_DEPTH + 1];
    gw_octree_statistics statistics;
} gw_octree_builder;

/* Allocates nodes, payloads and references by octree's counts, all zero. */
gw_code gw_octree_allocate(gw_octree *octree, gw_error *error);

/* Uploads triangles and topology. */
gw_code gw_octree_upload(gw_octree_builder *builder, gw_error *error);

/* Fills levels 0..depth of builder->levels. */
gw_code gw_octree_refine(gw_octree_builder *builder, gw_error *error);

/* Joins the levels into octree's arrays (nodes, references, level_begin); payloads are allocated and zero. */
gw_code gw_octree_assemble(const gw_octree_builder *builder, gw_octree *octree, gw_error *error);

/* Computes octree->payloads from the leaves up; builder->levels[].cells must still be there. */
gw_code gw_octree_payload(gw_octree_builder *builder, gw_octree *octree, gw_error *error);

#endif
