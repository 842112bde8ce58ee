#include "build/yaml_light.h"

#include "base/memory.h"
#include "base/portable_math.h"

#include <math.h>
#include <stdlib.h>

typedef struct kind_row {
    const char *name;
    gw_light_kind kind;
} kind_row;

static const kind_row kinds[] = {{"directional", GW_LIGHT_DIRECTIONAL},
                                 {"point", GW_LIGHT_POINT},
                                 {"spot", GW_LIGHT_SPOT},
                                 {"rectangle", GW_LIGHT_RECTANGLE}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Keys that only some kinds know: a bit for each kind. */
typedef struct key_row {
    const char *name;
    unsigned kinds;
} key_row;

static const key_row some_know[] = {
    {"angle", 1u << GW_LIGHT_DIRECTIONAL},
    {"range", 1u << GW_LIGHT_POINT | 1u << GW_LIGHT_SPOT},
    {"radius", 1u << GW_LIGHT_POINT | 1u << GW_LIGHT_SPOT},
    {"direction", 1u << GW_LIGHT_SPOT},
    {"cone", 1u << GW_LIGHT_SPOT},
    {"width", 1u << GW_LIGHT_RECTANGLE},
    {"height", 1u << GW_LIGHT_RECTANGLE},
};

static const double degree = GW_PI / 180.0;

static gw_code read_kind(const gw_yaml_node *node, const kind_row **kind, gw_error *error) {
    *kind = NULL;
    for (size_t i = 0; i < KINDS; i++) {
        if (!gw_yaml_find(node, kinds[i].name))
            continue;
        if (*kind)
            return gw_yaml_fail(node, error, "a light is either '%s' or '%s', not both", (*kind)->name,
                                kinds[i].name);
        *kind = &kinds[i];
    }
    if (!*kind)
        return gw_yaml_fail(node, error,
                            "a light needs one of 'directional', 'point', 'spot' and 'rectangle'");
    for (size_t i = 0; i < sizeof some_know / sizeof some_know[0]; i++)
        if (gw_yaml_find(node, some_know[i].name) && !(some_know[i].kinds & 1u << (*kind)->kind))
            return gw_yaml_fail(node, error, "key '%s': a light that is '%s' has none", some_know[i].name,
                                (*kind)->name);
    return GW_OK;
}

/* Absent keys leave the value. */
static gw_code read_number(const gw_yaml_node *node, const char *key, double least, double most,
                           double *value, gw_error *error) {
    const gw_yaml_node *found = gw_yaml_find(node, key);
    return found ? gw_yaml_number(found, key, least, most, value, error) : GW_OK;
}

static gw_code read_vector(const gw_yaml_node *node, const char *key, double out[3], gw_error *error) {
    const gw_yaml_node *found = gw_yaml_find(node, key);
    if (!found)
        return gw_yaml_fail(node, error, "key '%s' is missing: three numbers are wanted", key);
    gw_code code = gw_yaml_numbers(found, key, 3, out, error);
    for (int i = 0; code == GW_OK && i < 3; i++)
        if (!(fabs(out[i]) <= 1e15))
            code = gw_yaml_fail(found, error, "key '%s': %g is not in -1e15..1e15", key, out[i]);
    return code;
}

static gw_code read_direction(const gw_yaml_node *node, const char *key, double out[3], gw_error *error) {
    gw_code code = read_vector(node, key, out, error);
    const double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    if (code == GW_OK && !(length > 0.0))
        code = gw_yaml_fail(node, error, "key '%s': the direction has no length", key);
    for (int i = 0; code == GW_OK && i < 3; i++)
        out[i] /= length;
    return code;
}

static gw_code read_color(const gw_yaml_node *node, gw_light *light, gw_error *error) {
    const gw_yaml_node *found = gw_yaml_find(node, "color");
    double color[3] = {1, 1, 1}, intensity = 1.0;
    gw_code code = found ? gw_yaml_numbers(found, "color", 3, color, error) : GW_OK;
    if (code == GW_OK)
        code = read_number(node, "intensity", 0.0, 1e9, &intensity, error);
    for (int i = 0; code == GW_OK && i < 3; i++) {
        if (!(color[i] >= 0.0 && color[i] <= 1e9))
            return gw_yaml_fail(node, error, "key 'color': %g is not in 0..1e9", color[i]);
        light->color[i] = (float)(color[i] * intensity);
    }
    return code;
}

static gw_code read_spot(const gw_yaml_node *node, gw_light *light, gw_error *error) {
    const gw_yaml_node *cone = gw_yaml_find(node, "cone");
    double axis[3], angles[2] = {0.0, 45.0};
    gw_code code = read_direction(node, "direction", axis, error);
    if (code == GW_OK && cone)
        code = gw_yaml_numbers(cone, "cone", 2, angles, error);
    if (code == GW_OK && !(angles[0] >= 0.0 && angles[0] < angles[1] && angles[1] <= 90.0))
        code = gw_yaml_fail(node, error,
                            "key 'cone': half-angles [inner, outer] in degrees with 0 <= inner < outer <= 90 "
                            "are wanted, not [%g, %g]",
                            angles[0], angles[1]);
    for (int i = 0; code == GW_OK && i < 3; i++)
        light->axis[i] = (float)axis[i];
    light->cone[0] = (float)(angles[0] * degree);
    light->cone[1] = (float)(angles[1] * degree);
    return code;
}

static gw_code read_rectangle(const gw_yaml_node *node, gw_light *light, gw_error *error) {
    static const char *const names[2] = {"width", "height"};
    double sides[2][3] = {{0}};
    gw_code code = GW_OK;
    for (int i = 0; code == GW_OK && i < 2; i++)
        code = read_vector(node, names[i], sides[i], error);
    for (int i = 0; code == GW_OK && i < 3; i++) {
        light->sides[0][i] = (float)sides[0][i];
        light->sides[1][i] = (float)sides[1][i];
    }
    if (code == GW_OK && !(gw_light_area(light) > 0.0))
        code = gw_yaml_fail(node, error, "keys 'width' and 'height': the rectangle has no area");
    return code;
}

static gw_code read_light(const gw_yaml_node *node, gw_light *light, gw_error *error) {
    static const char *const keys[] = {"directional", "point", "spot",  "rectangle", "color",
                                       "intensity",   "angle", "range", "radius",    "direction",
                                       "cone",        "width", "height"};
    const kind_row *kind;
    double range = 0.0, radius = 0.0, angle = 0.0;
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "lights", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    if (code == GW_OK)
        code = read_kind(node, &kind, error);
    if (code != GW_OK)
        return code;
    light->kind = kind->kind;
    code = kind->kind == GW_LIGHT_DIRECTIONAL ? read_direction(node, kind->name, light->vector, error)
                                              : read_vector(node, kind->name, light->vector, error);
    if (code == GW_OK)
        code = read_color(node, light, error);
    if (code == GW_OK)
        code = read_number(node, "range", 1e-6, 1e9, &range, error);
    if (code == GW_OK)
        code = read_number(node, "radius", 0.0, 1e6, &radius, error);
    if (code == GW_OK)
        code = read_number(node, "angle", 0.0, 90.0, &angle, error);
    light->range = (float)range;
    light->extent = (float)(kind->kind == GW_LIGHT_DIRECTIONAL ? 0.5 * angle * degree : radius);
    if (code == GW_OK && kind->kind == GW_LIGHT_SPOT)
        code = read_spot(node, light, error);
    if (code == GW_OK && kind->kind == GW_LIGHT_RECTANGLE)
        code = read_rectangle(node, light, error);
    return code;
}

gw_code gw_yaml_read_lights(const gw_yaml_node *list, gw_scene *scene, gw_error *error) {
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "lights", error);
    if (code != GW_OK)
        return code;
    free(scene->lights);
    scene->lights = NULL;
    scene->light_count = 0;
    code = gw_allocate((void **)&scene->lights, gw_yaml_count(list), sizeof *scene->lights, "lights", error);
    for (size_t i = 0; code == GW_OK && i < gw_yaml_count(list); i++) {
        code = read_light(gw_yaml_item(list, i), &scene->lights[i], error);
        if (code == GW_OK)
            scene->light_count++;
    }
    return code;
}
