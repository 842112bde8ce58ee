/* An octree held against its scene by brute force in double precision, without a GPU and without any of the
 * builder's code: what the builder must guarantee, computed the slow way. For small scenes: every leaf is
 * compared with every triangle. One thread. */
#ifndef GW_TESTS_SUPPORT_OCTREE_BRUTE_H
#define GW_TESTS_SUPPORT_OCTREE_BRUTE_H

#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"

/* GW_MACHINE names the first thing that is wrong:
 * - the arrays: levels, packed siblings in Morton order, one parent a node, lists end to end, rising ids;
 * - contents: a leaf lists every triangle that overlaps its closed cell, and none that stays clear of the
 *   cell by more than the builder's margin; a child that is missing overlaps nothing;
 * - rules: each inner cell would break a stopping rule as a leaf, each leaf obeys one. */
gw_code gw_brute_check_octree(const gw_scene *scene, const gw_octree *octree, const gw_settings *settings,
                              gw_error *error);

#endif
