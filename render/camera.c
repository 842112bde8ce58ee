#include "render/camera.h"

#include "base/portable_math.h"
#include "render/vector3.h"

#include <stdlib.h>
#include <string.h>

gw_code gw_camera_path_find(const gw_scene *scene, const char *name, const gw_camera_path **out,
                            gw_error *error) {
    for (uint32_t i = 0; i < scene->path_count; ++i)
        if (!strcmp(scene->paths[i].name, name)) {
            *out = &scene->paths[i];
            return GW_OK;
        }
    char *end;
    unsigned long number = strtoul(name, &end, 10);
    if (end != name && !*end && number < scene->path_count) {
        *out = &scene->paths[number];
        return GW_OK;
    }
    return gw_fail(error, GW_BAD_INPUT, "the scene has no camera path '%s'; it has %u%s%s%s", name,
                   scene->path_count, scene->path_count ? ", the first is '" : "",
                   scene->path_count ? scene->paths[0].name : "", scene->path_count ? "'" : "");
}

static const double *point_of(const gw_camera_key *key, int which) {
    return which ? key->look_at : key->eye;
}

/* Slope at a key, per second. */
static double slope_at(const gw_camera_path *path, size_t key, int which, int axis) {
    size_t before = key > 0 ? key - 1 : 0, after = key + 1 < path->key_count ? key + 1 : key;
    const gw_camera_key *a = &path->keys[before], *b = &path->keys[after];
    return (point_of(b, which)[axis] - point_of(a, which)[axis]) / (b->time - a->time);
}

static void between(const gw_camera_path *path, size_t key, double share, int which, double out[3]) {
    const gw_camera_key *a = &path->keys[key], *b = a + 1;
    double span = b->time - a->time, s2 = share * share, s3 = s2 * share;
    for (int k = 0; k < 3; ++k)
        out[k] = (2 * s3 - 3 * s2 + 1) * point_of(a, which)[k] +
                 (s3 - 2 * s2 + share) * span * slope_at(path, key, which, k) +
                 (3 * s2 - 2 * s3) * point_of(b, which)[k] +
                 (s3 - s2) * span * slope_at(path, key + 1, which, k);
}

void gw_camera_path_at(const gw_camera_path *path, double time, double eye[3], double look_at[3]) {
    size_t key = 0;
    while (key + 2 < path->key_count && time >= path->keys[key + 1].time)
        key++;
    const gw_camera_key *a = &path->keys[key], *b = a + 1;
    double share = fmin(fmax((time - a->time) / (b->time - a->time), 0), 1);
    between(path, key, share, 0, eye);
    between(path, key, share, 1, look_at);
}

gw_code gw_perspective_of(const double eye[3], const double look_at[3], const double up_hint[3], double fov,
                          const uint32_t size[2], gw_perspective *out, gw_error *error) {
    double forward[3], right[3], up[3];
    for (int i = 0; i < 3; ++i)
        forward[i] = look_at[i] - eye[i];
    double distance = 1000 * sqrt(gw_dot(forward, forward));
    int good = gw_normalise(forward, 0);
    gw_cross(forward, up_hint, right);
    if (good && !gw_normalise(right, 0)) {
        const double away[3] = {0, 0, -1};
        gw_cross(forward, away, right);
        good = gw_normalise(right, 0);
    }
    if (!good)
        return gw_fail(error, GW_BAD_INPUT,
                       "the camera has no direction: eye and look-at are the same point %g,%g,%g", eye[0],
                       eye[1], eye[2]);
    gw_cross(right, forward, up);
    double pitch = 2 * distance * tan(0.5 * fov * GW_PI / 180) / size[1];
    memset(&out->placement, 0, sizeof out->placement);
    out->placement.scale = 1000;
    for (int i = 0; i < 3; ++i) {
        out->placement.rotation[i][i] = 1;
        out->eye[i] = 1000 * eye[i];
        out->centre[i] = out->eye[i] + distance * forward[i];
        out->plane.step_x[i] = pitch * right[i];
        out->plane.step_y[i] = -pitch * up[i];
        out->plane.corner[i] =
            out->centre[i] - 0.5 * size[0] * out->plane.step_x[i] - 0.5 * size[1] * out->plane.step_y[i];
    }
    return GW_OK;
}

gw_code gw_place_frame(const gw_scene *scene, const gw_frame_state *state, double wall_width,
                       double wall_height, const double wall_centre[3], const double neutral_eye[3],
                       gw_similarity *out, gw_error *error) {
    gw_viewpoint view = {.name = "navigation", .up = {0, 1, 0}};
    int navigated = 0;
    for (int k = 0; k < 3; ++k) {
        view.eye[k] = (double)state->stand[k];
        view.look_at[k] = (double)state->look_at[k];
        navigated |= state->stand[k] != state->look_at[k];
    }
    if (view.eye[0] == view.look_at[0] && view.eye[2] == view.look_at[2]) { /* straight up or down */
        view.up[1] = 0;
        view.up[2] = -1;
    }
    if (!navigated)
        return gw_place_scene(scene, wall_width, wall_height, wall_centre, neutral_eye, out, error);
    gw_code code = gw_place_viewpoint(scene, &view, neutral_eye, out, error);
    if (!code && state->scene_scale > 0.0f) {
        out->scale = (double)state->scene_scale;
        for (int k = 0; k < 3; ++k)
            out->translation[k] = neutral_eye[k] - out->scale * gw_dot(out->rotation[k], view.eye);
    }
    return code;
}
