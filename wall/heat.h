/* Where and how strongly two pictures differ, as a picture. Any thread. */
#ifndef GW_WALL_HEAT_H
#define GW_WALL_HEAT_H

#include "base/image.h"
#include "base/status.h"

/* FLIP as colours: black 0 over red and yellow to white 1. *mean: over all pixels. Release out with
 * gw_image_finish. */
gw_code gw_heat_picture(const gw_image *reference, const gw_image *picture, double pixels_per_degree,
                        gw_image *out, double *mean, gw_error *error);

#endif
