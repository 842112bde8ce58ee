/* What the stages of the octree build share; private to build/octree*.c. One thread, the one that owns the GL
 * device. */
#ifndef GW_BUILD_OCTREE_INTERNAL_H
#define GW_BUILD_OCTREE_INTERNAL_H

#include "build/octree.h"
#include "build/octree_budget.h"

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

/* What the payload's kernels read besides positions and normals: the same for every pose of a scene. */
typedef struct gw_payload_inputs {
    gw_gl_buffer faces, materials, chains, texels, thresholds;
    int ready;
} gw_payload_inputs;

typedef struct gw_octree_builder {
    gw_gl *device;
    const gw_scene *scene;
    const gw_settings *settings;
    const gw_log *log;
    uint32_t depth;
    uint64_t pair_limit;      /* pairs in one buffer */
    uint64_t cell_limit;      /* cells refined at once */
    gw_gl_buffer triangles;   /* RGBA32F, 3 texels: vertices; w: component's longest side, its triangles, 0 */
    gw_gl_buffer topology;    /* RGBA32UI: three welded vertices, component */
    gw_payload_inputs inputs; /* made when they are first asked for */
    gw_octree_level levels[GW_OCTREE_MAXIMUM_DEPTH + 1];
    gw_octree_statistics statistics;
    gw_octree_budget budget; /* of the cells that it owns */
    gw_octree_allowance allowance;
    uint64_t least_gain;          /* cells of less are not refined */
    int may_count;                /* 1: what does not fit is counted and not kept */
    int counting;                 /* 1: so it was; the levels below the split level are empty */
    uint32_t split_level;         /* level at which the cells of parts lie */
    uint64_t key_first, key_last; /* this builder's cells there: Morton numbers [first, last) */
} gw_octree_builder;

/* The Morton number of a cell as levels[].cells stores it: bit 0 is x's lowest, bit 1 y's, bit 2 z's. */
uint64_t gw_octree_cell_key(const uint32_t cell[2]);

/* Whether a node of this level and cell belongs to the builder's part: above the split level, the part that
 * has the first of the cell's descendants owns the cell; below it, all that the builder has is its own. */
int gw_octree_owns(const gw_octree_builder *builder, uint32_t level, const uint32_t cell[2]);

/* A builder for the whole tree, nothing uploaded yet; release with gw_octree_builder_finish. */
void gw_octree_builder_init(gw_octree_builder *builder, gw_gl *device, const gw_scene *scene,
                            const gw_octree_options *options);
void gw_octree_builder_finish(gw_octree_builder *builder);

/* Makes it ready to refine once more. */
void gw_octree_builder_clear(gw_octree_builder *builder);

/* Makes it ready for another build, of the same scene in another pose; keeps inputs and the levels' room. */
void gw_octree_builder_reset(gw_octree_builder *builder, const gw_scene *scene);
/* Nothing when they are there. */
gw_code gw_payload_inputs_make(gw_octree_builder *builder, gw_error *error);
void gw_payload_inputs_finish(gw_payload_inputs *inputs);

/* All stages of a build of the whole tree, into an empty octree or one that is built again. */
gw_code gw_octree_run(gw_octree_builder *builder, gw_octree *octree, gw_error *error);

/* Makes nodes, payloads and references of octree's counts, all zero; what is there is used again where it has
 * room. */
gw_code gw_octree_allocate(gw_octree *octree, gw_error *error);

/* Uploads triangles and topology. */
gw_code gw_octree_upload(gw_octree_builder *builder, gw_error *error);

/* Fills levels 0..depth of builder->levels by builder->least_gain, or counts only. */
gw_code gw_octree_refine(gw_octree_builder *builder, gw_error *error);

/* A run of cells of one level that has been refined, as the kernels leave it. */
typedef struct gw_octree_refined {
    uint32_t level, cell_count, child_count;
    const uint32_t *pairs;         /* [cell_count] */
    const uint32_t *nodes;         /* [cell_count] in the level */
    const uint32_t (*children)[4]; /* link or, of inner ones, pairs; bits; cell */
    const uint32_t (*parents)[2];  /* first child */
    uint32_t reference_end;        /* where the last list of the children ends */
} gw_octree_refined;

/* Notes in builder->budget what refining the cells adds to the tree. An inner child counts as a leaf: what
 * refining it adds is noted then. */
void gw_octree_note(gw_octree_builder *builder, const gw_octree_refined *refined);

/* The same for the whole tree within the memory budget: again with a greater least_gain if need be. */
gw_code gw_octree_refine_within(gw_octree_builder *builder, gw_error *error);

/* Whether a material that some triangle has emits light. */
int gw_octree_emits(const gw_scene *scene);

/* Joins the levels into octree's arrays (nodes, references, level_begin); payloads are allocated and zero. */
gw_code gw_octree_assemble(const gw_octree_builder *builder, gw_octree *octree, gw_error *error);

/* Which levels' payloads are computed, from the lower one up; below and above them other parts of the build
 * did it or will. */
typedef struct gw_payload_range {
    uint32_t deepest, highest; /* levels, deepest >= highest */
    const void *sums_below; /* of all nodes of level deepest + 1, or NULL where the range begins at leaves */
    void **sums_above;      /* receives the sums of all nodes of level highest, to be freed; or NULL */
    size_t *sum_bytes;      /* receives the bytes of one node's sums; or NULL */
} gw_payload_range;

/* Computes octree->payloads of the range's levels; builder->levels[].cells must still be there for its
 * leaves. */
gw_code gw_octree_payload(gw_octree_builder *builder, const gw_payload_range *range, gw_octree *octree,
                          gw_error *error);

/* What remains when nodes and payloads are there: boxes and hash. */
gw_code gw_octree_complete(const gw_octree_builder *builder, gw_octree *octree, gw_error *error);

/* Puts boxes over every list longer than most_triangles (0: over none), unless the memory budget forbids it
 * (octree->statistics.least_gain), and makes its leaf dense. The last
 * step before the hash: the payload stage knows plain lists only. */
gw_code gw_octree_add_boxes(const gw_scene *scene, uint32_t most_triangles, gw_octree *octree,
                            gw_error *error);
/* How many boxes it puts over a list of that length. */
uint64_t gw_octree_boxes_of(uint64_t length, uint32_t most_triangles);

#endif
