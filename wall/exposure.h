/* Automatic exposure, equal on all tiles: rank 0 adds up what the tiles counted of their pixels' light
 * (render/luminance.h) and decides for the next frame. The decision travels, is recorded and is repeated with
 * the frame state.
 *
 * The mean of the picture's log-luminance is brought to exposure_key (after Reinhard and others, Photographic
 * Tone Reproduction for Digital Images, 2002). What is measured is light before exposure, so exposure moves
 * straight to where it belongs and never beyond; at most by exposure_speed, at once when something is known
 * for the first time or the frames' time stands still; it does not move for less than GW_EXPOSURE_REST.
 * Plain values; rank 0's thread. */
#ifndef GW_WALL_EXPOSURE_H
#define GW_WALL_EXPOSURE_H

#include "base/settings.h"
#include "render/frame_state.h"
#include "render/luminance.h"
#include "wall/layout.h"

#include <stdint.h>

#define GW_EXPOSURE_REST 0.05 /* stops */
#define GW_EXPOSURE_MOST 24.0 /* stops, either way */

typedef struct gw_exposure {
    int automatic;
    double key, speed;                    /* exposure_key; stops per second */
    double stops;                         /* in force */
    int known;                            /* it was measured before */
    int64_t time;                         /* ns, of the frame for which it was decided last */
    gw_luminance tiles[GW_MAXIMUM_TILES]; /* of each tile's last frame: a late or lost tile's stands */
} gw_exposure;

void gw_exposure_init(gw_exposure *exposure, const gw_settings *settings);
/* What one tile of so many pixels counted in its last frame. Returns 0, and keeps what was counted before, if
 * it claims more pixels than it can have. */
int gw_exposure_note(gw_exposure *exposure, uint32_t tile, const gw_luminance *luminance, uint64_t pixels);
/* Sets the state's exposure, from its time and what was noted; nothing unless exposure is auto. */
void gw_exposure_decide(gw_exposure *exposure, gw_frame_state *state);

#endif
