/* A checked scene as one flat block of bytes (build/block.h): what ranks share, every host maps read-only and
 * caches keep.
 *
 * The block holds what the builder and the renderer need - not camera paths, notes or counts of dropped
 * triangles, which stay with rank 0. Reading it back checks every offset, size and index before use. Any
 * thread. */
#ifndef GW_BUILD_PACK_SCENE_H
#define GW_BUILD_PACK_SCENE_H

#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>

/* Bytes that gw_pack_scene writes. */
size_t gw_pack_scene_size(const gw_scene *scene);
/* Fills block, which has gw_pack_scene_size bytes and is aligned to 16. */
void gw_pack_scene(const gw_scene *scene, void *block);

/* View of a block: arrays point into it. The block must stay mapped and unchanged until finish, and must be
 * treated as read-only although the scene's pointers are not const. */
typedef struct gw_unpacked_scene {
    gw_scene scene;
    gw_texture *textures; /* owned; their pixels are the block's */
} gw_unpacked_scene;

/* GW_BAD_INPUT when the block is not what gw_pack_scene made. block is aligned to 16. */
gw_code gw_unpack_scene(const void *block, size_t size, gw_unpacked_scene *out, gw_error *error);
void gw_unpacked_scene_finish(gw_unpacked_scene *unpacked);

#endif
