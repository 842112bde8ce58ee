/* A city: streets of houses with windows, cornices and aerials, made by formula, for measuring what happens
 * to details far smaller than a pixel. The same number gives the same scene, bit for bit. Any thread. */
#ifndef GW_WALL_CITY_H
#define GW_WALL_CITY_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* side x side houses (2 to 64) on lots of 20 m, about 1,000 triangles each. Free with gw_scene_destroy. */
gw_code gw_city_scene(uint32_t side, gw_scene **out, gw_error *error);

#endif
