/* The 'environment' of a YAML scene: a picture of all directions. */
#ifndef GW_BUILD_YAML_ENVIRONMENT_H
#define GW_BUILD_YAML_ENVIRONMENT_H

#include "base/yaml.h"
#include "build/scene.h"

/* path: of the YAML file, from whose folder the picture's name counts. */
gw_code gw_yaml_read_environment(const gw_yaml_node *node, const char *path, gw_environment *out,
                                 gw_error *error);

#endif
