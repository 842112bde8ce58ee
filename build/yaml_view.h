/* The 'placement', 'viewpoints' and 'paths' of a YAML scene. */
#ifndef GW_BUILD_YAML_VIEW_H
#define GW_BUILD_YAML_VIEW_H

#include "base/yaml.h"
#include "build/scene.h"

gw_code gw_yaml_read_views(const gw_yaml_node *root, gw_scene *scene, gw_error *error);

#endif
