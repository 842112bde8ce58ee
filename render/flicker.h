/* Flicker: how much a sequence of pictures changes from frame to frame that its reference does not. Viewers
 * notice in the periphery what moves rather than what is blurred, so a foveated sequence is judged by its
 * temporal stability, too (Patney et al., Towards Foveated Rendering for Gaze-Tracked Virtual Reality, 2016).
 *
 * Per pixel and frame |(a_t - a_t-1) - (r_t - r_t-1)| in lightness (CIE 1976 L*, as a share of white's 100):
 * what moves as the reference does counts nothing, however fast. Pictures that were blurred as a viewer sees
 * them (render/acuity_filter.h) give the flicker that is seen. One sequence after another; any thread. */
#ifndef GW_RENDER_FLICKER_H
#define GW_RENDER_FLICKER_H

#include "base/image.h"
#include "base/status.h"

#include <stdint.h>

enum { GW_FLICKER_BINS = 4096, GW_FLICKER_PATCH = 16 /* px */ };

/* Zeroed before the first frame. */
typedef struct gw_flicker {
    uint32_t width, height, frames; /* frames seen since the last cut */
    float *error;                   /* owned: lightness minus the reference's, of the last frame */
    double sum;
    uint64_t bins[GW_FLICKER_BINS]; /* pixels by change, 0 to 2 */
    double largest, pop;
} gw_flicker;

/* All in shares of white's lightness; 0 for sequences of one frame. */
typedef struct gw_flicker_result {
    double mean;       /* over pixels and frames */
    double percentile; /* 99th, to 1/2048 */
    double largest;    /* of a pixel */
    double pop;        /* the largest jump of the mean of a patch of 16 x 16 px: whole things that pop */
} gw_flicker_result;

/* The next frame of both. GW_BAD_INPUT when sizes differ from each other's or the last frame's. */
gw_code gw_flicker_add(gw_flicker *flicker, const gw_image *reference, const gw_image *picture,
                       gw_error *error);
/* The next frame begins another sequence of the same size, whose changes are added to those so far. */
void gw_flicker_cut(gw_flicker *flicker);
gw_flicker_result gw_flicker_of(const gw_flicker *flicker);
void gw_flicker_finish(gw_flicker *flicker);

#endif
