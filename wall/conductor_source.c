/* What the frames of a run are made from: trackers, recorded states, a fixed gaze, a camera path. */
#include "wall/conductor_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/rank.h"
#include "wall/report.h"
#include "wall/stereo.h"

#include <inttypes.h>
#include <string.h>

static gw_code open_tracking(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    const gw_tracked_options how = {.track = options->track,
                                    .site = &rank->site,
                                    .settings = &options->draw.settings,
                                    .log = &rank->line.log};
    gw_code code = gw_tracked_open(&how, conductor->report, &conductor->tracked, error);
    if (code || gw_tracked_is_live(conductor->tracked))
        return code;
    int64_t left = gw_tracked_duration(conductor->tracked) - conductor->first_time;
    /* Without the far end: on a track that comes back to its start, the last frame would repeat the first. */
    if (options->step < 0 && !gw_sim_runs_free(options))
        conductor->step = left > 0 ? left / conductor->frame_count : 0;
    return GW_OK;
}

static gw_code choose_source(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    conductor->frame_count = options->frames ? options->frames : gw_sim_runs_free(options) ? GW_ENDLESS : 1;
    gw_budget_init(&conductor->budget, options->budget_ms, options->budget_rays,
                   options->draw.settings.strain);
    gw_exposure_init(&conductor->exposure, &options->draw.settings);
    if (conductor->exposure.automatic && conductor->frame_count == 1 && !options->states &&
        !options->pictures.remake)
        gw_log_write(&rank->line.log, GW_LOG_WARNING,
                     "exposure=auto follows the frames before, and a single frame has none: it is drawn at 0 "
                     "stops; use --frames 2, or gazewall render, which meters first");
    conductor->first_time = (int64_t)(options->draw.time * 1e9);
    conductor->step = options->step > 0                     ? (int64_t)(options->step * 1e9)
                      : options->step < 0 && options->input ? GW_INPUT_STEP
                                                            : 0;
    if (options->pictures.remake) {
        conductor->recorded.count = 1;
        gw_code code = gw_allocate((void **)&conductor->recorded.states, 1, sizeof(gw_frame_state),
                                   "frame states", error);
        if (!code)
            conductor->recorded.states[0] = options->remade.state;
        return code;
    }
    if (options->states) {
        gw_code code = gw_states_load(options->states, &conductor->recorded, error);
        if (code)
            return code;
        if (!options->frames)
            conductor->frame_count = (uint32_t)conductor->recorded.count;
        if (conductor->frame_count > conductor->recorded.count)
            return gw_fail(error, GW_BAD_INPUT, "%s holds %zu frame states, --frames asks for %" PRIu32,
                           options->states, conductor->recorded.count, conductor->frame_count);
        return GW_OK;
    }
    if (options->gaze == GW_GAZE_AT_PIXEL)
        return gw_layout_point(&rank->site.layout, options->gaze_pixel, conductor->stare, error);
    return options->gaze == GW_GAZE_NONE ? GW_OK : open_tracking(conductor, rank, error);
}

gw_code gw_conductor_choose_source(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const uint32_t kept_when_endless = 1u << 16;
    gw_code code = choose_source(conductor, rank, error);
    const int endless = conductor->frame_count == GW_ENDLESS;
    const gw_sim_options *options = &rank->options;
    conductor->kept = !endless               ? conductor->frame_count
                      : options->save_states ? GW_MAXIMUM_STATES
                                             : kept_when_endless;
    const int live = conductor->tracked && gw_tracked_is_live(conductor->tracked);
    if ((gw_sim_runs_free(options) || live) && options->step < 0 && !options->input && !options->states)
        conductor->started = gw_now_ns();
    return code;
}

/* Frames without an end, and those that somebody steers, follow the clock, unless they have a step; a track
 * begins anew when it is over. */
static int64_t time_of(const gw_conductor *conductor, uint32_t frame) {
    if (!conductor->started || !frame)
        return conductor->first_time + (int64_t)frame * conductor->step;
    int64_t passed = gw_now_ns() - conductor->started;
    int64_t left = conductor->tracked ? gw_tracked_duration(conductor->tracked) - conductor->first_time : 0;
    return conductor->first_time + (left > 0 ? passed % left : passed);
}

/* Every frame looks somewhere: where eye and look_at of a path meet, nothing says where to. */
static gw_code check_path(const gw_conductor *conductor, const char *name, gw_error *error) {
    const int64_t endless_step = 10000000;
    const int clocked = conductor->started != 0;
    const double end = conductor->path.keys[conductor->path.key_count - 1].time;
    for (uint32_t frame = 0; frame < conductor->frame_count; ++frame) {
        const int64_t step = clocked ? endless_step : conductor->step;
        const double time = (double)(conductor->first_time + (int64_t)frame * step) * 1e-9;
        if (conductor->frame_count == GW_ENDLESS && (time > end || (frame && step == 0)))
            break;
        double stand[3], look_at[3];
        gw_camera_path_at(&conductor->path, time, stand, look_at);
        if ((float)stand[0] == (float)look_at[0] && (float)stand[1] == (float)look_at[1] &&
            (float)stand[2] == (float)look_at[2])
            return gw_fail(
                error, GW_BAD_INPUT,
                "path '%s' has no direction at %.3f s (frame %u): eye and look_at are the same point "
                "%g,%g,%g; move one of them in the keys about that time",
                name, time, (unsigned)frame, stand[0], stand[1], stand[2]);
    }
    return GW_OK;
}

/* The scene's path is needed longer than rank 0 has the scene. Without --step and a track's pace, frames are
 * spread over what is left of it. */
gw_code gw_conductor_take_path(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_camera_path *path = NULL;
    const gw_sim_options *options = &rank->options;
    if (!options->path)
        return GW_OK;
    gw_code code = gw_camera_path_find(rank->model.scene, options->path, &path, error);
    if (!code)
        code = gw_allocate((void **)&conductor->path.keys, path->key_count, sizeof *path->keys, "camera path",
                           error);
    if (code)
        return code;
    memcpy(conductor->path.keys, path->keys, path->key_count * sizeof *path->keys);
    conductor->path.key_count = path->key_count;
    double rest = path->keys[path->key_count - 1].time - options->draw.time;
    if (options->step < 0 && !gw_sim_runs_free(options))
        conductor->step =
            conductor->frame_count > 1 && rest > 0 ? (int64_t)(rest * 1e9 / (conductor->frame_count - 1)) : 0;
    return check_path(conductor, options->path, error);
}

static void navigate(const gw_conductor *conductor, gw_frame_state *state) {
    double stand[3], look_at[3];
    if (!conductor->path.keys)
        return;
    gw_camera_path_at(&conductor->path, (double)state->time * 1e-9, stand, look_at);
    for (int k = 0; k < 3; k++) {
        state->stand[k] = (float)stand[k];
        state->look_at[k] = (float)look_at[k];
    }
}

/* How far ahead a frame is seen that is made now, ns: as it was lately. In the first one kernels are
 * compiled, so its time is not like the others'. */
static int64_t lead_of(const gw_conductor *conductor, uint32_t frame) {
    const uint32_t known = frame < GW_USUAL_FRAMES ? frame : GW_USUAL_FRAMES;
    return frame < 2 ? 0 : (int64_t)(1e6 * gw_spread_of(conductor->ahead_ms, known).median);
}

/* Eyes and gaze: those of the trackers, of the command line, or of the pilot. */
static void look(gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame, int64_t time,
                 gw_frame_state *state) {
    const gw_settings *settings = &rank->options.draw.settings;
    const gw_site *site = &rank->site;
    double pointed[3];
    const double *target = NULL;
    const gw_pilot_gaze gaze = gw_pilot_gaze_of(conductor->pilot, pointed);
    const gw_tracker_view *view = NULL;
    gw_latency *latency = &conductor->latencies[gw_kept(conductor, frame)];
    if (gaze == GW_PILOT_GAZE_GIVEN && conductor->tracked)
        view = gw_tracked_look(conductor->tracked, time, lead_of(conductor, frame), &site->layout);
    if (gaze == GW_PILOT_GAZE_POINTER)
        target = pointed;
    else if (gaze == GW_PILOT_GAZE_GIVEN && rank->options.gaze == GW_GAZE_AT_PIXEL)
        target = conductor->stare;
    if (view) {
        gw_wand wand;
        gw_tracked_wand(conductor->tracked, &wand);
        gw_pilot_take_wand(conductor->pilot, &wand);
        gw_frame_look(state, view, settings);
    } else {
        gw_frame_stare(state, site->layout.eye, target, settings);
    }
    conductor->fixations =
        view ? *gw_tracked_fixations(conductor->tracked) : (gw_fixations){.viewers = {{0}}};
    *latency = view ? gw_latency_of(&view->viewers[0]) : (gw_latency){0};
    state->time = time;
    if (gw_site_is_stereo(site))
        gw_frame_part_eyes(state, view, site->eye_distance);
}

gw_code gw_conductor_make_state(gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                                gw_frame_state *state, gw_error *error) {
    const gw_draw_options *draw = &rank->options.draw;
    if (conductor->recorded.count) {
        *state = conductor->recorded.states[frame];
        return GW_OK;
    }
    gw_frame_begin(state, frame, &draw->settings, draw->seed, draw->debug);
    look(conductor, rank, frame, time_of(conductor, frame), state);
    navigate(conductor, state);
    gw_code code = gw_pilot_steer(conductor->pilot, state, error);
    if (gw_budget_is_on(&conductor->budget))
        state->strain = gw_budget_strain(&conductor->budget);
    gw_exposure_decide(&conductor->exposure, state);
    const gw_frame_state *before = frame ? &conductor->states[gw_kept(conductor, frame - 1)] : NULL;
    if (draw->settings.accumulate > 1)
        gw_frame_hold(state, before, rank->options.still[0], rank->options.still[1]);
    gw_frame_accumulate(state, before, conductor->scene_moves);
    return code;
}
