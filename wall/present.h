/* Presentation: a tile's finished pixels on its panel, in two steps, so that all tiles can swap together.
 *
 * stage() puts a frame into the back buffer of the tile's window, with the panel's correction
 * (wall/panel_correction.h) applied last; show() swaps. A headless tile has the do-nothing twin: the same
 * calls, and nothing is seen. Main thread of a rank. */
#ifndef GW_WALL_PRESENT_H
#define GW_WALL_PRESENT_H

#include "base/gl.h"
#include "wall/site.h"

#include <stdint.h>

typedef struct gw_present gw_present;

/* Of a tile of width x height px on the device; without a window of the device's own it is the twin. */
gw_code gw_present_open(gw_gl *device, const gw_panel *panel, uint32_t width, uint32_t height,
                        gw_present **out, gw_error *error);
void gw_present_close(gw_present **present); /* before its device goes; accepts NULL */

/* The panel as another site has it: from the next frame on, its gamma, white point and brightness. */
gw_code gw_present_take_panel(gw_present *present, const gw_panel *panel, gw_error *error);

/* rgba: [height][width][4], sRGB. Does not wait. NULL stands for the twin in all of these. */
gw_code gw_present_stage(gw_present *present, const uint8_t *rgba, gw_error *error);
/* Shows what was staged last. Returns when it was handed over (gw_now_ns clock), as near to the swap as a
 * program can tell. */
int64_t gw_present_show(gw_present *present);
/* 1 when something can be seen of it. */
int gw_present_is_seen(const gw_present *present);

#endif
