/* The 'lights' of a YAML scene. */
#ifndef GW_BUILD_YAML_LIGHT_H
#define GW_BUILD_YAML_LIGHT_H

#include "base/yaml.h"
#include "build/scene.h"

/* Replaces the scene's lights by those of the list, which may be empty. */
gw_code gw_yaml_read_lights(const gw_yaml_node *list, gw_scene *scene, gw_error *error);

#endif
