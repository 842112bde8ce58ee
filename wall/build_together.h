/* Building the octree by several ranks before frame 1: rank 0 chooses who builds, every builder makes its
 * part (build/octree_part.h) on its own device, rank 0 collects and joins the parts. The bytes are the same
 * however many build. Collective over all ranks; before frame 1 only. */
#ifndef GW_WALL_BUILD_TOGETHER_H
#define GW_WALL_BUILD_TOGETHER_H

#include "base/gl.h"
#include "base/log.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/octree_part.h"
#include "build/scene.h"

#include <stdint.h>

/* What tests make a rank pretend. */
typedef enum gw_builder_fault { GW_BUILDER_SOUND, GW_BUILDER_FOREIGN, GW_BUILDER_FAILING } gw_builder_fault;

typedef struct gw_together_options {
    const gw_settings *settings;
    const gw_log *log;
    uint32_t builders; /* at most so many ranks build; 0: one of every machine, because the ranks of a machine
                          share its GPU */
    int machine;       /* world rank of this machine's first rank */
    int64_t deadline;  /* gw_now_ns clock */
    gw_builder_fault fault;
    int fault_rank;
} gw_together_options;

/* Who built what; filled on rank 0. */
typedef struct gw_together {
    uint32_t part_count;
    int ranks[GW_OCTREE_MAXIMUM_PARTS];              /* that built the parts */
    uint64_t overlap_tests[GW_OCTREE_MAXIMUM_PARTS]; /* the work of each */
    uint32_t split_level;
} gw_together;

/* Rank 0 receives the octree, or says with needed = 0 that it has one already, and nobody builds. Ranks whose
 * driver differs from rank 0's do not take part, and the part of a rank that fails is built by rank 0: both
 * are said in its log. */
gw_code gw_build_together(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                          int needed, gw_octree **octree, gw_together *who, gw_error *error);

#endif
