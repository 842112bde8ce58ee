/* How bright a picture is: counts of its pixels by luminance, in linear light before exposure
 * (shaders/blend/tone.glsl). Integers, so counts of parts add up to those of the whole in any order and any
 * split. Plain values; any thread. */
#ifndef GW_RENDER_LUMINANCE_H
#define GW_RENDER_LUMINANCE_H

#include "build/gpu_types.h"
#include "shaders/common/frame.h"

#include <stdint.h>

typedef struct gw_luminance {
    uint32_t counts[GW_LUMINANCE_BINS]; /* [0]: black, or as good as */
} gw_luminance;

/* Counts stay at the most that they can hold. */
void gw_luminance_add(gw_luminance *to, const gw_luminance *from);
uint64_t gw_luminance_pixels(const gw_luminance *luminance);
/* Mean of log2 of the luminance, without black, the darkest tenth and the brightest twentieth of the rest.
 * Returns 0, and leaves *mean, when all is black. */
int gw_luminance_mean(const gw_luminance *luminance, double *mean);

#endif
