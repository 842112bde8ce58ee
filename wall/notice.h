/* The notice: a picture that says which tile this is, on which host and rank, and why it shows nothing else:
 * grey while the tile waits for something, red when it ended. Never a frozen frame. Any thread. */
#ifndef GW_WALL_NOTICE_H
#define GW_WALL_NOTICE_H

#include "base/image.h"
#include "base/status.h"

#include <stdint.h>

typedef enum gw_notice_kind { GW_NOTICE_WAITS, GW_NOTICE_ENDED } gw_notice_kind;

/* Makes the picture; release it with gw_image_finish. */
gw_code gw_notice_draw(gw_notice_kind kind, uint32_t width, uint32_t height, const char *tile, int rank,
                       const char *reason, gw_image *out, gw_error *error);

#endif
