#include "build/yaml_scene.h"

#include "base/file.h"
#include "base/yaml.h"
#include "build/demo_scene.h"
#include "build/import_internal.h"
#include "build/yaml_environment.h"
#include "build/yaml_light.h"
#include "build/yaml_model.h"
#include "build/yaml_view.h"

#include <stdlib.h>
#include <string.h>

static const char *const scene_keys[] = {"version",    "models",      "placement",  "lights", "ambient",
                                         "background", "environment", "viewpoints", "paths"};

static gw_code check_version(const gw_yaml_node *root, gw_error *error) {
    const gw_yaml_node *version = gw_yaml_find(root, "version");
    long number;
    if (!version)
        return gw_yaml_fail(root, error, "key 'version' is missing: write 'version: 1'");
    return gw_yaml_integer(version, "version", 1, 1, &number, error);
}

static gw_code read_color(const gw_yaml_node *node, const char *key, float out[3], gw_error *error) {
    double values[3];
    gw_code code = gw_yaml_numbers(node, key, 3, values, error);
    for (int i = 0; code == GW_OK && i < 3; i++) {
        if (values[i] < 0.0 || values[i] > 1e9)
            return gw_yaml_fail(node, error, "key '%s': %g is not in 0..1e9", key, values[i]);
        out[i] = (float)values[i];
    }
    return code;
}

static gw_code read_surroundings(const gw_yaml_node *root, const char *path, gw_scene *scene,
                                 gw_scene_given *given, gw_error *error) {
    const gw_yaml_node *ambient = gw_yaml_find(root, "ambient"),
                       *background = gw_yaml_find(root, "background");
    const gw_yaml_node *lights = gw_yaml_find(root, "lights");
    const gw_yaml_node *environment = gw_yaml_find(root, "environment");
    gw_code code = lights ? gw_yaml_read_lights(lights, scene, error) : GW_OK;
    if (code == GW_OK && environment)
        code = gw_yaml_read_environment(environment, path, &scene->environment, error);
    if (code == GW_OK && ambient)
        code = read_color(ambient, "ambient", scene->ambient, error);
    if (code == GW_OK && background)
        code = read_color(background, "background", scene->background, error);
    given->lights |= lights != NULL || environment != NULL || scene->light_count > 0;
    given->ambient |= ambient != NULL || environment != NULL;
    given->background |= background != NULL || environment != NULL;
    return code;
}

static gw_code read_scene(const gw_yaml_node *root, const char *path, const gw_import_options *options,
                          gw_source_model *model, gw_scene_given *given, gw_error *error) {
    gw_code code = gw_yaml_expect(root, GW_YAML_MAP, "scene", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(root, scene_keys, sizeof scene_keys / sizeof *scene_keys, error);
    if (code == GW_OK)
        code = check_version(root, error);
    if (code == GW_OK) /* cheap keys first: a slip there should not wait for the models */
        code = gw_yaml_read_views(root, model->scene, error);
    if (code == GW_OK)
        code = gw_yaml_read_models(root, path, options, model, given, error);
    if (code == GW_OK)
        code = read_surroundings(root, path, model->scene, given, error);
    return code;
}

gw_code gw_yaml_scene_load(const char *path, const gw_import_options *options, gw_scene **out,
                           gw_error *error) {
    gw_yaml *document = NULL;
    gw_source_model *model = NULL;
    gw_scene *scene = NULL;
    gw_scene_given given = {0};
    *out = NULL;
    gw_code code = gw_yaml_load(path, &document, error);
    if (code == GW_OK)
        code = gw_source_model_create(&model, error);
    if (code == GW_OK)
        code = read_scene(gw_yaml_root(document), path, options, model, &given, error);
    if (code == GW_OK) {
        code = gw_import_finish(&model, path, options, &scene, error);
        if (code != GW_OK)
            gw_context(error, "%s", path);
    }
    if (code == GW_OK)
        code = gw_scene_defaults(scene, &given, error);
    if (code == GW_OK)
        *out = scene;
    else
        gw_scene_destroy(&scene);
    gw_source_model_destroy(&model);
    gw_yaml_destroy(&document);
    return code;
}
