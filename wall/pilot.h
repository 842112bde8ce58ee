/* The pilot: whoever steers a run while it goes on, with mouse and keys at the window of the whole wall, by
 * a file of recorded events (wall/input_script.h), or with a joystick that the site's trackers report. The
 * gaze follows the pointer, keys and mouse fly, and all of it goes into the frame state, so that a recorded
 * run is repeated to the same pictures.
 *
 * Rank 0, main thread. NULL stands for nobody: every call takes it and does nothing. */
#ifndef GW_WALL_PILOT_H
#define GW_WALL_PILOT_H

#include "base/status.h"
#include "render/frame_state.h"
#include "tracking/tracker.h"

#include <stdint.h>

struct gw_rank;
typedef struct gw_pilot gw_pilot;

/* ns from frame to frame when a file steers and no --step is given. */
#define GW_INPUT_STEP (INT64_C(1000000000) / 30)

/* Reads the file of events, if there is one; *out is NULL when nobody steers this run. The window is that of
 * the rank's device, which may be opened later, before the first frame. */
gw_code gw_pilot_open(const struct gw_rank *rank, gw_pilot **out, gw_error *error);
void gw_pilot_close(gw_pilot **pilot); /* before the device goes */

/* Takes what has happened since the frame before. */
void gw_pilot_poll(gw_pilot *pilot, uint32_t frame);
int gw_pilot_wants_end(const gw_pilot *pilot);    /* the window was closed: one last frame */
int gw_pilot_wants_pixels(const gw_pilot *pilot); /* they are looked at */

typedef enum gw_pilot_gaze {
    GW_PILOT_GAZE_GIVEN, /* what the command line says: a track, a pixel, nobody */
    GW_PILOT_GAZE_POINTER,
    GW_PILOT_GAZE_NONE
} gw_pilot_gaze;
/* Whose gaze counts; target: mm of wall space, for POINTER. */
gw_pilot_gaze gw_pilot_gaze_of(const gw_pilot *pilot, double target[3]);
/* What the site's navigating device asks for; until it says otherwise. */
void gw_pilot_take_wand(gw_pilot *pilot, const gw_wand *wand);
/* Puts where the pilot has flown to into a state that has time, eye and gaze. */
gw_code gw_pilot_steer(gw_pilot *pilot, gw_frame_state *state, gw_error *error);

/* What there is to tell about a frame. */
typedef struct gw_pilot_facts {
    const gw_frame_state *state;
    const uint8_t *const *pixels; /* of each tile, NULL for one without this frame */
    uint64_t lost;                /* bit i: tile i is lost */
    double milliseconds;          /* release to last pixel */
    uint64_t rays;
} gw_pilot_facts;
gw_code gw_pilot_show(gw_pilot *pilot, const gw_pilot_facts *facts, gw_error *error);

#endif
