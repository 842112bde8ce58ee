/* The hybrid triangle/voxel octree: host bytes, the GPU build, and the checks.
 *
 * The root cell is the cube [-1,1]^3 of rebased space; a cell at level l has side 2^(1-l) and integer
 * coordinates 0..2^l-1, its lower corner at coordinate * 2^(1-l) - 1 (exact in float). Nodes stand level by
 * level, within a level in Morton order of their cells; node 0 is the root. Node, payload and reference
 * encodings: shaders/common/shared.h. The bytes depend on the scene and the BUILD settings only, not on
 * parts, group sizes or memory limits. gw_octree_build needs a GL device on the calling thread; the rest is
 * plain host code. */
#ifndef GW_BUILD_OCTREE_H
#define GW_BUILD_OCTREE_H

#include "base/gl.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"

#include <stdint.h>

enum { GW_OCTREE_MAXIMUM_DEPTH = 15 };

/* What the build did: deterministic work counts, and times that are not. */
typedef struct gw_octree_statistics {
    uint64_t pairs;          /* (triangle, cell) pairs formed over all levels */
    uint64_t overlap_tests;  /* triangle against child cell */
    uint64_t inner, leaves;  /* nodes */
    uint64_t single_leaves;  /* leaves with one inline triangle */
    uint64_t stopped_small;  /* leaves by the K rule */
    uint64_t stopped_fan;    /* leaves by the fan rule */
    uint64_t stopped_depth;  /* leaves at the depth limit with more than K triangles */
    uint64_t stopped_budget; /* leaves that the memory budget kept from being refined */
    uint64_t least_gain; /* of cells that were refined (build/octree_budget.h); 0: all that the rules ask */
    uint64_t refined_isolated; /* cells refined only because of the isolation rule */
    uint64_t dense_leaves;     /* leaves whose list stands under boxes */
    uint32_t longest_list;     /* triangles in the fullest leaf */
    uint32_t deepest;          /* deepest level that has a node */
    uint32_t parts;            /* slices the build was cut into to stay below the driver's limits */
    double milliseconds[4];    /* refinement, payload of leaves, payload upwards, assembly and read-back */
} gw_octree_statistics;

typedef struct gw_octree {
    uint32_t depth; /* the depth limit it was built with */
    uint32_t node_count, reference_count, box_count;
    uint32_t
        level_begin[GW_OCTREE_MAXIMUM_DEPTH + 2]; /* first node of each level; [depth + 1] is node_count */
    uint32_t node_room, reference_room;           /* that the arrays have, where they are owned */
    gw_node *nodes;                               /* [node_count] */
    gw_payload *payloads;                         /* [node_count] */
    uint32_t *references;                         /* [reference_count], entry 0 reserved */
    gw_box *boxes;       /* [box_count] over the lists of dense leaves; NULL without any */
    uint32_t *emissions; /* [node_count] emitted radiance; NULL when no material in use emits light */
    gw_hash hash;        /* of depth and all arrays */
    int borrowed;        /* 1: the arrays belong to somebody else (a shared segment) or to the block */
    void *block;         /* owned; the arrays of an octree from the cache lie in it. NULL otherwise */
    gw_octree_statistics statistics;
} gw_octree;

/* part_limit caps the pairs handled at once (0: what the driver allows); tests use it to force parts. */
typedef struct gw_octree_options {
    const gw_settings *settings;
    uint64_t part_limit;
    uint64_t texel_limit; /* rows of one array (0: what the driver reads); for tests as well */
    const gw_log *log;
} gw_octree_options;

/* GW_MACHINE when it cannot fit: the text says how much is needed and which settings to lower. */
gw_code gw_octree_build(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                        gw_octree **out, gw_error *error);
void gw_octree_destroy(gw_octree **octree);

/* Builds of one scene in pose after pose, on one device. Every build's bytes are those of gw_octree_build for
 * that pose. Storage on the GPU is taken from the device's pool (gw_gl_pool_start) if it is on, arrays of the
 * host are used again while they have room. */
typedef struct gw_octree_rebuilder gw_octree_rebuilder;
gw_code gw_octree_rebuilder_create(gw_gl *device, const gw_octree_options *options, gw_octree_rebuilder **out,
                                   gw_error *error);
/* scene: the same at every call but for positions and normals. *out belongs to the rebuilder, until the next
 * call. */
gw_code gw_octree_rebuild(gw_octree_rebuilder *rebuilder, const gw_scene *scene, const gw_octree **out,
                          gw_error *error);
void gw_octree_rebuilder_destroy(gw_octree_rebuilder **rebuilder);

/* Every structural invariant, on the GPU (a debug shader): popcount and bases, siblings packed, list ends,
 * ids in range, every leaf's cell overlapped by its triangles, payload finite and conserving area. GW_MACHINE
 * names the first node that fails. */
gw_code gw_octree_validate(gw_gl *device, const gw_scene *scene, const gw_octree *octree, gw_error *error);

/* Index of the first reference of a leaf's list; 0 for nodes without one. */
uint32_t gw_octree_first_reference(const gw_octree *octree, const gw_node *node);

/* Sets octree->hash from its contents. */
void gw_octree_hash(gw_octree *octree);

/* Bytes of each array. */
uint64_t gw_octree_node_bytes(const gw_octree *octree);
uint64_t gw_octree_payload_bytes(const gw_octree *octree);
uint64_t gw_octree_reference_bytes(const gw_octree *octree);
uint64_t gw_octree_emission_bytes(const gw_octree *octree); /* 0 without emission */
uint64_t gw_octree_box_bytes(const gw_octree *octree);      /* 0 without dense leaves */
uint64_t gw_octree_bytes(const gw_octree *octree);          /* all of them together */

#endif
