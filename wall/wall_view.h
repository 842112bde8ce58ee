/* The whole wall in one window, as it hangs, with what there is to tell about it: a line of status below it,
 * a ring about the gaze, and, when asked for, a bird's-eye view of tiles, heads and gazes, and help. Thread
 * of the window's device. */
#ifndef GW_WALL_WALL_VIEW_H
#define GW_WALL_WALL_VIEW_H

#include "base/gl.h"
#include "render/frame_state.h"
#include "wall/layout.h"

typedef struct gw_wall_view gw_wall_view;

/* device and layout are borrowed. */
gw_code gw_wall_view_open(gw_gl *device, const gw_layout *layout, gw_wall_view **out, gw_error *error);
void gw_wall_view_close(gw_wall_view **view); /* before the device goes; accepts NULL */

/* A point of the window (px) as a share of the wall as it hangs, across and down: 0 to 1 where it is shown.
 */
void gw_wall_view_share(const gw_wall_view *view, const double point[2], double share[2]);

typedef struct gw_wall_view_content {
    const uint8_t *const *pixels; /* of each tile ([height][width][4]); NULL: it keeps its last picture */
    uint64_t lost;                /* bit i: tile i is lost and shown as such */
    const gw_frame_state *state;
    const char *status; /* one line */
    const char *help;   /* lines, or NULL */
    int birdseye, ring; /* 1: shown */
} gw_wall_view_content;
/* Draws and swaps. */
gw_code gw_wall_view_show(gw_wall_view *view, const gw_wall_view_content *content, gw_error *error);

#endif
