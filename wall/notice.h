/* The notice: a red picture that says which tile this is, on which host and rank, and why it shows nothing
 * else. Never a frozen frame. Any thread. */
#ifndef GW_WALL_NOTICE_H
#define GW_WALL_NOTICE_H

#include "base/image.h"
#include "base/status.h"

#include <stdint.h>

/* Makes the picture; release it with gw_image_finish. */
gw_code gw_notice_draw(uint32_t width, uint32_t height, const char *tile, int rank, const char *reason,
                       gw_image *out, gw_error *error);

#endif
