/* See ledger.h: drawing and comparing. */
#include "wall/ledger.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/portable_math.h"
#include "base/version.h"
#include "build/pack_octree.h"
#include "render/flip.h"
#include "render/frame_block.h"
#include "render/predicted_error.h"
#include "render/vector3.h"
#include "wall/frames.h"
#include "wall/heat.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A change of what points hold, or of the view, gets another number. */
enum { LEDGER_VERSION = 2, MOST_REPEATS = 64 };

/* The viewer stands before this place of the picture, so many of its widths away: shares. */
static const double gaze_place[2] = {0.2, 0.5}, gaze_distance = 0.25;
/* From moment to moment the eye of a wall's view goes so far along it, mm: 1 m/s at 60 frames a second. */
static const double walk = 1000.0 / 60;

const char *const gw_ledger_cost_names[GW_LEDGER_COSTS] = {"work", "rays", "ms", "bytes", "build_tests"};

/* --- the view */

static void place_viewer(const gw_ledger *ledger, gw_ledger_view *out) {
    const double *right = out->view.plane.step_x, *down = out->view.plane.step_y;
    double towards[3] = {down[1] * right[2] - down[2] * right[1], down[2] * right[0] - down[0] * right[2],
                         down[0] * right[1] - down[1] * right[0]};
    const double away =
        gaze_distance * ledger->size[0] * sqrt(gw_dot(right, right)) / sqrt(gw_dot(towards, towards));
    for (int k = 0; k < 3; k++) {
        out->gaze_at[k] = out->view.plane.corner[k] + gaze_place[0] * ledger->size[0] * right[k] +
                          gaze_place[1] * ledger->size[1] * down[k];
        out->gaze_eye[k] = out->gaze_at[k] + towards[k] * away;
    }
}

static double pixels_per_degree(const gw_ledger *ledger) {
    const gw_ledger_view *still = &ledger->views[0];
    return gw_pixels_per_degree(&still->view.plane, still->gaze_eye, ledger->size[0], ledger->size[1]);
}

static gw_frame_state state_of(const gw_ledger *ledger, const gw_ledger_frame *frame) {
    const gw_draw_options *draw = &ledger->bench->draw;
    const gw_ledger_view *seen = &ledger->views[frame->moment];
    gw_frame_state state;
    gw_frame_begin(&state, frame->moment, &frame->settings, draw->seed, GW_DEBUG_NONE);
    gw_frame_stare(&state, seen->gaze_eye, frame->exact ? NULL : seen->gaze_at, &frame->settings);
    memcpy(state.eye, seen->view.eye, sizeof state.eye);
    state.gazes[0].age = frame->exact ? 0 : (float)frame->age;
    state.time = (int64_t)(draw->time * 1e9);
    return state;
}

/* --- the octree and its renderers */

static int same_stage(const gw_settings *a, const gw_settings *b, const char *only) {
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (row->stage == GW_SETTING_BUILD && (!only || !strcmp(row->name, only)) &&
            gw_setting_value(a, row) != gw_setting_value(b, row))
            return 0;
    }
    return 1;
}

static gw_code open_octree(gw_ledger *ledger, const gw_settings *settings, gw_error *error) {
    gw_bench *bench = ledger->bench;
    gw_model *model = &bench->model;
    gw_draw_options draw = bench->draw;
    if (model->octree && same_stage(settings, &ledger->built, NULL))
        return GW_OK;
    gw_renderer_destroy(&ledger->counting);
    gw_renderer_destroy(&ledger->timed);
    gw_octree_destroy(&model->octree);
    draw.settings = *settings;
    if (!same_stage(settings, &bench->draw.settings, NULL))
        draw.cache = "none"; /* what is tried once does not push out what others use */
    gw_code code = GW_OK;
    if (!same_stage(settings, &ledger->built, "outlier_extents")) {
        gw_model_drop(model);
        code = gw_model_import(model, &draw, &bench->console.log, error);
    }
    if (!code)
        code = gw_model_build(model, &draw, &bench->console.log, error);
    ledger->built = *settings;
    return code;
}

static gw_code open_renderer(const gw_ledger *ledger, int count, gw_renderer **out, gw_error *error) {
    const gw_renderer_options options = gw_bench_rendering(ledger->bench, count);
    const gw_model *model = &ledger->bench->model;
    return *out ? GW_OK
                : gw_renderer_create(model->device, model->scene, model->octree, &options, out, error);
}

/* state: of that moment. */
static gw_code draw(const gw_ledger *ledger, gw_renderer *renderer, uint32_t moment,
                    const gw_frame_state *state, gw_image *out, gw_counters *counters, gw_error *error) {
    const gw_bench_view *view = &ledger->views[moment].view;
    return gw_renderer_frame(renderer, &view->placement, &view->plane, &view->rectangle, state, out->rgba,
                             counters, error);
}

/* Of the frame's octree and settings. */
static gw_code draw_frame(gw_ledger *ledger, const gw_ledger_frame *frame, gw_image *out,
                          gw_counters *counters, gw_error *error) {
    const gw_frame_state state = state_of(ledger, frame);
    gw_code code = open_octree(ledger, &frame->settings, error);
    if (!code)
        code = open_renderer(ledger, 1, &ledger->counting, error);
    return code ? code : draw(ledger, ledger->counting, frame->moment, &state, out, counters, error);
}

/* What the rays of a still frame meet. */
static gw_code trace_frame(gw_ledger *ledger, const gw_ledger_frame *frame, const gw_geometry *out,
                           gw_error *error) {
    const gw_bench_view *view = &ledger->views[0].view;
    const gw_frame_state state = state_of(ledger, frame);
    gw_code code = open_octree(ledger, &frame->settings, error);
    if (!code)
        code = open_renderer(ledger, 1, &ledger->counting, error);
    return code ? code
                : gw_renderer_geometry(ledger->counting, &view->placement, &view->plane, &view->rectangle,
                                       &state, out, error);
}

/* The eye moves by less than any float can tell, so that no frame is a still view's. */
static gw_code time_frame(gw_ledger *ledger, gw_frame_state state, gw_ledger_point *point, gw_error *error) {
    const int separate = !ledger->by_processor && !ledger->bench->quick;
    gw_renderer **renderer = separate ? &ledger->timed : &ledger->counting;
    double ms[MOST_REPEATS];
    gw_image scratch = {0};
    gw_code code = open_renderer(ledger, 0, renderer, error);
    if (!code)
        code = gw_image_create(ledger->size[0], ledger->size[1], &scratch, error);
    if (!code) /* kernels are compiled, as special as they become */
        code = draw(ledger, *renderer, 0, &state, &scratch, NULL, error);
    for (uint32_t i = 0; i < ledger->repeats && !code; i++) {
        state.eye[0] += 1e-9 * fmax(fabs(state.eye[0]), 1);
        const int64_t begin = ledger->by_processor ? gw_processor_ns() : gw_now_ns();
        code = draw(ledger, *renderer, 0, &state, &scratch, NULL, error);
        ms[i] = (double)((ledger->by_processor ? gw_processor_ns() : gw_now_ns()) - begin) * 1e-6;
    }
    gw_image_finish(&scratch);
    const gw_spread spread = gw_spread_of(ms, code ? 0 : ledger->repeats);
    point->costs[GW_LEDGER_MS] = spread.median;
    point->spread_ms = (spread.p95 - spread.minimum) / 2;
    return code;
}

/* --- pictures */

char *gw_ledger_picture(const gw_ledger *ledger, const char *key, int difference) {
    return ledger->folder
               ? gw_picture_path(ledger->folder, "%.16s%s.png", key, difference ? "-difference" : "")
               : NULL;
}

static gw_code write_picture(const gw_ledger *ledger, const char *key, int difference, const gw_image *image,
                             gw_error *error) {
    char *path = gw_ledger_picture(ledger, key, difference);
    gw_code code =
        path || !ledger->folder ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    gw_interrupt_hold();
    if (!code && path)
        code = gw_image_write_png(path, image, NULL, error);
    gw_interrupt_release();
    free(path);
    return code;
}

static gw_code write_pictures(const gw_ledger *ledger, const char *key, gw_error *error) {
    gw_image difference = {0};
    double mean;
    if (!ledger->folder)
        return GW_OK;
    gw_code code = gw_heat_picture(&ledger->exact[0].image, &ledger->picture, pixels_per_degree(ledger),
                                   &difference, &mean, error);
    if (!code)
        code = write_picture(ledger, key, 0, &ledger->picture, error);
    if (!code)
        code = write_picture(ledger, key, 1, &difference, error);
    gw_image_finish(&difference);
    return code;
}

static int has_pictures(const gw_ledger *ledger, const char *key) {
    int there = 1;
    for (int difference = 0; difference < 2 && ledger->folder; difference++) {
        char *path = gw_ledger_picture(ledger, key, difference);
        there = there && path && gw_file_exists(path);
        free(path);
    }
    return there;
}

static gw_code read_picture(const char *path, gw_image *out, gw_error *error) {
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, (size_t)256 << 20, &bytes, error);
    if (!code)
        code = gw_image_decode(bytes.data, bytes.size, path, (uint64_t)1 << 28, out, error);
    gw_bytes_finish(&bytes);
    return code;
}

/* A frame to compare with into its slot: from memory, from its file, or drawn. */
static gw_code take_slot(gw_ledger *ledger, const gw_ledger_frame *frame, gw_ledger_slot *slot,
                         gw_error *error) {
    char key[33];
    gw_ledger_frame_key(ledger, frame, key);
    if (!strcmp(key, slot->key))
        return GW_OK;
    char *path = gw_ledger_picture(ledger, key, 0);
    gw_image read = {0};
    gw_code code = GW_OK;
    slot->key[0] = '\0';
    if (path && gw_file_exists(path) && !read_picture(path, &read, NULL) && read.width == ledger->size[0] &&
        read.height == ledger->size[1]) {
        gw_image_finish(&slot->image);
        slot->image = read;
    } else {
        gw_image_finish(&read);
        code = draw_frame(ledger, frame, &slot->image, NULL, error);
        if (!code)
            code = write_picture(ledger, key, 0, &slot->image, error);
    }
    free(path);
    if (!code)
        memcpy(slot->key, key, sizeof key);
    return code;
}

/* --- points */

/* Viewers are those of the ledger's own settings, whatever is tried. */
static gw_code judge_of(const gw_ledger *ledger, uint32_t moment, gw_frame_block *block, gw_error *error) {
    const gw_ledger_frame judge = {.settings = ledger->bench->draw.settings, .moment = moment};
    const gw_frame_state state = state_of(ledger, &judge);
    const gw_model *model = &ledger->bench->model;
    const gw_bench_view *view = &ledger->views[moment].view;
    return gw_frame_block_fill(model->scene, model->octree, &view->placement, &view->plane, &state, block,
                               NULL, error);
}

static gw_metric_frame compared(const gw_ledger *ledger, const gw_image *picture,
                                const gw_geometry *geometry) {
    return (gw_metric_frame){.width = ledger->size[0],
                             .height = ledger->size[1],
                             .picture = picture,
                             .ids = geometry ? geometry->ids : NULL,
                             .depths = geometry ? geometry->depths : NULL,
                             .normals = geometry ? geometry->normals : NULL};
}

static gw_code compare(const gw_ledger *ledger, gw_metrics *out, gw_error *error) {
    gw_frame_block block;
    const gw_metric_view view = {.pixels_per_degree = pixels_per_degree(ledger), .block = &block};
    const gw_metric_frame reference = compared(ledger, &ledger->exact[0].image, &ledger->exact_geometry),
                          test = compared(ledger, &ledger->picture, &ledger->geometry);
    gw_code code = judge_of(ledger, 0, &block, error);
    return code ? code : gw_metrics_compare(&reference, &test, &view, out, error);
}

/* What the frames of all moments in their order change that the exact ones do not. */
static gw_code compare_track(gw_ledger *ledger, const gw_ledger_question *question, gw_metrics *out,
                             gw_error *error) {
    gw_metric_track track = {0};
    gw_metrics all;
    gw_code code = GW_OK;
    for (uint32_t moment = 0; moment < ledger->moments && !code; moment++) {
        gw_ledger_frame frame = question->frame;
        gw_frame_block block;
        const gw_metric_view view = {.pixels_per_degree = pixels_per_degree(ledger), .block = &block};
        const gw_metric_frame reference = compared(ledger, &ledger->exact[moment].image, NULL),
                              test = compared(ledger, moment ? &ledger->moving : &ledger->picture, NULL);
        frame.moment = moment;
        if (moment)
            code = draw_frame(ledger, &frame, &ledger->moving, NULL, error);
        if (!code)
            code = judge_of(ledger, moment, &block, error);
        if (!code)
            code = gw_metric_track_add(&track, &reference, &test, &view, NULL, error);
    }
    gw_metric_track_of(&track, &all);
    gw_metric_track_finish(&track);
    for (size_t i = GW_METRIC_FLICKER; i < GW_METRIC_COUNT && !code; i++)
        out->values[i] = all.values[i];
    return code;
}

static void count_costs(const gw_ledger *ledger, gw_ledger_point *point) {
    const gw_counters *c = &point->counters;
    const gw_octree *octree = ledger->bench->model.octree;
    point->costs[GW_LEDGER_RAYS] = (double)(c->rays + gw_secondary_rays(c));
    point->costs[GW_LEDGER_WORK] =
        point->costs[GW_LEDGER_RAYS] + (double)(c->node_loads + c->voxels + c->triangle_tests);
    point->costs[GW_LEDGER_BYTES] = (double)gw_renderer_bytes(ledger->counting);
    point->costs[GW_LEDGER_BUILD] = (double)octree->statistics.overlap_tests;
    point->octree_bytes = gw_octree_bytes(octree);
    point->nodes = octree->node_count;
    point->pairs = octree->statistics.pairs;
}

static gw_code compare_own(gw_ledger *ledger, const gw_ledger_question *question, double *own,
                           gw_error *error) {
    *own = (double)NAN;
    return question->own
               ? gw_flip(&ledger->own.image, &ledger->picture, pixels_per_degree(ledger), NULL, own, error)
               : GW_OK;
}

static gw_code measure(gw_ledger *ledger, const gw_ledger_question *question, gw_ledger_point *point,
                       gw_error *error) {
    const gw_frame_state state = state_of(ledger, &question->frame);
    const gw_bench_view *view = &ledger->views[0].view;
    const gw_model *model = &ledger->bench->model;
    gw_predicted_error predicted = {0};
    gw_code code = draw_frame(ledger, &question->frame, &ledger->picture, &point->counters, error);
    if (!code)
        code = trace_frame(ledger, &question->frame, &ledger->geometry, error);
    if (!code)
        code = gw_predict_error(model->scene, model->octree, &view->placement, &view->plane, &view->rectangle,
                                &state, &predicted, error);
    if (!code)
        code = compare(ledger, &point->errors, error);
    if (!code && ledger->moments > 1)
        code = compare_track(ledger, question, &point->errors, error);
    if (!code)
        code = compare_own(ledger, question, &point->own, error);
    if (!code)
        code = time_frame(ledger, state, point, error);
    if (code)
        return code;
    point->predicted = gw_predicted_error_mean(&predicted);
    point->worst = gw_predicted_error_worst(&predicted);
    count_costs(ledger, point);
    return write_pictures(ledger, point->key, error);
}

/* The exact frame of every moment, and what it meets in the still one. */
static gw_code take_exact(gw_ledger *ledger, const gw_ledger_frame *exact, gw_error *error) {
    gw_ledger_frame frame = *exact;
    gw_code code = GW_OK;
    char key[33];
    for (; frame.moment < ledger->moments && !code; frame.moment++)
        code = take_slot(ledger, &frame, &ledger->exact[frame.moment], error);
    gw_ledger_frame_key(ledger, exact, key);
    if (code || !strcmp(key, ledger->exact_geometry_key))
        return code;
    ledger->exact_geometry_key[0] = '\0';
    code = trace_frame(ledger, exact, &ledger->exact_geometry, error);
    if (!code)
        memcpy(ledger->exact_geometry_key, key, sizeof key);
    return code;
}

gw_code gw_ledger_measure(gw_ledger *ledger, const gw_ledger_question *question, gw_ledger_point *out,
                          gw_error *error) {
    char key[33];
    gw_ledger_key(ledger, question, key);
    const gw_ledger_point *known = gw_ledger_find(ledger, key);
    if (known && has_pictures(ledger, key)) {
        *out = *known;
        ledger->found++;
        return GW_OK;
    }
    *out = (gw_ledger_point){0};
    memcpy(out->key, key, sizeof key);
    gw_code code = take_exact(ledger, &question->exact, error);
    if (!code && question->own)
        code = take_slot(ledger, question->own, &ledger->own, error);
    if (!code)
        code = measure(ledger, question, out, error);
    if (!code && !known)
        code = gw_ledger_keep(ledger, out, error);
    ledger->measured++;
    return code;
}

static gw_code set_exact(gw_settings *settings, const gw_knob *knob, gw_error *error) {
    char assignment[2 * GW_KNOB_TEXT];
    snprintf(assignment, sizeof assignment, "%s=%s", knob->name, knob->exact);
    return gw_settings_assign(settings, assignment, error);
}

gw_code gw_ledger_exact(const gw_settings *settings, const gw_knob *swept, gw_ledger_frame *out,
                        gw_error *error) {
    *out = (gw_ledger_frame){.settings = *settings, .exact = 1};
    out->settings.gaze_rule = GW_GAZE_ACUITY; /* nobody looks; that of the paper coarsens all the same */
    gw_code code = GW_OK;
    for (size_t i = 0; i < gw_knob_count && !code; i++) {
        const gw_knob *knob = &gw_knobs[i];
        if (knob->exact && (knob->reference == GW_KNOB_EXACT || knob == swept))
            code = set_exact(&out->settings, knob, error);
    }
    return code;
}

/* --- opening */

static gw_code identify(gw_ledger *ledger, gw_error *error) {
    const gw_bench *bench = ledger->bench;
    const gw_ledger_view *still = &ledger->views[0];
    const struct {
        gw_hash scene;
        uint32_t version, octree, size[2], seed, reserved;
        gw_features forced, forbidden;
        double eye[3], gaze_eye[3], gaze_at[3], time;
        gw_plane plane;
        gw_similarity placement;
    } all = {.scene = bench->model.scene->hash,
             .version = LEDGER_VERSION,
             .octree = GW_OCTREE_BLOCK_VERSION,
             .size = {ledger->size[0], ledger->size[1]},
             .seed = bench->draw.seed,
             .forced = bench->draw.force_effects,
             .forbidden = bench->draw.forbid_effects,
             .eye = {still->view.eye[0], still->view.eye[1], still->view.eye[2]},
             .gaze_eye = {still->gaze_eye[0], still->gaze_eye[1], still->gaze_eye[2]},
             .gaze_at = {still->gaze_at[0], still->gaze_at[1], still->gaze_at[2]},
             .time = bench->draw.time,
             .plane = still->view.plane,
             .placement = still->view.placement};
    const char *device = gw_gl_limits_of(bench->model.device)->renderer;
    gw_code code = gw_ledger_hash_shaders(bench->draw.shaders, &ledger->identity, error);
    ledger->identity = gw_hash_bytes(ledger->identity, &all, sizeof all);
    ledger->identity = gw_hash_bytes(ledger->identity, GW_VERSION, sizeof GW_VERSION);
    ledger->identity = gw_hash_bytes(ledger->identity, device, strlen(device));
    return code;
}

static void step_aside(gw_bench_view *view, double distance) {
    const double *right = view->plane.step_x, pitch = sqrt(gw_dot(right, right));
    for (int k = 0; k < 3; k++)
        view->eye[k] += distance * right[k] / pitch;
}

static gw_code open_view(gw_ledger *ledger, gw_error *error) {
    gw_bench *bench = ledger->bench;
    gw_bench_path along;
    if (!bench->size[0]) {
        bench->size[0] = bench->quick ? 96 : 384;
        bench->size[1] = bench->quick ? 54 : 216;
    }
    memcpy(ledger->size, bench->size, sizeof ledger->size);
    gw_code code = gw_bench_path_open(bench, ledger->size[0], &along, error);
    for (uint32_t moment = 0; moment < ledger->moments && !code; moment++) {
        gw_ledger_view *out = &ledger->views[moment];
        code = gw_bench_view_at(&along, along.path ? GW_PATH_FRAMES / 2 + moment : 0, &out->view, error);
        if (!code)
            place_viewer(ledger, out);
        if (!code && !along.path)
            step_aside(&out->view, moment * walk);
    }
    return code;
}

static gw_code open_frames(gw_ledger *ledger, gw_error *error) {
    const uint32_t width = ledger->size[0], height = ledger->size[1];
    gw_code code = gw_image_create(width, height, &ledger->own.image, error);
    for (uint32_t moment = 0; moment < ledger->moments && !code; moment++)
        code = gw_image_create(width, height, &ledger->exact[moment].image, error);
    if (!code)
        code = gw_image_create(width, height, &ledger->picture, error);
    if (!code)
        code = gw_image_create(width, height, &ledger->moving, error);
    if (!code)
        code = gw_geometry_create(width, height, &ledger->geometry, error);
    return code ? code : gw_geometry_create(width, height, &ledger->exact_geometry, error);
}

gw_code gw_ledger_open(gw_ledger *ledger, gw_bench *bench, const char *path, const char *name,
                       gw_error *error) {
    *ledger = (gw_ledger){.bench = bench,
                          .path = path,
                          .repeats = bench->repeats ? bench->repeats
                                     : bench->quick ? 1
                                                    : 3,
                          .moments = bench->frames ? bench->frames : 1,
                          .by_processor = gw_gl_limits_of(bench->model.device)->software,
                          .built = bench->draw.settings};
    snprintf(ledger->name, sizeof ledger->name, "%s", name);
    bench->draw.scene = path;
    gw_code code = gw_model_import(&bench->model, &bench->draw, &bench->console.log, error);
    if (!code && ledger->repeats > MOST_REPEATS)
        code = gw_fail(error, GW_BAD_INPUT, "--repeats: bench accuracy draws a frame %d times at most",
                       MOST_REPEATS);
    if (!code)
        code = open_view(ledger, error);
    if (!code)
        code = identify(ledger, error);
    if (!code && bench->out && !(ledger->folder = gw_path_join(bench->out, name)))
        code = gw_fail(error, GW_MACHINE, "memory is out while naming a folder");
    if (!code && ledger->folder)
        code = gw_make_directories(ledger->folder, error);
    if (!code)
        code = open_frames(ledger, error);
    return code ? code : gw_ledger_load(ledger, error);
}

void gw_ledger_close(gw_ledger *ledger) {
    gw_renderer_destroy(&ledger->counting);
    gw_renderer_destroy(&ledger->timed);
    for (uint32_t moment = 0; moment < ledger->moments; moment++)
        gw_image_finish(&ledger->exact[moment].image);
    gw_image_finish(&ledger->own.image);
    gw_image_finish(&ledger->picture);
    gw_image_finish(&ledger->moving);
    gw_geometry_finish(&ledger->geometry);
    gw_geometry_finish(&ledger->exact_geometry);
    free(ledger->known);
    free(ledger->folder);
    if (ledger->bench)
        gw_model_drop(&ledger->bench->model);
    *ledger = (gw_ledger){0};
}
