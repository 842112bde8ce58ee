#include "wall/pilot.h"

#include "base/clock.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/controls.h"
#include "wall/input_script.h"
#include "wall/layout_look.h"
#include "wall/rank.h"
#include "wall/surfaces.h"
#include "wall/wall_view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Frames over which the rate is told, and the longest time that one step of navigation stands for: after a
 * pause nobody should find themselves elsewhere. */
enum { RATE_FRAMES = 16 };
static const double longest_step = 0.25;
static const double default_speed = 1.4; /* m/s, somebody who walks */

struct gw_pilot {
    const struct gw_rank *rank;
    gw_window *window;  /* the device's, since the first frame; NULL: events come from the file alone */
    gw_wall_view *view; /* made for the first frame */
    gw_input_script script;
    size_t script_at; /* next event of it */
    gw_controls controls;
    gw_pilot_gaze gaze;
    int given;       /* the command line says where somebody looks */
    double pixel[2]; /* of the wall's picture, that is pointed at */
    int flying;
    gw_navigation navigation;
    gw_wand wand;
    int64_t last_time; /* ns of the frame before, for steps of navigation; negative: none */
    int birdseye, help, ring;
    int64_t shown[RATE_FRAMES]; /* ns, when the last frames were shown */
    uint32_t shown_count;
};

/* --- opening
 * --------------------------------------------------------------------------------------------------- */

/* The site's trackers have a device that navigates. */
static int has_wand(const struct gw_rank *rank) {
    const gw_tracker_navigation *navigation = &rank->site.trackers.navigation;
    return !rank->options.states &&
           (navigation->forward >= 0 || navigation->turn >= 0 || navigation->reset >= 0);
}

gw_code gw_pilot_open(const struct gw_rank *rank, gw_pilot **out, gw_error *error) {
    gw_pilot *pilot = NULL;
    const gw_sim_options *options = &rank->options;
    *out = NULL;
    if (!gw_sim_is_steered(options) && !has_wand(rank))
        return GW_OK;
    gw_code code = gw_allocate((void **)&pilot, 1, sizeof *pilot, "pilot", error);
    if (code)
        return code;
    pilot->rank = rank;
    pilot->given = options->track || options->gaze != GW_GAZE_FROM_TRACK || rank->site.trackers.source_count;
    pilot->gaze = pilot->given ? GW_PILOT_GAZE_GIVEN : GW_PILOT_GAZE_POINTER;
    for (int k = 0; k < 2; k++)
        pilot->pixel[k] = 0.5 * rank->site.layout.picture[k];
    pilot->last_time = -1;
    pilot->ring = 1;
    if (options->input)
        code = gw_input_script_load(options->input, &pilot->script, error);
    if (!code && options->input && options->windows == GW_WINDOWS_NONE && !options->cluster &&
        !options->frames && !gw_input_script_ends(&pilot->script))
        code =
            gw_fail(error, GW_BAD_INPUT,
                    "%s: has no line 'FRAME close', and there is no window to close: this would never end; "
                    "add that line, or give --frames N or --window",
                    options->input);
    if (code)
        gw_pilot_close(&pilot);
    *out = pilot;
    return code;
}

void gw_pilot_close(gw_pilot **pilot) {
    if (!*pilot)
        return;
    gw_wall_view_close(&(*pilot)->view);
    gw_input_script_finish(&(*pilot)->script);
    free(*pilot);
    *pilot = NULL;
}

/* --- what happens
 * ---------------------------------------------------------------------------------------------- */

static void toggle(gw_pilot *pilot, int32_t key, int *what) {
    *what ^= (int)(gw_controls_pressed(&pilot->controls, key) & 1);
}

static void take_keys(gw_pilot *pilot) {
    int lit = 0;
    toggle(pilot, 'B', &pilot->birdseye);
    toggle(pilot, 'R', &pilot->ring);
    toggle(pilot, 'H', &pilot->help);
    toggle(pilot, GW_KEY_F1, &pilot->help);
    toggle(pilot, GW_KEY_HOME, &lit);
    if (lit)
        pilot->flying = 0;
    for (unsigned presses = gw_controls_pressed(&pilot->controls, 'G'); presses % 3; presses--)
        pilot->gaze = (pilot->gaze + 1) % 3;
}

/* While a file steers, a pointer that happens to stand in the window must not: the flight would be another
 * one.
 */
static void take_window_event(gw_pilot *pilot, gw_event event) {
    if (pilot->script_at < pilot->script.count && event.kind != GW_EVENT_CLOSE)
        return;
    if (event.kind == GW_EVENT_POINTER)
        gw_wall_view_share(pilot->view, event.position, event.position);
    gw_controls_note(&pilot->controls, &event);
}

static void take_script_event(gw_pilot *pilot, const gw_input_event *scripted) {
    const gw_event *event = &scripted->event;
    if (scripted->resizes) {
        const uint32_t size[2] = {(uint32_t)event->position[0], (uint32_t)event->position[1]};
        if (pilot->window)
            gw_window_resize(pilot->window, size);
        return;
    }
    gw_controls_note(&pilot->controls, event);
}

void gw_pilot_poll(gw_pilot *pilot, uint32_t frame) {
    if (!pilot)
        return;
    if (pilot->window) {
        size_t count;
        const gw_event *events = gw_window_poll(pilot->window, &count);
        for (size_t i = 0; i < count; i++)
            take_window_event(pilot, events[i]);
    }
    for (; pilot->script_at < pilot->script.count && pilot->script.events[pilot->script_at].frame <= frame;
         pilot->script_at++)
        take_script_event(pilot, &pilot->script.events[pilot->script_at]);
    take_keys(pilot);
    if (pilot->controls.pointer_known) {
        const gw_layout *layout = &pilot->rank->site.layout;
        const double framed[2] = {pilot->controls.pointer[0] * layout->framed[0],
                                  pilot->controls.pointer[1] * layout->framed[1]};
        gw_layout_framed_pixel(layout, framed, pilot->pixel);
    }
}

int gw_pilot_wants_end(const gw_pilot *pilot) {
    return pilot && pilot->controls.close;
}

int gw_pilot_wants_pixels(const gw_pilot *pilot) {
    return pilot && pilot->rank->options.windows == GW_WINDOWS_WALL;
}

gw_pilot_gaze gw_pilot_gaze_of(const gw_pilot *pilot, double target[3]) {
    gw_error ignored = {0};
    if (!pilot)
        return GW_PILOT_GAZE_GIVEN;
    if (pilot->gaze == GW_PILOT_GAZE_POINTER &&
        gw_layout_point(&pilot->rank->site.layout, pilot->pixel, target, &ignored))
        return GW_PILOT_GAZE_NONE;
    return pilot->gaze;
}

/* --- flying
 * ---------------------------------------------------------------------------------------------------- */

static gw_code take_off(gw_pilot *pilot, const gw_frame_state *state, gw_error *error) {
    const struct gw_rank *rank = pilot->rank;
    const gw_layout *layout = &rank->site.layout;
    gw_similarity placement;
    gw_code code = gw_place_frame(&rank->share.scene.scene, state, layout->size[0], layout->size[1],
                                  layout->centre, layout->eye, &placement, error);
    if (!code)
        pilot->navigation = gw_navigation_of(&placement, layout->eye,
                                             rank->site.fly_speed > 0 ? rank->site.fly_speed : default_speed);
    pilot->flying = !code;
    return code;
}

void gw_pilot_take_wand(gw_pilot *pilot, const gw_wand *wand) {
    if (!pilot)
        return;
    if (wand->resets != pilot->wand.resets)
        pilot->flying = 0;
    pilot->wand = *wand;
}

gw_code gw_pilot_steer(gw_pilot *pilot, gw_frame_state *state, gw_error *error) {
    if (!pilot)
        return GW_OK;
    const double passed = pilot->last_time < 0 ? 0 : (double)(state->time - pilot->last_time) * 1e-9;
    gw_navigation_input input = gw_controls_take(&pilot->controls);
    gw_code code = GW_OK;
    gw_controls_add_wand(&input, &pilot->wand);
    pilot->last_time = state->time;
    if (!pilot->flying && gw_navigation_is_asked(&input))
        code = take_off(pilot, state, error);
    if (code || !pilot->flying)
        return code;
    gw_scene_surfaces scene;
    const gw_surfaces surfaces =
        gw_scene_surfaces_of(&scene, pilot->rank->renderer, &pilot->rank->share.scene.scene);
    pilot->navigation =
        gw_navigate(&pilot->navigation, &input, passed < longest_step ? passed : longest_step, &surfaces);
    gw_navigation_apply(&pilot->navigation, state);
    if (scene.error.code)
        code = gw_fail(error, scene.error.code, "looking for obstacles: %s", scene.error.text);
    return code;
}

/* --- showing
 * --------------------------------------------------------------------------------------------------- */

/* Frames a second over the last ones. */
static double rate(gw_pilot *pilot) {
    const int64_t now = gw_now_ns();
    const uint32_t kept = pilot->shown_count < RATE_FRAMES ? pilot->shown_count : RATE_FRAMES;
    const int64_t first = kept ? pilot->shown[(pilot->shown_count - kept) % RATE_FRAMES] : now;
    pilot->shown[pilot->shown_count++ % RATE_FRAMES] = now;
    return now > first ? kept * 1e9 / (double)(now - first) : 0;
}

static void write_status(gw_pilot *pilot, const gw_pilot_facts *facts, char *text, size_t size) {
    static const char *const gazes[] = {"track", "mouse", "nobody's: sharp everywhere"};
    const gw_frame_state *state = facts->state;
    const char *gaze = pilot->gaze == GW_PILOT_GAZE_GIVEN && !state->gaze_count ? gazes[GW_PILOT_GAZE_NONE]
                                                                                : gazes[pilot->gaze];
    char looked[64] = "";
    if (pilot->gaze == GW_PILOT_GAZE_POINTER)
        snprintf(looked, sizeof looked, " %.0f,%.0f px", pilot->pixel[0], pilot->pixel[1]);
    char flown[96] = "";
    if (pilot->flying)
        snprintf(flown, sizeof flown, "   at %.1f,%.1f,%.1f m, %.3g m/s", pilot->navigation.position[0],
                 pilot->navigation.position[1], pilot->navigation.position[2], pilot->navigation.speed);
    snprintf(text, size, "%.1f fps  %.0f ms  %.2f Mrays   gaze: %s%s%s   H: help", rate(pilot),
             facts->milliseconds, (double)facts->rays * 1e-6, gaze, looked, flown);
}

gw_code gw_pilot_show(gw_pilot *pilot, const gw_pilot_facts *facts, gw_error *error) {
    if (!gw_pilot_wants_pixels(pilot))
        return GW_OK;
    gw_code code = GW_OK;
    char status[256];
    pilot->window = gw_gl_window(pilot->rank->model.device);
    if (!pilot->view)
        code = gw_wall_view_open(pilot->rank->model.device, &pilot->rank->site.layout, &pilot->view, error);
    if (code)
        return code;
    write_status(pilot, facts, status, sizeof status);
    const gw_wall_view_content content = {.pixels = facts->pixels,
                                          .lost = facts->lost,
                                          .state = facts->state,
                                          .status = status,
                                          .help = pilot->help ? gw_controls_help : NULL,
                                          .birdseye = pilot->birdseye,
                                          .ring = pilot->ring};
    return gw_wall_view_show(pilot->view, &content, error);
}
