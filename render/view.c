/* See view.h. Everything in double; callers round once, when numbers go to the GPU. */
#include "render/view.h"

#include "render/vector3.h"

#include <math.h>

/* FIT_BEHIND_WALL: share of the wall left free on each side together, and the air between the wall and the
 * model. */
static const double fit_margin = 0.05;
static const double fit_gap = 50.0; /* mm */

static const double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void set_rotation(gw_similarity *out, const double rows[3][3]) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out->rotation[i][j] = rows[i][j];
}

static gw_code fit_behind_wall(const gw_scene *scene, double wall_width, double wall_height,
                               const double wall_centre[3], gw_similarity *out, gw_error *error) {
    double width = scene->bounds[1][0] - scene->bounds[0][0];
    double height = scene->bounds[1][1] - scene->bounds[0][1];
    double depth = scene->bounds[1][2] - scene->bounds[0][2];
    /* A model seen edge-on (all of it in one plane x = 0 or y = 0) is scaled by what extent it has. */
    double by_width = width > 0.0 ? (1.0 - fit_margin) * wall_width / width : INFINITY;
    double by_height = height > 0.0 ? (1.0 - fit_margin) * wall_height / height : INFINITY;
    double scale = fmin(by_width, by_height);
    if (!isfinite(scale))
        scale = depth > 0.0 ? wall_width / depth : 0.0;
    if (!(scale > 0.0) || !isfinite(scale))
        return gw_fail(
            error, GW_BAD_INPUT,
            "scene %s cannot be fitted behind a wall of %g x %g mm: its bounding box has no extent; "
            "give a placement matrix",
            scene->path ? scene->path : "(unnamed)", wall_width, wall_height);
    set_rotation(out, identity);
    out->scale = scale;
    out->translation[0] = wall_centre[0] - scale * 0.5 * (scene->bounds[0][0] + scene->bounds[1][0]);
    out->translation[1] = wall_centre[1] - scale * 0.5 * (scene->bounds[0][1] + scene->bounds[1][1]);
    out->translation[2] = wall_centre[2] - fit_gap - scale * scene->bounds[1][2];
    return GW_OK;
}

gw_code gw_place_viewpoint(const gw_scene *scene, const gw_viewpoint *view, const double neutral_eye[3],
                           gw_similarity *out, gw_error *error) {
    double forward[3], right[3], up[3];
    for (int i = 0; i < 3; ++i)
        forward[i] = view->look_at[i] - view->eye[i];
    int ok = gw_normalise(forward, 0);
    gw_cross(forward, view->up, right);
    ok = ok && gw_normalise(right, 0);
    if (!ok)
        return gw_fail(error, GW_BAD_INPUT,
                       "viewpoint '%s' of scene %s has no direction: eye and look_at coincide or up is "
                       "parallel to the view",
                       view->name, scene->path ? scene->path : "(unnamed)");
    gw_cross(right, forward, up);
    for (int j = 0; j < 3; ++j) {
        out->rotation[0][j] = right[j];
        out->rotation[1][j] = up[j];
        out->rotation[2][j] = -forward[j];
    }
    const gw_placement *placement = &scene->placement;
    out->scale =
        placement->kind == GW_PLACE_VIEWPOINT && placement->scale > 0.0 ? 1000.0 * placement->scale : 1000.0;
    for (int i = 0; i < 3; ++i)
        out->translation[i] = neutral_eye[i] - out->scale * gw_dot(out->rotation[i], view->eye);
    return GW_OK;
}

static gw_code from_viewpoint(const gw_scene *scene, const double neutral_eye[3], gw_similarity *out,
                              gw_error *error) {
    if (scene->viewpoint_count == 0)
        return gw_fail(error, GW_BAD_INPUT,
                       "scene %s is placed by viewpoint but has none; add one or use fit: behind-wall",
                       scene->path ? scene->path : "(unnamed)");
    return gw_place_viewpoint(scene, &scene->viewpoints[0], neutral_eye, out, error);
}

static gw_code from_matrix(const gw_scene *scene, gw_similarity *out, gw_error *error) {
    const double(*m)[4] = scene->placement.matrix;
    double rows[3][3], length[3];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            rows[i][j] = m[i][j];
        length[i] = sqrt(gw_dot(rows[i], rows[i]));
        out->translation[i] = m[i][3];
    }
    double scale = (length[0] + length[1] + length[2]) / 3.0;
    int ok = scale > 0.0 && isfinite(scale) && isfinite(m[0][3]) && isfinite(m[1][3]) && isfinite(m[2][3]);
    for (int i = 0; ok && i < 3; ++i) {
        ok = fabs(length[i] / scale - 1.0) < 1e-6;
        for (int j = 0; j < 3; ++j)
            rows[i][j] /= length[i];
    }
    double turned[3];
    gw_cross(rows[0], rows[1], turned);
    ok = ok && fabs(gw_dot(rows[0], rows[1])) < 1e-6 && gw_dot(turned, rows[2]) > 1.0 - 1e-6;
    if (!ok)
        return gw_fail(
            error, GW_BAD_INPUT,
            "the placement matrix of scene %s is no similarity; use rotation, one uniform scale and "
            "translation, without mirroring",
            scene->path ? scene->path : "(unnamed)");
    set_rotation(out, (const double(*)[3])rows);
    out->scale = scale;
    return GW_OK;
}

gw_code gw_place_scene(const gw_scene *scene, double wall_width, double wall_height,
                       const double wall_centre[3], const double neutral_eye[3], gw_similarity *out,
                       gw_error *error) {
    switch (scene->placement.kind) {
    case GW_PLACE_FIT_BEHIND_WALL:
        return fit_behind_wall(scene, wall_width, wall_height, wall_centre, out, error);
    case GW_PLACE_VIEWPOINT:
        return from_viewpoint(scene, neutral_eye, out, error);
    case GW_PLACE_MATRIX:
        return from_matrix(scene, out, error);
    }
    return gw_fail(error, GW_BAD_INPUT, "placement kind %d of scene %s is unknown",
                   (int)scene->placement.kind, scene->path ? scene->path : "(unnamed)");
}

void gw_scene_to_wall(const gw_similarity *placement, const double scene[3], double wall[3]) {
    double out[3];
    for (int i = 0; i < 3; ++i)
        out[i] = placement->scale * gw_dot(placement->rotation[i], scene) + placement->translation[i];
    for (int i = 0; i < 3; ++i)
        wall[i] = out[i];
}

void gw_wall_to_scene(const gw_similarity *placement, const double wall[3], double scene[3]) {
    double moved[3];
    for (int i = 0; i < 3; ++i)
        moved[i] = (wall[i] - placement->translation[i]) / placement->scale;
    for (int j = 0; j < 3; ++j)
        scene[j] = placement->rotation[0][j] * moved[0] + placement->rotation[1][j] * moved[1] +
                   placement->rotation[2][j] * moved[2];
}

void gw_wall_to_rebased(const gw_similarity *placement, const gw_scene *scene, const double wall[3],
                        double rebased[3]) {
    double metres[3];
    gw_wall_to_scene(placement, wall, metres);
    for (int i = 0; i < 3; ++i)
        rebased[i] = ldexp(metres[i] - scene->centre[i], -scene->exponent);
}
