/* Swap skew: by how much the moments differ at which the tiles presented one frame, on rank 0's clock. The
 * gate's release of the next frame is the order to present, so this is what a viewer can see of the software
 * gate. A tile that was late in a frame is not counted in it. One thread. */
#ifndef GW_WALL_SWAP_SKEW_H
#define GW_WALL_SWAP_SKEW_H

#include "base/status.h"

#include <jansson.h>
#include <stdint.h>

typedef struct gw_swap_frame {
    int64_t first, last; /* ns */
    uint32_t number, tiles;
} gw_swap_frame;

typedef struct gw_swap_skew {
    uint32_t frame_count; /* the last so many are kept */
    gw_swap_frame *frames;
    int64_t clock_error; /* ns, the largest of those that were told */
} gw_swap_skew;

gw_code gw_swap_skew_create(uint32_t frame_count, gw_swap_skew *out, gw_error *error);
void gw_swap_skew_finish(gw_swap_skew *skew);
void gw_swap_skew_note(gw_swap_skew *skew, uint32_t number, int64_t when, int64_t clock_error);

/* {median, p95, max} in ms over the frames that more than one tile presented, "frames" their number,
 * "clock_error" in ms; null when there are none. *median in ms, 0 when there are none. */
json_t *gw_swap_skew_json(const gw_swap_skew *skew, double *median, double *maximum);

#endif
