/* A checked scene and its octree as one flat block of bytes: what ranks share and every host maps read-only.
 *
 * The block holds what the renderer needs - not camera paths, welded ids, notes or counts of dropped
 * triangles, which stay with rank 0. It has no pointers and the same bytes for the same input on one kind of
 * machine (it is not portable between byte orders). Reading it back checks every offset, size and index
 * before use. Any thread. */
#ifndef GW_BUILD_PACK_H
#define GW_BUILD_PACK_H

#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"

#include <stddef.h>

/* Bytes that gw_pack writes. */
size_t gw_pack_size(const gw_scene *scene, const gw_octree *octree);
/* Fills block, which has gw_pack_size bytes and is aligned to 16. */
void gw_pack(const gw_scene *scene, const gw_octree *octree, void *block);

/* Views of a block: arrays point into it. The block must stay mapped and unchanged until finish, and must be
 * treated as read-only although the structures' pointers are not const. */
typedef struct gw_unpacked {
    gw_scene scene;
    gw_octree octree;
    gw_texture *textures; /* owned; their pixels are the block's */
} gw_unpacked;

/* GW_BAD_INPUT when the block is not what gw_pack made. block is aligned to 16. */
gw_code gw_unpack(const void *block, size_t size, gw_unpacked *out, gw_error *error);
void gw_unpacked_finish(gw_unpacked *unpacked);

#endif
