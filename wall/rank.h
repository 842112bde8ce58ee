/* One rank of the wall: a process that owns one tile, its GL device, its renderer and a view of the shared
 * octree. Rank 0 also imports, builds and conducts (wall/conductor.h). The thread that called MPI_Init. */
#ifndef GW_WALL_RANK_H
#define GW_WALL_RANK_H

#include "base/status.h"
#include "render/renderer.h"
#include "wall/build_together.h"
#include "wall/gate.h"
#include "wall/link.h"
#include "wall/model.h"
#include "wall/share.h"
#include "wall/sim_options.h"
#include "wall/site.h"

#include <stdint.h>

typedef struct gw_rank {
    gw_sim_options options;
    gw_site site;
    gw_link line;   /* to the launcher */
    gw_model model; /* rank 0: scene and octree until they are shared */
    gw_share share;
    gw_together together; /* rank 0: who built the octree */
    gw_renderer *renderer;
    int number;            /* rank, and index of its tile */
    int size;              /* ranks */
    int64_t load_deadline; /* gw_now_ns clock */
    uint8_t *pixels;       /* of its tile, [height][width][4] */
    uint8_t *eye_pixels;   /* of one eye, where the tile shows two; else NULL */
} gw_rank;

/* Draws this rank's tile for a release and writes its picture if the run has a folder for pictures. A failure
 * is told in done->code and done->text. */
void gw_rank_draw(gw_rank *rank, const gw_release *release, gw_done *done);

#endif
