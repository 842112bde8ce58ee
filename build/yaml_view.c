#include "build/yaml_view.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- placement --- */

/* Three rows of a rotation times one positive factor. */
static gw_code check_similarity(const gw_yaml_node *node, const double m[3][4], gw_error *error) {
    double dots[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            dots[i][k] = m[i][0] * m[k][0] + m[i][1] * m[k][1] + m[i][2] * m[k][2];
    const double tolerance = 1e-6 * dots[0][0];
    int good = dots[0][0] > 0.0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            good = good && fabs(dots[i][k] - (i == k ? dots[0][0] : 0.0)) <= tolerance;
    const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    if (good && determinant > 0.0)
        return GW_OK;
    return gw_yaml_fail(
        node, error,
        "key 'matrix': the first three columns must be a rotation times one positive factor (mm per "
        "metre), without mirroring or shearing");
}

static gw_code read_placement_matrix(const gw_yaml_node *matrix, gw_placement *out, gw_error *error) {
    double numbers[12];
    gw_code code = gw_yaml_numbers(matrix, "matrix", 12, numbers, error);
    if (code != GW_OK)
        return code;
    memcpy(out->matrix, numbers, sizeof numbers);
    out->kind = GW_PLACE_MATRIX;
    return check_similarity(matrix, (const double(*)[4])out->matrix, error);
}

static gw_code read_placement(const gw_yaml_node *node, gw_placement *out, gw_error *error) {
    static const char *const keys[] = {"fit", "viewpoint", "scale", "matrix"};
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "placement", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    if (code != GW_OK)
        return code;
    const gw_yaml_node *fit = gw_yaml_find(node, "fit"), *viewpoint = gw_yaml_find(node, "viewpoint"),
                       *matrix = gw_yaml_find(node, "matrix"), *scale = gw_yaml_find(node, "scale");
    if ((fit != NULL) + (viewpoint != NULL) + (matrix != NULL) != 1)
        return gw_yaml_fail(node, error, "key 'placement': give exactly one of 'fit', 'viewpoint', 'matrix'");
    if (scale && !viewpoint)
        return gw_yaml_fail(scale, error, "key 'scale' belongs to 'viewpoint: true'");
    if (fit && (!gw_yaml_text(fit) || strcmp(gw_yaml_text(fit), "behind-wall") != 0))
        return gw_yaml_fail(fit, error, "key 'fit': '%.40s' is not known; it is 'behind-wall'",
                            gw_yaml_text(fit) ? gw_yaml_text(fit) : "");
    if (matrix)
        return read_placement_matrix(matrix, out, error);
    if (!viewpoint)
        return GW_OK;
    int wanted = 0;
    out->kind = GW_PLACE_VIEWPOINT;
    code = gw_yaml_boolean(viewpoint, "viewpoint", &wanted, error);
    if (code == GW_OK && !wanted)
        code = gw_yaml_fail(viewpoint, error, "key 'viewpoint': write true, or leave it out");
    if (code == GW_OK && scale)
        code = gw_yaml_number(scale, "scale", 1e-9, 1e9, &out->scale, error);
    return code;
}

/* --- viewpoints and paths --- */

static gw_code read_name(const gw_yaml_node *node, char *name, size_t size, size_t index, gw_error *error) {
    const gw_yaml_node *value = gw_yaml_find(node, "name");
    snprintf(name, size, "%zu", index + 1);
    if (!value)
        return GW_OK;
    const char *text = gw_yaml_text(value);
    if (!text || strlen(text) >= size)
        return gw_yaml_fail(value, error, "key 'name': a text of at most %zu bytes is wanted", size - 1);
    snprintf(name, size, "%s", text);
    return GW_OK;
}

static gw_code need_numbers(const gw_yaml_node *map, const char *key, size_t count, double *out,
                            gw_error *error) {
    const gw_yaml_node *value = gw_yaml_find(map, key);
    if (!value)
        return gw_yaml_fail(map, error, "key '%s' is missing", key);
    return gw_yaml_numbers(value, key, count, out, error);
}

static double squared_length(const double v[3]) {
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/* eye and look_at apart, up across the view. */
static gw_code check_view(const gw_yaml_node *node, const double eye[3], const double look_at[3],
                          const double up[3], gw_error *error) {
    const double d[3] = {look_at[0] - eye[0], look_at[1] - eye[1], look_at[2] - eye[2]};
    const double cross[3] = {d[1] * up[2] - d[2] * up[1], d[2] * up[0] - d[0] * up[2],
                             d[0] * up[1] - d[1] * up[0]};
    if (!(squared_length(d) > 0.0))
        return gw_yaml_fail(node, error, "'eye' and 'look_at' are the same point");
    if (!(squared_length(cross) > 1e-12 * squared_length(d) * squared_length(up)))
        return gw_yaml_fail(node, error,
                            "'up' (0, 1, 0 where none can be given) has no length or points along the view: "
                            "change it, or the view");
    return GW_OK;
}

static gw_code read_viewpoint(const gw_yaml_node *node, size_t index, gw_viewpoint *out, gw_error *error) {
    static const char *const keys[] = {"name", "eye", "look_at", "up", "fov"};
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "viewpoints", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    if (code == GW_OK)
        code = read_name(node, out->name, sizeof out->name, index, error);
    if (code == GW_OK)
        code = need_numbers(node, "eye", 3, out->eye, error);
    if (code == GW_OK)
        code = need_numbers(node, "look_at", 3, out->look_at, error);
    out->up[1] = 1.0;
    out->fov = 45.0;
    if (code == GW_OK && gw_yaml_find(node, "up"))
        code = gw_yaml_numbers(gw_yaml_find(node, "up"), "up", 3, out->up, error);
    if (code == GW_OK && gw_yaml_find(node, "fov"))
        code = gw_yaml_number(gw_yaml_find(node, "fov"), "fov", 1.0, 170.0, &out->fov, error);
    return code == GW_OK ? check_view(node, out->eye, out->look_at, out->up, error) : code;
}

static gw_code read_viewpoints(const gw_yaml_node *list, gw_scene *scene, gw_error *error) {
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "viewpoints", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->viewpoints, gw_yaml_count(list), sizeof *scene->viewpoints,
                           "viewpoints", error);
    for (size_t i = 0; code == GW_OK && i < gw_yaml_count(list); i++) {
        code = read_viewpoint(gw_yaml_item(list, i), i, &scene->viewpoints[i], error);
        if (code == GW_OK)
            scene->viewpoint_count++;
    }
    return code;
}

static gw_code read_key(const gw_yaml_node *node, const gw_camera_key *before, gw_camera_key *out,
                        gw_error *error) {
    static const char *const keys[] = {"time", "eye", "look_at"};
    static const double up[3] = {0, 1, 0};
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "keys", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    if (code == GW_OK && !gw_yaml_find(node, "time"))
        code = gw_yaml_fail(node, error, "key 'time' is missing");
    if (code == GW_OK)
        code = gw_yaml_number(gw_yaml_find(node, "time"), "time", 0.0, 1e6, &out->time, error);
    if (code == GW_OK)
        code = need_numbers(node, "eye", 3, out->eye, error);
    if (code == GW_OK)
        code = need_numbers(node, "look_at", 3, out->look_at, error);
    if (code == GW_OK && before && !(out->time > before->time))
        code =
            gw_yaml_fail(node, error, "key 'time': %g s does not come after %g s", out->time, before->time);
    return code == GW_OK ? check_view(node, out->eye, out->look_at, up, error) : code;
}

static gw_code read_path(const gw_yaml_node *node, size_t index, gw_camera_path *out, gw_error *error) {
    static const char *const keys[] = {"name", "fov", "keys"};
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "paths", error);
    if (code == GW_OK)
        code = gw_yaml_check_keys(node, keys, sizeof keys / sizeof *keys, error);
    if (code == GW_OK)
        code = read_name(node, out->name, sizeof out->name, index, error);
    out->fov = 45.0;
    if (code == GW_OK && gw_yaml_find(node, "fov"))
        code = gw_yaml_number(gw_yaml_find(node, "fov"), "fov", 1.0, 170.0, &out->fov, error);
    if (code != GW_OK)
        return code;
    const gw_yaml_node *list = gw_yaml_find(node, "keys");
    if (!list || gw_yaml_node_kind(list) != GW_YAML_LIST || gw_yaml_count(list) < 2)
        return gw_yaml_fail(node, error, "key 'keys': a list of at least two keys is wanted");
    code = gw_allocate((void **)&out->keys, gw_yaml_count(list), sizeof *out->keys, "camera path", error);
    for (size_t i = 0; code == GW_OK && i < gw_yaml_count(list); i++) {
        code = read_key(gw_yaml_item(list, i), i ? &out->keys[i - 1] : NULL, &out->keys[i], error);
        out->key_count = i + 1;
    }
    return code;
}

static gw_code read_paths(const gw_yaml_node *list, gw_scene *scene, gw_error *error) {
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "paths", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&scene->paths, gw_yaml_count(list), sizeof *scene->paths, "camera paths",
                           error);
    for (size_t i = 0; code == GW_OK && i < gw_yaml_count(list); i++) {
        scene->path_count++; /* also a path that fails half-way owns its keys */
        code = read_path(gw_yaml_item(list, i), i, &scene->paths[i], error);
    }
    return code;
}

gw_code gw_yaml_read_views(const gw_yaml_node *root, gw_scene *scene, gw_error *error) {
    const gw_yaml_node *placement = gw_yaml_find(root, "placement"),
                       *viewpoints = gw_yaml_find(root, "viewpoints"), *paths = gw_yaml_find(root, "paths");
    scene->placement = (gw_placement){.kind = GW_PLACE_FIT_BEHIND_WALL, .scale = 1.0};
    gw_code code = placement ? read_placement(placement, &scene->placement, error) : GW_OK;
    if (code == GW_OK && viewpoints)
        code = read_viewpoints(viewpoints, scene, error);
    if (code == GW_OK && paths)
        code = read_paths(paths, scene, error);
    return code;
}
