/* What a rank draws on: the window of its tile, the window of the whole wall (rank 0), or a device without a
 * window. Main thread of a rank. */
#ifndef GW_WALL_RANK_DEVICE_H
#define GW_WALL_RANK_DEVICE_H

#include "base/status.h"

struct gw_rank;

/* 1 if this rank is to have a window: its device is then opened first of all, so that a display that is not
 * there is told before the scene is read. */
int gw_rank_has_window(const struct gw_rank *rank);
/* Opens rank->model.device unless it is open. */
gw_code gw_rank_open_device(struct gw_rank *rank, gw_error *error);
/* Answers the window system for the window of this rank, if it has one. */
void gw_rank_attend(struct gw_rank *rank);

#endif
