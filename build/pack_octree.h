/* An octree as one flat block of bytes (build/block.h): what ranks share, every host maps read-only and
 * caches keep. Any thread. */
/* clang-format off */
/* The block, all numbers in the order of this machine's bytes; columns are offset, bytes, contents:
 *   0    8    "GWOCTREE"
 *   8    4    GW_OCTREE_BLOCK_VERSION
 *   12   4    sections, GW_OCTREE_SECTIONS
 *   16   8    size of the block in bytes
 *   24   16   hash of the octree (gw_octree.hash), high and low half
 *   40   4    depth limit
 *   44   4    nodes
 *   48   4    references
 *   52   68   first node of each level, 17 numbers of 4 bytes
 *   120  128  16 statistics of 8 bytes: pairs, overlap tests, inner, leaves, single leaves, leaves by K, by fan, by depth,
 *             cells refined as isolated, longest list, deepest level, parts, dense leaves, leaves by the
 *             memory budget, least gain, and a zero
 *   248       offset and size, 8 bytes each, of the sections, which follow at multiples of 64: nodes (8 bytes each),
 *             payloads (12), references (4), emissions (4 a node; empty where nothing emits light), boxes of dense leaves (32)
 */
/* clang-format on */
#ifndef GW_BUILD_PACK_OCTREE_H
#define GW_BUILD_PACK_OCTREE_H

#include "base/status.h"
#include "build/octree.h"

#include <stddef.h>

enum { GW_OCTREE_BLOCK_VERSION = 11, GW_OCTREE_SECTIONS = 5 };

/* Bytes that gw_pack_octree writes. */
size_t gw_pack_octree_size(const gw_octree *octree);
/* Fills block, which has gw_pack_octree_size bytes and is aligned to 16. */
void gw_pack_octree(const gw_octree *octree, void *block);

/* View of a block: arrays point into it and borrowed is set. The block must stay mapped and unchanged while
 * the view is used. Checks that every array lies inside the block and that the counts fit each other;
 * GW_BAD_INPUT. */
gw_code gw_unpack_octree(const void *block, size_t size, gw_octree *out, gw_error *error);

/* Every link, list and id stays inside its array, children lie behind their parents, so no walk can loop: for
 * blocks from outside. GW_BAD_INPUT. */
gw_code gw_octree_check_links(const gw_octree *octree, uint32_t triangle_count, gw_error *error);

#endif
