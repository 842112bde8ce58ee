/* FLIP: how different two pictures look when one is flipped to the other (Andersson et al., FLIP: A
 * Difference Evaluator for Alternating Images, HPG 2020; the version for low dynamic range). Opponent colours
 * are blurred by the eye's contrast sensitivity at a viewing distance, colours compared in L*a*b* with HyAB,
 * and differences at edges and points weigh more. Any thread. */
#ifndef GW_RENDER_FLIP_H
#define GW_RENDER_FLIP_H

#include "base/image.h"
#include "base/status.h"

/* Pixels per degree of a 0.7 m wide screen of 3840 pixels seen from 0.7 m: the paper's choice. */
#define GW_FLIP_PIXELS_PER_DEGREE 67.02064327658226

/* mean: 0 (equal) to 1, over all pixels. map: [height][width] of the same, or NULL. Alpha does not count.
 * GW_BAD_INPUT when the sizes differ or pixels_per_degree is not in 1..1000. */
gw_code gw_flip(const gw_image *reference, const gw_image *test, double pixels_per_degree, float *map,
                double *mean, gw_error *error);

/* A value of the map, 0..1, as black, red, yellow, white: opaque RGBA. */
void gw_flip_color(float value, uint8_t rgba[4]);

#endif
