/* An animation as one flat block of bytes (build/block.h), for the scene's block. Any thread. */
#ifndef GW_BUILD_PACK_ANIMATION_H
#define GW_BUILD_PACK_ANIMATION_H

#include "base/status.h"
#include "build/animation.h"

#include <stddef.h>

size_t gw_pack_animation_size(const gw_animation *animation);
/* Fills block, which has gw_pack_animation_size bytes and is aligned to 16. */
void gw_pack_animation(const gw_animation *animation, void *block);

/* A view of a block, whose bytes it borrows: they must stay as they are until gw_animation_destroy.
 * GW_BAD_INPUT when the block is not what gw_pack_animation made. */
gw_code gw_unpack_animation(const void *block, size_t size, gw_animation **out, gw_error *error);

#endif
