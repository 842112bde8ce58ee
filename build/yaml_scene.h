/* YAML scenes: models with units, axes and transforms, placement, lights, surroundings, viewpoints, camera
 * paths. The keys are described in docs/scenes.md. */
#ifndef GW_BUILD_YAML_SCENE_H
#define GW_BUILD_YAML_SCENE_H

#include "base/status.h"
#include "build/import.h"
#include "build/scene.h"

gw_code gw_yaml_scene_load(const char *path, const gw_import_options *options, gw_scene **out,
                           gw_error *error);

#endif
