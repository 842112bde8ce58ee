#include "wall/bench_view.h"

#include "base/portable_math.h"
#include "render/vector3.h"
#include "wall/frames.h"
#include "wall/sim_options.h"

#include <math.h>
#include <string.h>

gw_code gw_bench_path_open(const gw_bench *bench, uint32_t side, gw_bench_path *out, gw_error *error) {
    const gw_scene *scene = bench->model.scene;
    *out = (gw_bench_path){.scene = scene, .size = {side, side}, .density = bench->density};
    if (bench->size[0])
        memcpy(out->size, bench->size, sizeof out->size);
    if (bench->path)
        return gw_camera_path_find(scene, bench->path, &out->path, error);
    out->path = scene->path_count ? &scene->paths[0] : NULL;
    if (!out->path && bench->density > 0)
        return gw_fail(
            error, GW_BAD_INPUT,
            "--density is for pictures of a camera path, and '%s' has none: add one under 'paths', or "
            "leave it out",
            scene->path);
    return GW_OK;
}

static gw_code wall_view(const gw_bench_path *path, gw_bench_view *out, gw_error *error) {
    gw_wall_options wall;
    gw_layout layout;
    gw_wall_options_init(&wall, 1, 1);
    memcpy(wall.size, path->size, sizeof wall.size);
    gw_code code = gw_wall_layout(&wall, &layout, error);
    if (!code)
        code = gw_place_scene(path->scene, layout.size[0], layout.size[1], layout.centre, layout.eye,
                              &out->placement, error);
    if (code)
        return code;
    out->plane = layout.tiles[0].plane;
    memcpy(out->eye, layout.eye, sizeof out->eye);
    memcpy(out->centre, layout.centre, sizeof out->centre);
    return GW_OK;
}

/* Vertical, deg. */
static double angle_of(const gw_bench_path *path) {
    const double wide = path->density > 0 ? tan(GW_PI / 180) / path->density * path->size[1] : 0;
    return path->density > 0 ? 2 * atan(wide / 2) * 180 / GW_PI : path->path->fov;
}

static gw_code path_view(const gw_bench_path *path, uint32_t frame, gw_bench_view *out, gw_error *error) {
    const double up[3] = {0, 1, 0};
    const gw_camera_key *keys = path->path->keys;
    double first = keys[0].time, last = keys[path->path->key_count - 1].time;
    double eye[3], look_at[3];
    gw_perspective camera;
    gw_camera_path_at(path->path, first + (last - first) * frame / (GW_PATH_FRAMES - 1), eye, look_at);
    gw_code code = gw_perspective_of(eye, look_at, up, angle_of(path), path->size, &camera, error);
    if (code)
        return code;
    out->placement = camera.placement;
    out->plane = camera.plane;
    memcpy(out->eye, camera.eye, sizeof out->eye);
    memcpy(out->centre, camera.centre, sizeof out->centre);
    return GW_OK;
}

gw_code gw_bench_view_at(const gw_bench_path *path, uint32_t frame, gw_bench_view *out, gw_error *error) {
    *out = (gw_bench_view){.rectangle = {.width = path->size[0], .height = path->size[1]}};
    gw_code code = path->path ? path_view(path, frame, out, error) : wall_view(path, out, error);
    if (code)
        return code;
    const double along[3] = {out->centre[0] - out->eye[0], out->centre[1] - out->eye[1],
                             out->centre[2] - out->eye[2]};
    double pitch = sqrt(gw_dot(out->plane.step_x, out->plane.step_x));
    out->pixels_per_degree = fmax(sqrt(gw_dot(along, along)) * tan(GW_PI / 180) / pitch, 1);
    return GW_OK;
}

gw_frame_state gw_bench_state(const gw_bench *bench, const gw_bench_view *view, int gazed) {
    const gw_draw_options *draw = &bench->draw;
    gw_frame_state state;
    gw_frame_begin(&state, 0, &draw->settings, draw->seed, GW_DEBUG_NONE);
    gw_frame_stare(&state, view->eye, gazed ? view->centre : NULL, &draw->settings);
    state.time = (int64_t)(draw->time * 1e9);
    return state;
}

gw_frame_state gw_bench_target_state(const gw_bench *bench, const gw_bench_view *view) {
    const double density = 192, radius = 0.075 * view->rectangle.width / density; /* px/deg, deg */
    gw_settings settings = bench->draw.settings;
    settings.gaze_half_width = settings.gaze_half_height = settings.gaze_margin = radius / 2;
    /* Two pixels may share a ray where the finest period of 1/48 degree takes four: from the circle on. The
     * period doubles once more over its radius. */
    settings.acuity_slope = 1.0 / 48 / radius;
    settings.sample_block = 2; /* log2 */
    settings.samples = 0;      /* log2 */
    const double *right = view->plane.step_x, *down = view->plane.step_y;
    const double pitch = sqrt(gw_dot(right, right));
    double towards[3] = {down[1] * right[2] - down[2] * right[1], down[2] * right[0] - down[0] * right[2],
                         down[0] * right[1] - down[1] * right[0]};
    const double away = pitch * density / tan(GW_PI / 180) / sqrt(gw_dot(towards, towards));
    double viewer[3];
    for (int i = 0; i < 3; i++)
        viewer[i] = view->centre[i] + towards[i] * away;
    gw_frame_state state;
    gw_frame_begin(&state, 0, &settings, bench->draw.seed, GW_DEBUG_NONE);
    gw_frame_stare(&state, viewer, view->centre, &settings);
    memcpy(state.eye, view->eye, sizeof state.eye);
    return state;
}
