/* `gazewall bench modes`: frames of a camera path drawn in the modes of Table 3 of Weier et al. 2014 -
 * triangles only, voxels only, hybrid, foveated - in turns: rays, work, time, and how much of the difference
 * to a picture of full quality a viewer who looks at the picture's centre can tell. */
#include "wall/bench_modes.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/portable_math.h"
#include "render/acuity_filter.h"
#include "render/flip.h"
#include "render/frame_block.h"

#include <math.h>
#include <stdlib.h>

enum { REFERENCE_SAMPLES = 4 /* log2 */ };

static const struct {
    const char *name, *what;
} names[GW_MODE_COUNT] = {{"exact", "triangles at every pixel, tau 0: what the others are timed against"},
                          {"triangles", "geometry=triangles: textures by footprint, no voxels"},
                          {"voxels", "geometry=voxels: the finest voxels only"},
                          {"hybrid", "triangles or voxels by footprint everywhere, no gaze"},
                          {"one-kernel", "hybrid, every ray by the kernel that knows voxels"},
                          {"gazed", "exact inside the gaze ellipsoid, voxels outside, a ray for every pixel"},
                          {"foveated", "the same with fewer rays where nobody resolves more"}};

/* What drawing needs and telling does not. */
typedef struct drawing {
    gw_bench_modes *modes;
    gw_renderer *renderer, *counting, *one_kernel;
    gw_bench_view view;
    gw_image reference, seen_reference, picture;
} drawing;

static gw_frame_state state_of(const drawing *d, gw_mode which) {
    gw_frame_state state =
        gw_bench_state(d->modes->bench, &d->view, which == GW_MODE_FULL_RATE || which == GW_MODE_FOVEATED);
    switch (which) {
    case GW_MODE_EXACT:
        state.tau = state.tau_inside = 0;
        break;
    case GW_MODE_TRIANGLES:
        state.geometry = GW_GEOMETRY_TRIANGLES;
        break;
    case GW_MODE_VOXELS:
        state.geometry = GW_GEOMETRY_VOXELS;
        break;
    case GW_MODE_HYBRID:
    case GW_MODE_ONE_KERNEL:
        state.tau_inside = state.tau;
        break;
    case GW_MODE_FULL_RATE:
        state.sample_block = 0;
        break;
    default:
        break;
    }
    return state;
}

static gw_code draw(const drawing *d, gw_renderer *renderer, const gw_frame_state *state, gw_image *out,
                    gw_counters *counters, gw_error *error) {
    return gw_renderer_frame(renderer, &d->view.placement, &d->view.plane, &d->view.rectangle, state,
                             out->rgba, counters, error);
}

/* The picture as the viewer of the foveated mode sees it; release it. */
static gw_code filter(const drawing *d, const gw_image *picture, gw_image *out, gw_error *error) {
    gw_frame_block block;
    const gw_model *model = &d->modes->bench->model;
    const gw_frame_state state = state_of(d, GW_MODE_FOVEATED);
    gw_code code = gw_frame_block_fill(model->scene, model->octree, &d->view.placement, &d->view.plane,
                                       &state, &block, NULL, error);
    return code ? code : gw_acuity_filter(picture, &block, out, error);
}

/* second: the other frame of a pair, which counts for flicker only. */
static gw_code compare(drawing *d, gw_mode_outcome *o, int second, gw_error *error) {
    gw_image seen = {0};
    double flip = 0, seen_flip = 0;
    gw_code code = filter(d, &d->picture, &seen, error);
    if (!code && !second)
        code = gw_flip(&d->reference, &d->picture, d->view.pixels_per_degree, NULL, &flip, error);
    if (!code && !second)
        code = gw_flip(&d->seen_reference, &seen, d->view.pixels_per_degree, NULL, &seen_flip, error);
    if (!code)
        code = gw_flicker_add(&o->plain, &d->reference, &d->picture, error);
    if (!code)
        code = gw_flicker_add(&o->seen, &d->seen_reference, &seen, error);
    gw_image_finish(&seen);
    o->flip += flip / d->modes->stations;
    o->seen_flip += seen_flip / d->modes->stations;
    return code;
}

/* Work and error of every mode, once, in the present view. */
static gw_code inspect_view(drawing *d, int second, gw_error *error) {
    const int compared = !d->modes->bench->times_only;
    gw_frame_state full = state_of(d, GW_MODE_EXACT);
    full.samples = REFERENCE_SAMPLES;
    gw_image_finish(&d->seen_reference);
    gw_code code = compared ? draw(d, d->renderer, &full, &d->reference, NULL, error) : GW_OK;
    if (!code && compared)
        code = filter(d, &d->reference, &d->seen_reference, error);
    for (int i = 0; i < GW_MODE_COUNT && !code; i++) {
        gw_mode_outcome *o = &d->modes->outcomes[i];
        const gw_frame_state state = state_of(d, (gw_mode)i);
        if (!second) {
            gw_flicker_cut(&o->plain);
            gw_flicker_cut(&o->seen);
        }
        code = draw(d, d->counting, &state, &d->picture, second ? NULL : &o->counters, error);
        if (!code && compared)
            code = compare(d, o, second, error);
    }
    return code;
}

/* Round 0 warms up; modes take turns, so that what else the machine does hits all alike. */
static gw_code time_view(drawing *d, uint32_t station, gw_error *error) {
    gw_bench_modes *m = d->modes;
    gw_code code = GW_OK;
    for (uint32_t round = station == 0 ? 0 : 1; round <= m->rounds && !code; round++)
        for (int i = 0; i < GW_MODE_COUNT && !code; i++) {
            const gw_frame_state state = state_of(d, (gw_mode)i);
            int64_t begin = m->by_processor ? gw_processor_ns() : gw_now_ns();
            code = draw(d, i == GW_MODE_ONE_KERNEL ? d->one_kernel : d->renderer, &state, &d->picture, NULL,
                        error);
            int64_t end = m->by_processor ? gw_processor_ns() : gw_now_ns();
            double ms = (double)(end - begin) * 1e-6, *least = &m->outcomes[i].ms[station];
            if (round > 0)
                *least = round == 1 ? ms : fmin(*least, ms);
        }
    return code;
}

/* A station is a pair of neighbouring frames of the path. */
static gw_code visit(drawing *d, uint32_t station, gw_error *error) {
    gw_bench_modes *m = d->modes;
    uint32_t frame = m->path.path ? (GW_PATH_FRAMES - 1) * (2 * station + 1) / (2 * m->stations) : 0;
    gw_code code = gw_bench_view_at(&m->path, frame, &d->view, error);
    if (!code && station == 0)
        m->pixels_per_degree = d->view.pixels_per_degree;
    if (!code)
        code = inspect_view(d, 0, error);
    if (!code)
        code = time_view(d, station, error);
    const int pair = m->path.path && !m->bench->times_only;
    if (!code && pair)
        code = gw_bench_view_at(&m->path, frame + 1, &d->view, error);
    if (!code && pair)
        code = inspect_view(d, 1, error);
    gw_log_progress(&m->bench->console.log, "drawing along the path", (double)(station + 1) / m->stations);
    return code;
}

static void conclude(gw_bench_modes *m) {
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        gw_mode_outcome *o = &m->outcomes[i];
        for (uint32_t s = 0; s < m->stations; s++)
            o->mean_ms += o->ms[s] / m->stations;
        o->ratio = o->mean_ms / m->outcomes[GW_MODE_EXACT].mean_ms;
        o->flicker = gw_flicker_of(&o->plain);
        o->seen_flicker = gw_flicker_of(&o->seen);
    }
}

/* The paper's one light: above the middle of the camera path by a quarter of the scene's height, as bright as
 * a sun where the path looks. */
static void place_point_light(const gw_scene *scene, const gw_camera_path *path, gw_light *light) {
    double square = 0;
    *light = (gw_light){.kind = GW_LIGHT_POINT};
    for (int k = 0; k < 3; k++) {
        double size = scene->bounds[1][k] - scene->bounds[0][k];
        light->vector[k] = scene->bounds[0][k] + 0.5 * size;
        square += 0.25 * size * size;
    }
    if (path) {
        const double share = 0.5 / (double)path->key_count;
        light->vector[0] = light->vector[1] = light->vector[2] = square = 0;
        for (size_t i = 0; i < path->key_count; i++)
            for (int k = 0; k < 3; k++)
                light->vector[k] += share * (path->keys[i].eye[k] + path->keys[i].look_at[k]);
        for (size_t i = 0; i < path->key_count; i++)
            for (int k = 0; k < 3; k++)
                square += 2 * share * pow(path->keys[i].look_at[k] - light->vector[k], 2);
    }
    light->vector[1] += 0.25 * (scene->bounds[1][1] - scene->bounds[0][1]);
    for (int k = 0; k < 3; k++)
        light->color[k] = (float)(GW_PI * square);
}

static gw_code set_point_light(gw_scene *scene, const gw_camera_path *path, gw_error *error) {
    gw_light light;
    place_point_light(scene, path, &light);
    free(scene->lights);
    scene->lights = NULL;
    scene->light_count = 0;
    gw_code code = gw_allocate((void **)&scene->lights, 1, sizeof light, "the point light", error);
    if (code)
        return code;
    scene->lights[0] = light;
    scene->light_count = 1;
    gw_scene_rehash(scene);
    return GW_OK;
}

static gw_code open_modes(drawing *d, gw_error *error) {
    gw_bench_modes *m = d->modes;
    gw_bench *bench = m->bench;
    const gw_renderer_options plain = gw_bench_rendering(bench, 0), counting = gw_bench_rendering(bench, 1);
    gw_renderer_options one_kernel = plain;
    one_kernel.one_kernel = 1;
    gw_code code = gw_bench_path_open(bench, bench->quick ? 128 : 1024, &m->path, error);
    m->stations = !m->path.path ? 1 : bench->frames ? bench->frames : bench->quick ? 2 : 4;
    m->rounds = bench->repeats ? bench->repeats : bench->quick ? 1 : 3;
    m->by_processor = gw_gl_limits_of(bench->model.device)->software;
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        m->outcomes[i].name = names[i].name;
        m->outcomes[i].what = names[i].what;
    }
    if (!code && bench->point_light)
        code = set_point_light(bench->model.scene, m->path.path, error);
    if (!code)
        code = gw_image_create(m->path.size[0], m->path.size[1], &d->reference, error);
    if (!code)
        code = gw_image_create(m->path.size[0], m->path.size[1], &d->picture, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &plain,
                                  &d->renderer, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &counting,
                                  &d->counting, error);
    if (!code)
        code = gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &one_kernel,
                                  &d->one_kernel, error);
    return code;
}

static void close_modes(drawing *d) {
    for (int i = 0; i < GW_MODE_COUNT; i++) {
        gw_flicker_finish(&d->modes->outcomes[i].plain);
        gw_flicker_finish(&d->modes->outcomes[i].seen);
    }
    gw_renderer_destroy(&d->renderer);
    gw_renderer_destroy(&d->counting);
    gw_renderer_destroy(&d->one_kernel);
    gw_image_finish(&d->reference);
    gw_image_finish(&d->seen_reference);
    gw_image_finish(&d->picture);
}

gw_code gw_bench_modes_run(gw_bench *bench, gw_error *error) {
    gw_bench_modes *modes = NULL;
    gw_code code = gw_allocate((void **)&modes, 1, sizeof *modes, "results", error);
    if (code)
        return code;
    modes->bench = bench;
    drawing d = {.modes = modes};
    code = open_modes(&d, error);
    for (uint32_t station = 0; station < modes->stations && !code; station++)
        code = visit(&d, station, error);
    if (!code) {
        conclude(modes);
        code = gw_modes_write(modes, error);
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        gw_modes_print(modes);
    }
    close_modes(&d);
    free(modes);
    return code;
}
