/* What is laid over the picture of the wall in its window: the line of status, the bird's-eye view, the help.
 * Drawn on the host, at `scale` px a dot of the text. Any thread. */
#ifndef GW_WALL_WALL_VIEW_PANELS_H
#define GW_WALL_WALL_VIEW_PANELS_H

#include "base/image.h"
#include "render/frame_state.h"
#include "wall/layout.h"

#include <stdint.h>

uint32_t gw_status_height(uint32_t scale); /* px */
/* Fills the image: `text`, as much of it as fits. */
void gw_status_draw(gw_image *image, uint32_t scale, const char *text);
void gw_help_draw(gw_image *image, uint32_t scale, const char *text);
/* From above, the wall at the top and the room below it: tiles as they hang, the rendering eye, every
 * viewer's eye and where each looks. */
void gw_birdseye_draw(gw_image *image, uint32_t scale, const gw_layout *layout, const gw_frame_state *state);

#endif
