/* Exact Euclidean distance transform (Felzenszwalb & Huttenlocher, Distance Transforms of Sampled Functions,
 * Theory of Computing 8, 2012): how far every pixel is from the nearest marked one, in time linear in the
 * pixels. Any thread. */
#ifndef GW_RENDER_DISTANCE_TRANSFORM_H
#define GW_RENDER_DISTANCE_TRANSFORM_H

#include "base/status.h"

#include <stdint.h>

/* squares: [height][width] squared distances in px, between centres; INFINITY everywhere when no pixel is
 * marked. Sides are at most GW_IMAGE_MAXIMUM_SIDE, so squares are whole numbers that a double holds; as
 * floats they are exact to 4096 px and within 1e-7 beyond. */
gw_code gw_distance_transform(const uint8_t *marked, uint32_t width, uint32_t height, float *squares,
                              gw_error *error);

#endif
