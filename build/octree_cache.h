/* Octrees on disk, so that a scene is refined once: one sealed file (base/sealed_file.h) per (scene, BUILD
 * settings) that holds the octree's block (build/pack_octree.h). What is refused is built again. One thread
 * per call; no GL. */
#ifndef GW_BUILD_OCTREE_CACHE_H
#define GW_BUILD_OCTREE_CACHE_H

#include "base/hash.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"

#include <stdint.h>

/* What names an octree: the scene's content, every BUILD setting and the version of the block. */
gw_hash gw_octree_cache_key(const gw_scene *scene, const gw_settings *settings);

/* folder/octree-<key>.gwo; free() it. NULL when memory is out. */
char *gw_octree_cache_path(const char *folder, gw_hash key);

/* Reads and checks one file. GW_BAD_INPUT tells why it was refused; *out is then NULL. The structure is
 * checked for memory safety (every link, list and id in range), its sense by the hash. */
gw_code gw_octree_cache_load(const char *path, gw_hash key, const gw_scene *scene, gw_octree **out,
                             gw_error *error);

/* Writes the file, making the folder; then removes the least recently used other files of the cache until
 * they are within limit bytes (0: no limit). GW_NO_OUTPUT when it cannot be written. */
gw_code gw_octree_cache_store(const char *path, gw_hash key, const gw_octree *octree, uint64_t limit,
                              gw_error *error);

#endif
