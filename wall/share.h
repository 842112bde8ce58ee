/* Sharing the scene and its octree among the ranks before frame 1: one copy per machine, in a named POSIX
 * shared-memory segment that every rank of the machine maps read-only.
 *
 * The segment is /gazewall-<pid>-<nonce>, made by the machine's first rank and unlinked once all ranks there
 * have mapped it, so that from frame 1 on nothing of it can be left behind. What a killed run left is swept
 * by name and dead owner. Collective over all ranks; before frame 1 only. */
#ifndef GW_WALL_SHARE_H
#define GW_WALL_SHARE_H

#include "base/hash.h"
#include "base/log.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/pack_scene.h"
#include "build/scene.h"

#include <mpi.h>
#include <stddef.h>
#include <stdint.h>

/* A segment as this rank sees it. */
typedef struct gw_segment {
    void *block; /* mapped read-only, NULL before it is shared */
    size_t size;
    gw_hash key; /* rank 0: of its bytes, by which caches have it; zero when no cache needs it */
} gw_segment;

typedef struct gw_share {
    MPI_Comm machine; /* the ranks of this machine */
    MPI_Comm leaders; /* the first rank of each machine; MPI_COMM_NULL on the others */
    int is_leader;
    int leader;        /* world rank of this machine's first rank */
    int machine_count; /* known to the leaders */
    gw_segment scene_segment, octree_segment;
    gw_unpacked_scene scene;
    gw_octree octree;
} gw_share;

/* Finds out who shares a machine. Call right after MPI_Init, when all ranks arrive together. machines > 1
 * pretends that the ranks stand on so many machines, to test on one what several do. */
gw_code gw_share_init(gw_share *share, int machines, gw_error *error);

/* How blocks travel. */
typedef struct gw_share_options {
    int64_t deadline;     /* gw_now_ns clock */
    const char *cache;    /* folder in which machines other than rank 0's keep the blocks that they were sent,
                             by content, so that the next run need not send them; or NULL */
    uint64_t cache_limit; /* bytes */
    int restarts;         /* tiles may be started again: rank 0's machine keeps the scene, too */
    const gw_log *log;
} gw_share_options;

/* Rank 0 gives the scene, the others NULL; on return share->scene holds it on every rank. */
gw_code gw_share_scene(gw_share *share, const gw_scene *scene, const gw_share_options *options,
                       gw_error *error);

/* The same for the octree, in share->octree. */
gw_code gw_share_octree(gw_share *share, const gw_octree *octree, const gw_share_options *options,
                        gw_error *error);

void gw_share_finish(gw_share *share);

/* Removes segments of this user whose owner no longer lives; returns how many. */
int gw_share_sweep(void);

#endif
