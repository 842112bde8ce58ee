/* Where a viewer's gaze ellipse meets the wall, as points of its picture with bezels. Plain values, host
 * only; any thread. */
#ifndef GW_WALL_LAYOUT_LOOK_H
#define GW_WALL_LAYOUT_LOOK_H

#include "render/frame_state.h"
#include "wall/layout.h"

#include <stddef.h>

enum { GW_RING_POINTS = 72 };

typedef struct gw_ring_point {
    double framed[2]; /* px */
} gw_ring_point;

/* The points of the ring that lie on tiles, at equal angles about the gaze; of tiles one behind the other the
 * nearest to the eye. Returns how many. */
size_t gw_gaze_ring(const gw_layout *layout, const gw_gaze *gaze, gw_ring_point out[GW_RING_POINTS]);

/* Where a ray from a point (mm) meets the wall: the tile, the position on the wall's picture with bezels
 * (px), and how many times `direction` away. Returns 0 when it meets none. */
int gw_layout_meet(const gw_layout *layout, const double origin[3], const double direction[3], uint32_t *tile,
                   double framed[2], double *distance);

/* The point of the picture without bezels (px) at a point of the one with them, or the nearest one: bezels
 * and what lies outside have none. */
void gw_layout_framed_pixel(const gw_layout *layout, const double framed[2], double pixel[2]);

#endif
