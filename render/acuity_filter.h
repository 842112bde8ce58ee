/* What viewers can tell of a picture: every pixel is blurred so far that only periods remain which the
 * sharpest viewer resolves there (docs/rendering.md, "Gaze"; Guenter et al. 2012). Two pictures that are
 * equal behind this filter look equal to everybody whose gaze lies in its ellipsoid. Any thread. */
#ifndef GW_RENDER_ACUITY_FILTER_H
#define GW_RENDER_ACUITY_FILTER_H

#include "base/image.h"
#include "base/status.h"
#include "render/frame_block.h"

/* The picture shows the block's plane from pixel (0, 0) on. out gets its size; release it with
 * gw_image_finish. Blurs in linear light. A picture that nobody looks at is copied. */
gw_code gw_acuity_filter(const gw_image *picture, const gw_frame_block *block, gw_image *out,
                         gw_error *error);

#endif
