/* Octrees on disk, so that a scene is refined once: one zlib-compressed file per (scene, BUILD settings).
 *
 * A file that is cut, altered, of another version, codec, key or machine is refused with a reason, and the
 * octree is built again. Files are written under a temporary name and renamed, so two programs that store the
 * same octree at once do no harm. One thread per call; no GL. */
/* clang-format off */
/* The file, all numbers little-endian; columns are offset, bytes, contents:
 *   0    8    "GWOCTREE"
 *   8    4    format version, 2
 *   12   4    codec: 1 is zlib's deflate (RFC 1950); others are refused
 *   16   16   key, high and low half: hash of the scene, the BUILD settings and the format version
 *   32   16   hash of the octree (gw_octree.hash)
 *   48   4    depth limit
 *   52   4    nodes
 *   56   4    references
 *   60   4    statistics that follow, 16
 *   64   68   first node of each level, 17 numbers of 4 bytes
 *   132  4    1 if the stream holds emissions, else 0
 *   136  128  16 statistics of 8 bytes: pairs, overlap tests, inner, leaves, single leaves, leaves by K, by fan, by depth,
 *             cells refined as isolated, longest list, deepest level, parts, and four zeros
 *   264  8    size of the compressed stream in bytes
 *   272       the stream: nodes (8 bytes each), payloads (12), references (4), emissions (4)
 *   end  16   XXH3-128 of everything before, high and low half
 */
/* clang-format on */
#ifndef GW_BUILD_OCTREE_CACHE_H
#define GW_BUILD_OCTREE_CACHE_H

#include "base/hash.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"

#include <stdint.h>

/* What names an octree: the scene's content and every BUILD setting. */
gw_hash gw_octree_cache_key(const gw_scene *scene, const gw_settings *settings);

/* folder/octree-<key>.gwo; free() it. NULL when memory is out. */
char *gw_octree_cache_path(const char *folder, gw_hash key);

/* Reads and checks one file. GW_BAD_INPUT tells why it was refused; *out is then NULL. The structure is
 * checked for memory safety (every link, list and id in range), its sense by the hash. */
gw_code gw_octree_cache_load(const char *path, gw_hash key, const gw_scene *scene, gw_octree **out,
                             gw_error *error);

/* Writes the file, making the folder; then removes the least recently used other octrees until the folder's
 * files of this kind are within limit bytes (0: no limit). GW_NO_OUTPUT when it cannot be written. */
gw_code gw_octree_cache_store(const char *path, gw_hash key, const gw_octree *octree, uint64_t limit,
                              gw_error *error);

#endif
