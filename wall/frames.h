/* Frame states: made from what the tracker says at a moment, or read from a recording of states; written one
 * per frame.
 *
 * A recording (--save-states, --states) is JSON lines: a first line {"gazewall_states": 1}, then one object
 * per frame with every field of gw_frame_state; numbers carry enough digits to come back bit for bit. Rank 0
 * only. */
#ifndef GW_WALL_FRAMES_H
#define GW_WALL_FRAMES_H

#include "base/settings.h"
#include "base/status.h"
#include "render/frame_state.h"
#include "tracking/tracker.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* A state without time, eye and gaze: number, FRAME settings, seed, debug view. */
void gw_frame_begin(gw_frame_state *state, uint32_t frame, const gw_settings *settings, uint32_t seed,
                    gw_debug_view debug);

/* Eyes and gazes as the tracker sees them. The picture is drawn for the first viewer's eye; the gazes of all
 * viewers count. A viewer without a gaze, or whose gaze has no confidence left, is not in the list; without
 * any, nobody's gaze is known and all is sharp. A gaze that is less sure than gaze_margin allows, or in a
 * saccade, has a wider ellipsoid. */
void gw_frame_look(gw_frame_state *state, const gw_tracker_view *view, const gw_settings *settings);

/* A fixed eye and, unless target is NULL, a gaze at a point of wall space (mm). */
void gw_frame_stare(gw_frame_state *state, const double eye[3], const double *target,
                    const gw_settings *settings);

/* Sets eye_offset: two eyes `distance` mm apart along the first viewer's head, or along wall space's x where
 * it (view may be NULL) is not tracked. */
void gw_frame_part_eyes(gw_frame_state *state, const gw_tracker_view *view, double distance);

/* Heads and eyes are never quite still: where the eyes and every viewer's lie within `distance` mm, and the
 * gazes within `angle` degrees, of those that the frame before was drawn from, those stand. They are the ones
 * of the view's first sample, so nobody drifts away unseen. before may be NULL. */
void gw_frame_hold(gw_frame_state *state, const gw_frame_state *before, double distance, double angle);

/* Counts the samples of a still view: state->accumulate, on entry the most that may be added up, becomes how
 * many are, and epoch the number of the view. before is the frame before, NULL for the first one. With 1
 * nothing is counted. */
void gw_frame_accumulate(gw_frame_state *state, const gw_frame_state *before, int scene_moves);

enum { GW_MAXIMUM_STATES = 1000000 }; /* of a recording */

typedef struct gw_states {
    size_t count;
    gw_frame_state *states; /* owned */
} gw_states;

gw_code gw_states_load(const char *path, gw_states *out, gw_error *error);
void gw_states_finish(gw_states *states);
/* One state as JSON (NULL: memory is out), and back; path and line are for messages. */
json_t *gw_state_pack(const gw_frame_state *state);
gw_code gw_state_take(const json_t *object, const char *path, size_t line, gw_frame_state *out,
                      gw_error *error);

gw_code gw_states_save(const char *path, const gw_frame_state *states, size_t count, gw_error *error);

#endif
