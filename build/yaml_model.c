#include "build/yaml_model.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/portable_math.h"
#include "build/demo_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const model_keys[] = {"file",   "up",        "unit",  "matrix",
                                         "rotate", "translate", "scale", "animation"};

typedef struct transform {
    double m[3][4];
} transform;

static transform multiply(const transform *a, const transform *b) {
    transform product;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            product.m[i][k] = a->m[i][0] * b->m[0][k] + a->m[i][1] * b->m[1][k] + a->m[i][2] * b->m[2][k] +
                              (k == 3 ? a->m[i][3] : 0.0);
    return product;
}

static transform scaling(double factor) {
    return (transform){{{factor, 0, 0, 0}, {0, factor, 0, 0}, {0, 0, factor, 0}}};
}

/* Quarter turns are exact, so that what was aligned with an axis stays so. */
static void turn(double degrees, double *cosine, double *sine) {
    const double quarter = fmod(degrees, 360.0) / 90.0;
    if (quarter == floor(quarter)) {
        static const double cosines[4] = {1, 0, -1, 0}, sines[4] = {0, 1, 0, -1};
        const int index = ((int)quarter + 4) % 4;
        *cosine = cosines[index];
        *sine = sines[index];
        return;
    }
    *cosine = gw_cos(degrees * GW_PI / 180.0);
    *sine = gw_sin(degrees * GW_PI / 180.0);
}

static transform rotation(int axis, double degrees) {
    const int y = (axis + 1) % 3, z = (axis + 2) % 3;
    transform result = scaling(1.0);
    double cosine, sine;
    turn(degrees, &cosine, &sine);
    result.m[y][y] = result.m[z][z] = cosine;
    result.m[y][z] = -sine;
    result.m[z][y] = sine;
    return result;
}

static gw_code read_unit(const gw_yaml_node *node, double *metres, gw_error *error) {
    static const struct {
        const char *name;
        double metres;
    } units[] = {{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"inch", 0.0254}};
    const char *text = gw_yaml_text(node);
    for (size_t i = 0; text && i < sizeof units / sizeof *units; i++)
        if (strcmp(text, units[i].name) == 0) {
            *metres = units[i].metres;
            return GW_OK;
        }
    char *end = NULL;
    if (text && *text)
        strtod(text, &end);
    if (!end || *end)
        return gw_yaml_fail(node, error,
                            "key 'unit': '%.40s' is not mm, cm, m, inch or the number of metres in a unit",
                            text ? text : "");
    return gw_yaml_number(node, "unit", 1e-12, 1e12, metres, error);
}

static gw_code read_up(const gw_yaml_node *node, transform *result, gw_error *error) {
    const char *text = gw_yaml_text(node);
    if (text && strcmp(text, "y") == 0)
        return GW_OK;
    if (!text || strcmp(text, "z") != 0)
        return gw_yaml_fail(node, error, "key 'up': '%.40s' is neither y nor z", text ? text : "");
    const transform z_up = rotation(0, -90.0);
    *result = multiply(&z_up, result);
    return GW_OK;
}

/* scale, then rotate about x, y and z, then translate. */
static gw_code read_steps(const gw_yaml_node *node, transform *result, gw_error *error) {
    const gw_yaml_node *scale = gw_yaml_find(node, "scale"), *rotate = gw_yaml_find(node, "rotate"),
                       *translate = gw_yaml_find(node, "translate");
    double factor = 1.0, degrees[3] = {0}, shift[3] = {0};
    gw_code code = scale ? gw_yaml_number(scale, "scale", 1e-9, 1e9, &factor, error) : GW_OK;
    if (code == GW_OK && rotate)
        code = gw_yaml_numbers(rotate, "rotate", 3, degrees, error);
    if (code == GW_OK && translate)
        code = gw_yaml_numbers(translate, "translate", 3, shift, error);
    if (code != GW_OK)
        return code;
    transform step = scaling(factor);
    *result = multiply(&step, result);
    for (int axis = 0; axis < 3; axis++) {
        step = rotation(axis, degrees[axis]);
        *result = multiply(&step, result);
    }
    for (int i = 0; i < 3; i++)
        result->m[i][3] += shift[i];
    return GW_OK;
}

static gw_code read_transform(const gw_yaml_node *node, transform *result, gw_error *error) {
    const gw_yaml_node *unit = gw_yaml_find(node, "unit"), *up = gw_yaml_find(node, "up"),
                       *matrix = gw_yaml_find(node, "matrix");
    double metres = 1.0;
    gw_code code = unit ? read_unit(unit, &metres, error) : GW_OK;
    if (code != GW_OK)
        return code;
    *result = scaling(metres);
    if (up)
        code = read_up(up, result, error);
    if (code != GW_OK)
        return code;
    if (!matrix)
        return read_steps(node, result, error);
    if (gw_yaml_find(node, "scale") || gw_yaml_find(node, "rotate") || gw_yaml_find(node, "translate"))
        return gw_yaml_fail(matrix, error,
                            "key 'matrix' cannot stand beside 'scale', 'rotate' or 'translate'");
    double numbers[12];
    code = gw_yaml_numbers(matrix, "matrix", 12, numbers, error);
    if (code != GW_OK)
        return code;
    transform given;
    memcpy(given.m, numbers, sizeof numbers);
    *result = multiply(&given, result);
    return GW_OK;
}

/* The embedded scene as a model like any other: its vertices in metres again. */
static gw_code load_demo(gw_source_model **out, gw_scene_given *given, gw_source_model *target,
                         gw_error *error) {
    gw_scene *scene = NULL;
    gw_source_model *model = NULL;
    gw_code code = gw_demo_scene(&scene, error);
    if (code == GW_OK)
        code = gw_source_model_create(&model, error);
    if (code != GW_OK)
        goto cleanup;
    gw_scene_destroy(&model->scene);
    model->scene = scene;
    scene = NULL;
    code = gw_allocate((void **)&model->world, model->scene->vertex_count, 3 * sizeof(double), "demo scene",
                       error);
    if (code != GW_OK)
        goto cleanup;
    for (size_t i = 0; i < (size_t)model->scene->vertex_count * 3; i++)
        model->world[i] =
            scalbn((double)model->scene->positions[i], model->scene->exponent) + model->scene->centre[i % 3];
    memcpy(target->scene->ambient, model->scene->ambient, sizeof target->scene->ambient);
    memcpy(target->scene->background, model->scene->background, sizeof target->scene->background);
    given->ambient = given->background = 1;
    *out = model;
    return GW_OK;
cleanup:
    gw_scene_destroy(&scene);
    gw_source_model_destroy(&model);
    return code;
}

/* In a scene of several models a note has to say which one it is about. */
static gw_code name_notes(gw_scene *scene, const char *file, gw_error *error) {
    for (size_t i = 0; i < scene->note_count; i++) {
        char *named = NULL;
        if (asprintf(&named, "%s: %s", gw_path_name(file), scene->notes[i]) < 0)
            return gw_fail(error, GW_MACHINE, "out of memory for a note on the scene");
        free(scene->notes[i]);
        scene->notes[i] = named;
    }
    return GW_OK;
}

static gw_code load_file(const gw_yaml_node *node, const char *name, const char *path,
                         const gw_import_options *options, gw_source_model **out, gw_error *error) {
    if (gw_path_has_extension(name, ".yaml") || gw_path_has_extension(name, ".yml"))
        return gw_yaml_fail(node, error, "key 'file': '%s' is a scene; scenes cannot contain scenes", name);
    gw_import_options own = *options;
    const gw_yaml_node *animation = gw_yaml_find(node, "animation");
    if (animation && !own.animation) {
        own.animation = gw_yaml_text(animation);
        if (!own.animation)
            return gw_yaml_fail(animation, error,
                                "key 'animation': a name, a number, all or none is expected");
    }
    char *folder = gw_path_folder(path);
    char *file = folder ? gw_path_join(folder, name) : NULL;
    gw_code code = file ? gw_import_model(file, &own, out, error)
                        : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code != GW_OK)
        gw_context(error, "%s:%d", path, gw_yaml_node_line(node));
    else
        code = name_notes((*out)->scene, file, error);
    if (code == GW_OK && !gw_yaml_find(node, "unit") && !gw_yaml_find(node, "up"))
        code = gw_import_note_units((*out)->scene, file, error);
    free(file);
    free(folder);
    return code;
}

static gw_code read_model(const gw_yaml_node *node, const char *path, const gw_import_options *options,
                          gw_source_model *target, gw_scene_given *given, gw_error *error) {
    transform place;
    gw_source_model *model = NULL;
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "models", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, model_keys, sizeof model_keys / sizeof *model_keys, error);
    if (code != GW_OK)
        return code;
    const gw_yaml_node *file = gw_yaml_find(node, "file");
    if (!file || !gw_yaml_text(file) || !*gw_yaml_text(file))
        return gw_yaml_fail(node, error, "key 'file' is missing: name the model file, or demo");
    code = read_transform(node, &place, error);
    if (code != GW_OK)
        return code;
    if (strcmp(gw_yaml_text(file), "demo") == 0)
        code = load_demo(&model, given, target, error);
    else
        code = load_file(node, gw_yaml_text(file), path, options, &model, error);
    if (code == GW_OK) {
        code = gw_source_model_transform(model, (const double(*)[4])place.m, error);
        if (code != GW_OK)
            gw_context(error, "%s:%d", path, gw_yaml_node_line(node));
    }
    if (code == GW_OK)
        code = gw_source_model_append(target, model, error);
    gw_source_model_destroy(&model);
    return code;
}

gw_code gw_yaml_read_models(const gw_yaml_node *root, const char *path, const gw_import_options *options,
                            gw_source_model *target, gw_scene_given *given, gw_error *error) {
    const gw_yaml_node *list = gw_yaml_find(root, "models");
    if (!list)
        return gw_yaml_fail(root, error, "key 'models' is missing: list at least one '- file: ...'");
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "models", error);
    if (code == GW_OK && gw_yaml_count(list) == 0)
        code = gw_yaml_fail(list, error, "key 'models': the list is empty");
    for (size_t i = 0; code == GW_OK && i < gw_yaml_count(list); i++)
        code = read_model(gw_yaml_item(list, i), path, options, target, given, error);
    return code;
}
