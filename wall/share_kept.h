/* Blocks of scenes and octrees that a machine keeps in its cache, by content (docs/running-a-wall.md): so
 * that the next run need not send them, and a tile that is started again needs nobody. Files are
 * FOLDER/block-KEY.gwb, sealed. Any thread. */
#ifndef GW_WALL_SHARE_KEPT_H
#define GW_WALL_SHARE_KEPT_H

#include "base/hash.h"
#include "base/log.h"
#include "base/sealed_file.h"
#include "base/status.h"
#include "wall/rejoin_message.h"
#include "wall/share.h"

#include <stdint.h>

/* Reads the block of that content into `block`: 1 when it is there with that size. folder may be NULL. */
int gw_kept_read(const char *folder, gw_hash key, void *block, size_t size, const gw_log *log);
/* 1 when there is such a file; it then counts as used now. */
int gw_kept_has(const char *folder, gw_hash key);
/* What cannot be written is a warning. */
void gw_kept_write(const char *folder, gw_hash key, const void *block, size_t size, uint64_t limit,
                   const gw_log *log);

/* A tile that was started again: fills share->scene and share->octree from this machine's cache alone.
 * GW_MACHINE when they are not there. */
gw_code gw_share_restore(gw_share *share, const char *folder, const gw_rejoin_keys *keys,
                         const gw_settings *settings, gw_error *error);

#endif
