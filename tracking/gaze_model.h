/* Where a viewer looks, from what is known: from the head's pose alone, from that and where the eyes are in
 * the head, or from an eye tracker; and where on the wall a gaze rests, how surely. Pure functions of their
 * arguments, the same bits on every machine; any thread. Wall space, millimetres; angles in degrees.
 *
 * Errors are half-angles that 95 of 100 gazes stay within.
 *   Head alone: eyes turn in heads before heads follow. Sitzmann et al. 2018 (Saliency in VR: How do people
 *   explore virtual environments?, section 3) found gazes 14 degrees off the head's direction on average;
 * were both coordinates normal, 95 of 100 would be within 2.45 sigma = 2.45 * 14 / 1.25 = 27 degrees. Eye
 * trackers: worn ones are off by 0.8 to 1.4 degrees on average in rooms, whatever their makers say (MacInnes
 * et al. 2018, Wearable Eye-tracking for Research); twice that is 3 degrees at most. */
#ifndef GW_TRACKING_GAZE_MODEL_H
#define GW_TRACKING_GAZE_MODEL_H

#include "tracking/event.h"
#include "tracking/setup.h"

#include <stdint.h>

/* A head in wall space: the sensor on it, the middle between its eyes, and how its axes (x right, y up,
 * looking along -z) are turned. */
typedef struct gw_head {
    double sensor[3], eye[3], orientation[4];
} gw_head;

/* From the head sensor's pose in the source's numbers. */
void gw_head_of_pose(const gw_tracker_setup *setup, uint32_t viewer, const double position[3],
                     const double orientation[4], gw_head *out);
/* (0, 0, -1) turned: the gaze that a head or a gaze sensor with this orientation has. */
void gw_gaze_along(const double orientation[4], double out_direction[3]);

/* Below this openness of the eyes, or with a quality below 0, a gaze event says nothing: a blink. */
#define GW_GAZE_OPEN 0.3
int gw_gaze_is_open(const gw_tracking_event *event);

/* A gaze event in wall space. head may be NULL; then a gaze in the head's frame says nothing. The origin is
 * the event's own if it has one, else the eye. Returns 0 if there is no direction, or, in the device's frame
 * without an origin, no eye: then `origin` is left alone and the caller's neutral eye holds. */
typedef struct gw_gaze_line {
    int has_origin;
    double origin[3], direction[3];
} gw_gaze_line;
int gw_gaze_of_event(const gw_tracking_event *event, const gw_room *room, const gw_head *head,
                     gw_gaze_line *out);

/* How much wider than its settings a viewer's ellipsoid has to be, each half-angle: what gaze_error exceeds
 * the margin by, which is there for tracker errors already. So a viewer's margin is at least the gaze's
 * error. */
double gw_gaze_widening(double gaze_error, double gaze_margin);

/* Part of a wall: a corner and two edges at right angles, mm. */
typedef struct gw_wall_rectangle {
    double corner[3], across[3], down[3];
} gw_wall_rectangle;

/* The nearest point in which a ray meets one of them (from either side), and which; -1: none. */
int32_t gw_gaze_meets(const gw_wall_rectangle *walls, uint32_t count, const double origin[3],
                      const double direction[3], double out_point[3]);

/* One recent gaze: where it met the wall. */
typedef struct gw_gaze_spot {
    double point[3];
    int is_open; /* else a blink, or no meeting with the wall: dropped */
} gw_gaze_spot;

enum { GW_FIXATION_SPOTS = 64 }; /* of more, the last ones count */

/* What recent gazes say together, seen from an eye. */
typedef struct gw_fixation {
    uint32_t used, dropped; /* blinks, gazes beside the wall, points that are none or at the eye */
    double point[3];        /* the middle, on the spots' plane where they share one */
    double half_angles[2];  /* of the ellipse that holds 95 of 100 gazes (normal), the greater first */
    double along[3];        /* unit, across the line of sight: where the greater one lies */
    double disk;            /* half-angle of the smallest cone about its own middle that holds all */
    int is_fixation;        /* disk below GW_FIXATION_DISK: the gaze rests; else it moves, or moved */
} gw_fixation;
#define GW_FIXATION_DISK 1.0

/* Returns 0 if no spot can be used. One spot, equal spots and spots on a line are cases like others: an angle
 * of the ellipse, or both, is 0. */
int gw_fixation_of(const gw_gaze_spot *spots, uint32_t count, const double eye[3], gw_fixation *out);

#endif
