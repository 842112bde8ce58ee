/* The embedded demo scene, made by formula: see demo_scene.c. Any thread. */
#ifndef GW_BUILD_DEMO_SCENE_H
#define GW_BUILD_DEMO_SCENE_H

#include "base/status.h"
#include "build/scene.h"

/* Makes the whole scene (at least 200,000 triangles, textures, light, viewpoint, placement) and finishes it.
 * The result is the same, bit for bit, on every machine. */
gw_code gw_demo_scene(gw_scene **out, gw_error *error);

#endif
