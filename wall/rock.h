/* A rock: a closed surface with bumps of every size, made by formula at any number of triangles, for
 * measuring how work grows. The same number gives the same scene, bit for bit. Any thread. */
#ifndef GW_WALL_ROCK_H
#define GW_WALL_ROCK_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* A cube of 6 grids of n x n squares, blown up to a sphere and displaced; n is the smallest for which 12 n^2
 * is at least `triangles` (12 to 20 million). Free with gw_scene_destroy. */
gw_code gw_rock_scene(uint32_t triangles, gw_scene **out, gw_error *error);

#endif
