/* A scene and rays that are hard for a traversal. Random from a seed, the same everywhere; memory that is out
 * ends the test. */
#ifndef GW_TESTS_SUPPORT_RAYS_H
#define GW_TESTS_SUPPORT_RAYS_H

#include "build/scene.h"
#include "render/renderer.h"

#include <stddef.h>
#include <stdint.h>

/* A bumpy closed sphere, a finely cut floor, a wall exactly in a cell plane and small things. */
gw_scene *gw_test_scene(uint64_t seed);

/* Any rays, from outside, from corners of cells and from vertices; at vertices and edges, along axes and
 * diagonals, with zero and tiny components. free() them. */
gw_ray *gw_test_rays(const gw_scene *scene, size_t count, uint64_t seed);

#endif
