/* `gazewall render`: one picture by one process. The same scene, octree, planes and renderer as the wall,
 * with one tile and without MPI: for the same plane, eye and gaze its pixels are the wall's, bit for bit. */
#include "wall/verbs.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/image.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/console.h"
#include "wall/exposure.h"
#include "wall/frames.h"
#include "wall/interrupt.h"
#include "wall/model.h"
#include "wall/report.h"
#include "wall/sim_options.h"
#include "wall/triple.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct render_options {
    gw_draw_options draw;
    gw_wall_options wall;
    const char *out, *triple, *states, *viewpoint, *path;
    int64_t frame; /* of --states; -1: the first */
    int has_eye, has_look_at, has_fov;
    double eye[3], look_at[3], fov; /* scene metres; deg */
    gw_gaze_choice gaze;
    double gaze_pixel[2];
} render_options;

enum {
    KEY_SIZE = 0x3000,
    KEY_WALL_WIDTH,
    KEY_EYE,
    KEY_LOOK_AT,
    KEY_FOV,
    KEY_VIEWPOINT,
    KEY_PATH,
    KEY_GAZE,
    KEY_NO_GAZE,
    KEY_BUDGET,
    KEY_STATES,
    KEY_FRAME,
    KEY_OUT,
    KEY_TRIPLE
};

static const struct argp_option options_table[] = {
    {NULL, 0, NULL, 0, "The picture:", 1},
    {"size", KEY_SIZE, "WxH", 0, "px, default 960x540", 1},
    {"out", KEY_OUT, "FILE.png", 0, "write the picture there", 1},
    {"triple", KEY_TRIPLE, "FOLDER", 0,
     "draw it once more, exact and with 16 rays a pixel, and write both, their difference as the eye sees it "
     "(FLIP), and "
     "all side by side as triple.png there",
     1},
    {"wall-width", KEY_WALL_WIDTH, "MM", 0,
     "10 to 1e6 mm, default 2000: the picture is a wall so wide; the viewer stands 0.9 of it away", 1},
    {NULL, 0, NULL, 0, "Where from (default: as the scene is placed behind the wall):", 2},
    {"eye", KEY_EYE, "X,Y,Z", 0, "scene m: a camera there", 2},
    {"look-at", KEY_LOOK_AT, "X,Y,Z", 0, "scene m: what it looks at", 2},
    {"fov", KEY_FOV, "DEGREES", 0, "1 to 170, default 45: its vertical field of view", 2},
    {"viewpoint", KEY_VIEWPOINT, "NAME", 0, "a camera at a viewpoint of the scene, by name or number from 0",
     2},
    {"path", KEY_PATH, "NAME", 0,
     "a camera on a camera path of the scene, by name or number from 0, where --time says", 2},
    {"gaze", KEY_GAZE, "X,Y", 0, "px of the picture: the viewer looks there", 2},
    {"no-gaze", KEY_NO_GAZE, NULL, 0, "nobody's gaze is known: sharp everywhere; the default", 2},
    {"budget", KEY_BUDGET, "MS", OPTION_HIDDEN, NULL, 0},
    {"states", KEY_STATES, "FILE", 0, "eye, gaze and knobs from recorded frame states (sim --save-states)",
     2},
    {"frame", KEY_FRAME, "N", 0, "which of them, from 0; default 0", 2},
    {0}};

static gw_code parse_view(int key, const char *argument, render_options *o, gw_error *error) {
    switch (key) {
    case KEY_EYE:
        o->has_eye = 1;
        return gw_parse_numbers("--eye", argument, 3, o->eye, error);
    case KEY_LOOK_AT:
        o->has_look_at = 1;
        return gw_parse_numbers("--look-at", argument, 3, o->look_at, error);
    case KEY_FOV:
        o->has_fov = 1;
        return gw_parse_number("--fov", argument, 1, 170, &o->fov, error);
    case KEY_GAZE:
        return gw_choose_gaze(&o->gaze, GW_GAZE_AT_PIXEL, error)
                   ? error->code
                   : gw_parse_numbers("--gaze", argument, 2, o->gaze_pixel, error);
    default:
        return gw_parse_integer("--frame", argument, 0, 1000000, &o->frame, error);
    }
}

static error_t parse_render(int key, char *argument, struct argp_state *state) {
    render_options *o = state->input;
    gw_error *error = o->draw.error;
    gw_code code = GW_OK;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->draw;
        break;
    case KEY_SIZE:
        code = gw_parse_pair("--size", argument, GW_MAXIMUM_WALL_SIDE, o->wall.size, error);
        break;
    case KEY_WALL_WIDTH:
        o->wall.wall_width_given = 1;
        code = gw_parse_number("--wall-width", argument, 10, 1e6, &o->wall.wall_width, error);
        break;
    case KEY_OUT:
        code = gw_parse_name("--out", argument, &o->out, error);
        break;
    case KEY_TRIPLE:
        code = gw_parse_name("--triple", argument, &o->triple, error);
        break;
    case KEY_VIEWPOINT:
        o->viewpoint = argument;
        break;
    case KEY_PATH:
        o->path = argument;
        break;
    case KEY_BUDGET:
        code =
            gw_fail(error, GW_BAD_INPUT,
                    "--budget is held from frame to frame, and render draws one; use gazewall sim, or --set "
                    "strain=Q for one picture so strained");
        break;
    case KEY_STATES:
        o->states = argument;
        break;
    case KEY_NO_GAZE:
        code = gw_choose_gaze(&o->gaze, GW_GAZE_NONE, error);
        break;
    case KEY_EYE:
    case KEY_LOOK_AT:
    case KEY_FOV:
    case KEY_GAZE:
    case KEY_FRAME:
        code = parse_view(key, argument, o, error);
        break;
    case ARGP_KEY_ARG:
        code = gw_stray_argument(argument, error);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

static const struct argp_child children[] = {{&gw_draw_argp, 0, NULL, 0}, {0}};
static const struct argp render_argp = {
    .options = options_table,
    .parser = parse_render,
    .children = children,
    .doc = "One picture, one process, no MPI. For the same wall, eye and gaze it has the same pixels as "
           "'gazewall sim'.\v"
           "Examples:\n"
           "  gazewall render --size 960x540 --gaze 480,270 --out picture.png\n"
           "  gazewall render --scene dragon.glb --eye 0,1,3 --look-at 0,0.5,0 --fov 40 --out dragon.png\n"
           "  gazewall render --debug levels --gaze 200,200 --report report.json --out levels.png\n"};

static gw_code check_view(const render_options *o, gw_error *error) {
    if (o->has_eye != o->has_look_at)
        return gw_fail(error, GW_BAD_INPUT, "--eye and --look-at belong together; give both or neither");
    if (o->has_eye && o->viewpoint)
        return gw_fail(error, GW_BAD_INPUT, "--viewpoint is a camera already; leave out --eye and --look-at");
    if (o->path && (o->has_eye || o->viewpoint))
        return gw_fail(error, GW_BAD_INPUT, "--path is a camera already; leave out %s",
                       o->viewpoint ? "--viewpoint" : "--eye and --look-at");
    if (o->wall.wall_width_given && (o->has_eye || o->viewpoint || o->path))
        return gw_fail(error, GW_BAD_INPUT,
                       "--wall-width is that of a wall with a viewer before it; a camera (--eye, "
                       "--viewpoint, --path) has --fov instead");
    if (o->has_fov && !o->has_eye && !o->viewpoint && !o->path)
        return gw_fail(error, GW_BAD_INPUT,
                       "--fov needs a camera: --eye and --look-at, --viewpoint, or --path");
    if (o->states && (o->has_eye || o->viewpoint || o->path || o->gaze == GW_GAZE_AT_PIXEL))
        return gw_fail(error, GW_BAD_INPUT,
                       "--states holds eye and gaze; leave out --eye, --viewpoint, --path and --gaze");
    if (o->triple && o->draw.debug != GW_DEBUG_NONE)
        return gw_fail(error, GW_BAD_INPUT,
                       "--triple compares pictures, and --debug draws a map; leave out one of them");
    if (o->states && gw_draw_options_decide_frames(&o->draw, error))
        return GW_BAD_INPUT;
    if (o->frame >= 0 && !o->states)
        return gw_fail(error, GW_BAD_INPUT, "--frame picks one of recorded states; give --states FILE, too");
    return GW_OK;
}

/* --- the view
 * ---------------------------------------------------------------------------------------------------- */

typedef struct view {
    gw_similarity placement;
    gw_plane plane;
    gw_layout layout; /* one tile */
    double eye[3];    /* mm */
} view;

static gw_code find_viewpoint(const gw_scene *scene, const char *name, const gw_viewpoint **out,
                              gw_error *error) {
    for (uint32_t i = 0; i < scene->viewpoint_count; i++)
        if (!strcmp(scene->viewpoints[i].name, name)) {
            *out = &scene->viewpoints[i];
            return GW_OK;
        }
    char *end;
    unsigned long number = strtoul(name, &end, 10);
    if (end != name && !*end && number < scene->viewpoint_count) {
        *out = &scene->viewpoints[number];
        return GW_OK;
    }
    return gw_fail(error, GW_BAD_INPUT, "the scene has no viewpoint '%s'; it has %" PRIu32 "%s%s%s", name,
                   scene->viewpoint_count, scene->viewpoint_count ? ", the first is '" : "",
                   scene->viewpoint_count ? scene->viewpoints[0].name : "",
                   scene->viewpoint_count ? "'" : "");
}

static gw_code camera_view(const render_options *o, const double eye[3], const double look_at[3],
                           const double up[3], double fov, view *out, gw_error *error) {
    gw_perspective camera;
    gw_code code = gw_perspective_of(eye, look_at, up, fov, o->wall.size, &camera, error);
    if (code)
        return code;
    out->placement = camera.placement;
    out->plane = out->layout.tiles[0].plane = camera.plane;
    memcpy(out->eye, camera.eye, sizeof out->eye);
    memcpy(out->layout.eye, camera.eye, sizeof out->layout.eye);
    return GW_OK;
}

static gw_code path_view(const render_options *o, const gw_scene *scene, view *out, gw_error *error) {
    const double y_up[3] = {0, 1, 0};
    const gw_camera_path *path = NULL;
    double eye[3], look_at[3];
    gw_code code = gw_camera_path_find(scene, o->path, &path, error);
    if (code)
        return code;
    gw_camera_path_at(path, o->draw.time, eye, look_at);
    return camera_view(o, eye, look_at, y_up, o->has_fov ? o->fov : path->fov, out, error);
}

/* recorded: of --states, else zeroed. */
static gw_code make_view(const render_options *o, const gw_scene *scene, const gw_frame_state *recorded,
                         view *out, gw_error *error) {
    const double y_up[3] = {0, 1, 0};
    if (o->has_eye)
        return camera_view(o, o->eye, o->look_at, y_up, o->fov, out, error);
    if (o->path)
        return path_view(o, scene, out, error);
    if (o->viewpoint) {
        const gw_viewpoint *point = NULL;
        gw_code code = find_viewpoint(scene, o->viewpoint, &point, error);
        return code ? code
                    : camera_view(o, point->eye, point->look_at, point->up, o->has_fov ? o->fov : point->fov,
                                  out, error);
    }
    const gw_layout *layout = &out->layout;
    memcpy(out->eye, layout->eye, sizeof out->eye);
    out->plane = layout->tiles[0].plane;
    return gw_place_frame(scene, recorded, layout->size[0], layout->size[1], layout->centre, layout->eye,
                          &out->placement, error);
}

/* The picture's pixels, and whether the gaze is on one of them: known before the scene is. */
static gw_code make_layout(const render_options *o, view *out, gw_error *error) {
    double somewhere[3];
    gw_code code = gw_wall_layout(&o->wall, &out->layout, error);
    if (!code && o->gaze == GW_GAZE_AT_PIXEL)
        code = gw_layout_point(&out->layout, o->gaze_pixel, somewhere, error);
    return code;
}

/* Of --states: read before the scene, so that a mistake is told at once. */
static gw_code recorded_state(const render_options *o, gw_frame_state *state, gw_error *error) {
    gw_states states = {0};
    gw_code code = gw_states_load(o->states, &states, error);
    int64_t frame = o->frame < 0 ? 0 : o->frame;
    if (!code && (size_t)frame >= states.count)
        code =
            gw_fail(error, GW_BAD_INPUT, "%s holds %zu frame states; --frame %" PRId64 " is not one of them",
                    o->states, states.count, frame);
    if (!code)
        *state = states.states[frame];
    gw_states_finish(&states);
    return code;
}

static gw_code make_state(const render_options *o, const view *v, gw_frame_state *state, gw_error *error) {
    const gw_draw_options *draw = &o->draw;
    gw_frame_begin(state, 0, &draw->settings, draw->seed, draw->debug);
    double target[3];
    gw_code code =
        o->gaze == GW_GAZE_AT_PIXEL ? gw_layout_point(&v->layout, o->gaze_pixel, target, error) : GW_OK;
    gw_frame_stare(state, v->eye, o->gaze == GW_GAZE_AT_PIXEL ? target : NULL, &draw->settings);
    state->time = (int64_t)(draw->time * 1e9);
    return code;
}

/* --- the picture
 * ------------------------------------------------------------------------------------------------- */

typedef struct render {
    render_options options;
    gw_console console;
    gw_model model;
    gw_renderer *renderer;
    json_t *report;
    view view;
    gw_frame_state state;
    gw_image image;
    gw_counters counters;
    gw_predicted_error predicted;
    double milliseconds;
    json_t *triple; /* numbers, or NULL */
} render;

/* exposure=auto: the picture is drawn at 0 stops, its light counted, and from then on it is a still view
 * whose only sample is there already: nothing is traced again for the picture that is shown. */
static gw_code expose(render *r, const gw_rectangle *rectangle, gw_error *error) {
    gw_exposure exposure;
    gw_luminance luminance;
    r->state.epoch = 1;
    gw_code code = gw_renderer_frame(r->renderer, &r->view.placement, &r->view.plane, rectangle, &r->state,
                                     r->image.rgba, &r->counters, error);
    gw_exposure_init(&exposure, &r->options.draw.settings);
    gw_renderer_take_luminance(r->renderer, &luminance);
    gw_exposure_note(&exposure, 0, &luminance, (uint64_t)rectangle->width * rectangle->height);
    gw_exposure_decide(&exposure, &r->state);
    r->state.metering = 0;
    return code;
}

static gw_code draw(render *r, gw_error *error) {
    const gw_rectangle rectangle = {.width = r->options.wall.size[0], .height = r->options.wall.size[1]};
    gw_renderer_options how = {.count = r->options.draw.count,
                               .settings = &r->options.draw.settings,
                               .force_features = r->options.draw.force_effects,
                               .forbid_features = r->options.draw.forbid_effects,
                               .kernels =
                                   r->options.draw.kernels ? r->options.draw.kernels : GW_KERNELS_AT_ONCE,
                               .log = &r->console.log};
    gw_code code = make_view(&r->options, r->model.scene, &r->state, &r->view, error);
    if (!code && !r->options.states)
        code = make_state(&r->options, &r->view, &r->state, error);
    if (!code)
        code =
            gw_renderer_create(r->model.device, r->model.scene, r->model.octree, &how, &r->renderer, error);
    if (!code)
        code = gw_image_create(rectangle.width, rectangle.height, &r->image, error);
    if (code)
        return code;
    int64_t begin = gw_now_ns();
    if (r->state.metering && !r->options.states)
        code = expose(r, &rectangle, error);
    if (!code)
        code = gw_renderer_frame(r->renderer, &r->view.placement, &r->view.plane, &rectangle, &r->state,
                                 r->image.rgba, &r->counters, error);
    r->milliseconds = (double)(gw_now_ns() - begin) * 1e-6;
    return code ? code
                : gw_predict_error(r->model.scene, r->model.octree, &r->view.placement, &r->view.plane,
                                   &rectangle, &r->state, &r->predicted, error);
}

static gw_code write_triple(render *r, gw_error *error) {
    const gw_triple_view drawn = {.scene = r->model.scene,
                                  .octree = r->model.octree,
                                  .renderer = r->renderer,
                                  .placement = &r->view.placement,
                                  .plane = &r->view.plane,
                                  .state = &r->state};
    return r->options.triple ? gw_triple_write(&drawn, &r->image, r->options.triple, &r->triple, error)
                             : GW_OK;
}

static gw_code fill_report(render *r, gw_error *error) {
    const gw_tile_record whole = {.state = "live"};
    const gw_gl_limits *limits = gw_gl_limits_of(r->model.device);
    gw_report_device(r->report, limits);
    gw_report_scene(r->report, r->model.scene, r->model.import_ms);
    gw_report_octree(r->report, r->model.octree, r->model.scene, limits, r->model.build_ms,
                     r->model.from_cache);
    gw_report_settings(r->report, &r->options.draw.settings, &r->options.draw.profile);
    gw_report_tiles(r->report, &r->view.layout, &whole);
    gw_report_frames(r->report, &r->milliseconds, 1, 1);
    gw_report_counters(r->report, &r->counters);
    gw_report_faults(&r->console.log, &r->counters);
    gw_report_predicted_error(r->report, &r->predicted, &r->state, json_null());
    gw_report_image(r->report, r->options.out, &r->image);
    if (r->triple)
        json_object_set(r->report, "triple", r->triple);
    gw_code code = gw_report_floats(r->report, r->model.device, error);
    return code ? code : gw_renderer_report(r->renderer, &r->counters, r->report, error);
}

static gw_code write_results(render *r, gw_error *error) {
    const render_options *o = &r->options;
    char comment[96];
    snprintf(comment, sizeof comment, "Gazewall " GW_VERSION ", %" PRIu32 " triangles",
             r->model.scene->triangle_count);
    gw_code code = fill_report(r, error);
    gw_interrupt_hold();
    if (!code && o->out)
        code = gw_image_write_png(o->out, &r->image, comment, error);
    if (!code && o->draw.report)
        code = gw_report_write(r->report, o->draw.report, error);
    gw_interrupt_release();
    if (!code && !o->draw.quiet) {
        gw_console_finish(&r->console);
        printf("%s: %" PRIu32 " triangles, %" PRIu32 " nodes; %ux%u px in %.0f ms, %.2f million rays%s%s\n",
               r->model.scene->path, r->model.scene->triangle_count, r->model.octree->node_count,
               r->image.width, r->image.height, r->milliseconds, (double)r->counters.rays * 1e-6,
               o->out ? "; look at " : "", o->out ? o->out : "");
    }
    if (!code && !o->draw.quiet && r->triple) {
        const json_t *seen = json_object_get(r->triple, "seen_flip");
        printf("difference from exact (FLIP, 0 to 1): %.4f",
               json_number_value(json_object_get(r->triple, "flip")));
        if (!json_is_null(seen))
            printf(", seen by who looks there %.4f", json_number_value(seen));
        printf("; look at %s/triple.png\n", o->triple);
    }
    return code;
}

int gw_verb_render(int argc, char **argv) {
    static render r;
    gw_error error = {0};
    int helped = 0;
    gw_draw_options_init(&r.options.draw, &error);
    r.options.draw.keeps = 1;
    gw_wall_options_init(&r.options.wall, 1, 1);
    r.options.fov = 45;
    r.options.frame = -1;
    gw_code code = gw_arguments_parse(&render_argp, argc, argv, &r.options, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code)
        code = check_view(&r.options, &error);
    if (!code)
        code = make_layout(&r.options, &r.view, &error);
    if (!code)
        code = gw_file_writable(r.options.out, &error);
    if (!code && r.options.triple)
        code = gw_make_directories(r.options.triple, &error);
    if (!code)
        code = gw_file_writable(r.options.draw.report, &error);
    if (!code && r.options.states)
        code = recorded_state(&r.options, &r.state, &error);
    gw_console_init(&r.console, "render", r.options.draw.level, r.options.draw.quiet);
    if (!code)
        code = gw_report_create(argc, argv, &r.report, &error);
    if (!code)
        code = gw_model_open(&r.model, &r.options.draw, &r.console.log, &error);
    if (!code)
        code = draw(&r, &error);
    if (!code)
        code = write_triple(&r, &error);
    if (!code)
        code = write_results(&r, &error);
    gw_renderer_destroy(&r.renderer);
    if (!code)
        gw_model_keep_programs(r.model.device, &r.console.log);
    gw_model_close(&r.model);
    gw_image_finish(&r.image);
    json_decref(r.report);
    json_decref(r.triple);
    gw_console_finish(&r.console);
    return code ? gw_console_fail("render", &error) : GW_OK;
}
