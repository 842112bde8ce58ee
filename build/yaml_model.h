/* The 'models' of a YAML scene: loaded, turned, scaled and merged. */
#ifndef GW_BUILD_YAML_MODEL_H
#define GW_BUILD_YAML_MODEL_H

#include "base/yaml.h"
#include "build/import.h"
#include "build/import_internal.h"
#include "build/source_model.h"

/* Appends every model of root's list to `target`. given: what the embedded demo scene brings besides
 * geometry. */
gw_code gw_yaml_read_models(const gw_yaml_node *root, const char *path, const gw_import_options *options,
                            gw_source_model *target, gw_scene_given *given, gw_error *error);

#endif
