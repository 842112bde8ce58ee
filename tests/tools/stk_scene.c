#include "tests/tools/stk_scene.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/portable_math.h"
#include "tests/tools/xml.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Library nodes place library nodes; a ring of them must end. */
enum { DEEPEST_LIBRARY = 8, MOST_INSTANCES = 1 << 20 };
static const size_t largest_file = (size_t)256 << 20;

/* One scene.xml or node.xml while it is walked. */
typedef struct level {
    const char *folder;
    const xml_document *document;
    stk_matrix matrix; /* left-handed, as the files are */
    int depth;
} level;

static const stk_matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

gw_code stk_path(const char *folder, const char *name, char **out, gw_error *error) {
    *out = NULL;
    if (!name || !*name || name[0] == '.' || strchr(name, '/') || strchr(name, '\\'))
        return gw_fail(error, GW_BAD_INPUT, "'%.200s' is not the plain name of a file", name ? name : "");
    *out = gw_path_join(folder, name);
    return *out ? GW_OK : gw_fail(error, GW_MACHINE, "out of memory for a file name");
}

/* --- placing --- */

static stk_matrix multiply(const stk_matrix *a, const stk_matrix *b) {
    stk_matrix out;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            out.m[r][c] = c == 3 ? a->m[r][3] : 0.0;
            for (int k = 0; k < 3; k++)
                out.m[r][c] += a->m[r][k] * b->m[k][c];
        }
    return out;
}

/* Three numbers of an attribute, or `missing` where it is not there. */
static gw_code read_three(const xml_document *d, int32_t element, const char *name, double missing,
                          double out[3], gw_error *error) {
    const char *text = xml_attribute_of(d, element, name);
    for (int i = 0; i < 3; i++) {
        char *end = NULL;
        out[i] = text ? strtod(text, &end) : missing;
        if ((text && end == text) || !isfinite(out[i]))
            return gw_fail(error, GW_BAD_INPUT, "%s=\"%.100s\": three numbers are expected", name,
                           xml_attribute_of(d, element, name));
        text = text ? end : NULL;
    }
    return GW_OK;
}

/* translate(xyz) Rz(hpr.3) Ry(hpr.2) Rx(hpr.1) scale, degrees, for column vectors. */
static gw_code read_placing(const xml_document *d, int32_t element, stk_matrix *out, gw_error *error) {
    double shift[3], turn[3], scale[3];
    gw_code code = read_three(d, element, "xyz", 0.0, shift, error);
    if (code == GW_OK)
        code = read_three(d, element, "hpr", 0.0, turn, error);
    if (code == GW_OK)
        code = read_three(d, element, "scale", 1.0, scale, error);
    if (code != GW_OK)
        return code;
    double c[3], s[3];
    for (int i = 0; i < 3; i++) {
        c[i] = gw_cos(fmod(turn[i], 360.0) * (GW_PI / 180.0));
        s[i] = gw_sin(fmod(turn[i], 360.0) * (GW_PI / 180.0));
    }
    const double rotation[3][3] = {
        {c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
        {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
        {-s[1], c[1] * s[0], c[1] * c[0]}};
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++)
            out->m[r][k] = rotation[r][k] * scale[k];
        out->m[r][3] = shift[r];
    }
    return GW_OK;
}

/* --- models --- */

static gw_code load_model(const char *folder, char *path, stk_model *out, gw_error *error) {
    gw_bytes bytes = {0};
    *out = (stk_model){.folder = gw_copy_text(folder), .path = path};
    gw_code code =
        out->folder ? GW_OK : gw_fail(error, GW_MACHINE, "out of memory for the name of a mesh's folder");
    if (code == GW_OK)
        code = gw_file_read(path, largest_file, &bytes, error);
    if (code == GW_OK)
        code = stk_mesh_read(path, bytes.data, bytes.size, &out->mesh, error);
    gw_bytes_finish(&bytes);
    return code;
}

/* The model of that name: in the level's folder, else in the track's. */
static gw_code find_model(stk_scene *scene, const char *folder, const char *name, uint32_t *out,
                          gw_error *error) {
    char *path = NULL;
    gw_code code = stk_path(folder, name, &path, error);
    if (code == GW_OK && !gw_file_exists(path)) {
        folder = scene->track;
        free(path);
        code = stk_path(folder, name, &path, error);
    }
    if (code != GW_OK)
        return code;
    for (size_t i = 0; i < scene->model_count; i++)
        if (!strcmp(scene->models[i].path, path)) {
            *out = (uint32_t)i;
            free(path);
            return GW_OK;
        }
    code = gw_grow((void **)&scene->models, &scene->model_capacity, scene->model_count + 1,
                   sizeof *scene->models, "models", error);
    if (code != GW_OK) {
        free(path);
        return code;
    }
    *out = (uint32_t)scene->model_count++;
    return load_model(folder, path, &scene->models[*out], error);
}

static gw_code place_model(stk_scene *scene, const level *at, const char *name, const stk_matrix *matrix,
                           gw_error *error) {
    stk_instance instance;
    gw_code code = find_model(scene, at->folder, name, &instance.model, error);
    if (code == GW_OK && scene->instance_count >= MOST_INSTANCES)
        code = gw_fail(error, GW_BAD_INPUT, "the track places more than %d meshes", MOST_INSTANCES);
    if (code == GW_OK)
        code = gw_grow((void **)&scene->instances, &scene->instance_capacity, scene->instance_count + 1,
                       sizeof *scene->instances, "instances", error);
    if (code != GW_OK)
        return code;
    /* Mirrored in z on both sides, as the meshes are. */
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            instance.matrix.m[r][c] = (r == 2) != (c == 2) ? -matrix->m[r][c] : matrix->m[r][c];
    scene->instances[scene->instance_count++] = instance;
    return GW_OK;
}

/* The finest model of a group of levels of detail: the one that goes away at the least distance. NULL when
 * there is no such group. */
static const char *finest_of(const xml_document *d, const char *group_name) {
    const char *finest = NULL;
    double least = INFINITY;
    for (int32_t lod = xml_child(d, 0, -1); lod >= 0; lod = xml_child(d, 0, lod)) {
        if (!xml_is(d, lod, "lod"))
            continue;
        for (int32_t group = xml_child(d, lod, -1); group >= 0; group = xml_child(d, lod, group)) {
            const char *name = xml_attribute_of(d, group, "name");
            if (!name || strcmp(name, group_name) != 0)
                continue;
            for (int32_t part = xml_child(d, group, -1); part >= 0; part = xml_child(d, group, part)) {
                const char *distance = xml_attribute_of(d, part, "lod_distance");
                if (distance && strtod(distance, NULL) < least) {
                    least = strtod(distance, NULL);
                    finest = xml_attribute_of(d, part, "model");
                }
            }
        }
    }
    return finest;
}

static gw_code place_object(stk_scene *scene, const level *at, int32_t element, gw_error *error) {
    const xml_document *d = at->document;
    const char *interaction = xml_attribute_of(d, element, "interaction");
    const char *group = xml_attribute_of(d, element, "lod_group");
    const char *name = xml_attribute_of(d, element, "model");
    stk_matrix own, matrix;
    if (interaction && (!strcmp(interaction, "physicsonly") || !strcmp(interaction, "physics-only")))
        return GW_OK;
    if (group)
        name = finest_of(d, group);
    if (!name && !group)
        return GW_OK; /* a sound, a sign that turns to the camera, a trigger */
    gw_code code =
        name ? read_placing(d, element, &own, error)
             : gw_fail(error, GW_BAD_INPUT, "there is no group of levels of detail '%.100s'", group);
    if (code != GW_OK)
        return code;
    matrix = multiply(&at->matrix, &own);
    return place_model(scene, at, name, &matrix, error);
}

/* --- lights --- */

static gw_code place_light(stk_scene *scene, const level *at, int32_t element, gw_error *error) {
    const xml_document *d = at->document;
    const char *energy = xml_attribute_of(d, element, "energy");
    double at_light[3], color[3], power = energy ? strtod(energy, NULL) : 1.0;
    gw_code code = read_three(d, element, "xyz", 0.0, at_light, error);
    if (code == GW_OK)
        code = read_three(d, element, "color", 255.0, color, error);
    if (code == GW_OK)
        code = gw_grow((void **)&scene->lights, &scene->light_capacity, scene->light_count + 1,
                       sizeof *scene->lights, "lights", error);
    if (code != GW_OK)
        return code;
    stk_light light = {.intensity = power > 0.0 && power < 1e6 ? (float)(20.0 * power) : 0.0f};
    for (int r = 0; r < 3; r++) {
        light.position[r] = at->matrix.m[r][3];
        for (int k = 0; k < 3; k++)
            light.position[r] += at->matrix.m[r][k] * at_light[k];
        light.color[r] = (float)(fmin(fmax(color[r], 0.0), 255.0) / 255.0);
    }
    light.position[2] = -light.position[2];
    scene->lights[scene->light_count++] = light;
    return GW_OK;
}

/* xyz is where the sun stands, seen from the origin. */
static gw_code read_sun(stk_scene *scene, const xml_document *d, int32_t element, gw_error *error) {
    double at[3], color[3];
    gw_code code = read_three(d, element, "xyz", 1.0, at, error);
    if (code == GW_OK)
        code = read_three(d, element, "sun-diffuse", 255.0, color, error);
    for (int i = 0; i < 3 && code == GW_OK; i++) {
        scene->sun_direction[i] = i == 2 ? at[i] : -at[i];
        scene->sun_color[i] = (float)(fmin(fmax(color[i], 0.0), 255.0) / 255.0);
    }
    return code;
}

/* --- files --- */

static gw_code walk_file(stk_scene *scene, const char *folder, const char *file, const stk_matrix *matrix,
                         int depth, gw_error *error);

static gw_code place_library(stk_scene *scene, const level *at, int32_t element, gw_error *error) {
    stk_matrix own, matrix;
    char *all = NULL, *folder = NULL;
    if (at->depth >= DEEPEST_LIBRARY)
        return gw_fail(error, GW_BAD_INPUT, "library nodes place each other more than %d deep",
                       DEEPEST_LIBRARY);
    gw_code code = read_placing(at->document, element, &own, error);
    if (code == GW_OK)
        code = stk_path(scene->data, "library", &all, error);
    if (code == GW_OK)
        code = stk_path(all, xml_attribute_of(at->document, element, "name"), &folder, error);
    if (code == GW_OK) {
        matrix = multiply(&at->matrix, &own);
        code = walk_file(scene, folder, "node.xml", &matrix, at->depth + 1, error);
    }
    free(all);
    free(folder);
    return code;
}

/* The track's own mesh, and what stands still in it. */
static gw_code place_track(stk_scene *scene, const level *at, int32_t element, gw_error *error) {
    const xml_document *d = at->document;
    const char *name = xml_attribute_of(d, element, "model");
    gw_code code = name ? place_model(scene, at, name, &at->matrix, error) : GW_OK;
    for (int32_t part = xml_child(d, element, -1); code == GW_OK && part >= 0;
         part = xml_child(d, element, part))
        if (xml_is(d, part, "static-object"))
            code = place_object(scene, at, part, error);
    return code;
}

static gw_code walk(stk_scene *scene, const level *at, gw_error *error) {
    const xml_document *d = at->document;
    gw_code code = GW_OK;
    for (int32_t e = xml_child(d, 0, -1); code == GW_OK && e >= 0; e = xml_child(d, 0, e)) {
        if (xml_is(d, e, "track"))
            code = place_track(scene, at, e, error);
        else if (xml_is(d, e, "object") || xml_is(d, e, "static-object"))
            code = place_object(scene, at, e, error);
        else if (xml_is(d, e, "library"))
            code = place_library(scene, at, e, error);
        else if (xml_is(d, e, "light"))
            code = place_light(scene, at, e, error);
        else if (xml_is(d, e, "sun") && at->depth == 0)
            code = read_sun(scene, d, e, error);
    }
    return code;
}

static gw_code walk_file(stk_scene *scene, const char *folder, const char *file, const stk_matrix *matrix,
                         int depth, gw_error *error) {
    char *path = NULL;
    gw_bytes bytes = {0};
    xml_document document = {0};
    gw_code code = stk_path(folder, file, &path, error);
    if (code == GW_OK)
        code = gw_file_read(path, largest_file, &bytes, error);
    if (code == GW_OK)
        code = xml_parse(path, bytes.data, bytes.size, &document, error);
    if (code == GW_OK) {
        level at = {.folder = folder, .document = &document, .matrix = *matrix, .depth = depth};
        code = walk(scene, &at, error);
        if (code != GW_OK)
            gw_context(error, "%s", path);
    }
    xml_finish(&document);
    gw_bytes_finish(&bytes);
    free(path);
    return code;
}

gw_code stk_scene_read(const char *data, const char *track, stk_scene *out, gw_error *error) {
    char *tracks = NULL;
    *out = (stk_scene){.data = gw_copy_text(data)};
    gw_code code = out->data ? GW_OK : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code == GW_OK)
        code = stk_path(data, "tracks", &tracks, error);
    if (code == GW_OK)
        code = stk_path(tracks, track, &out->track, error);
    if (code == GW_OK)
        code = walk_file(out, out->track, "scene.xml", &identity, 0, error);
    free(tracks);
    if (code != GW_OK)
        stk_scene_finish(out);
    return code;
}

void stk_scene_finish(stk_scene *scene) {
    for (size_t i = 0; i < scene->model_count; i++) {
        free(scene->models[i].folder);
        free(scene->models[i].path);
        stk_mesh_finish(&scene->models[i].mesh);
    }
    free(scene->models);
    free(scene->instances);
    free(scene->lights);
    free(scene->data);
    free(scene->track);
    *scene = (stk_scene){0};
}
