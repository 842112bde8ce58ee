/* Calibration: where a tracking device stands in the room, in which unit and along which axes it measures,
 * from points whose places in wall space are known. Pure functions; one thread per call.
 *
 *   wall = unit * turn A device + shift
 *
 * by least squares over rotations and over reflections (Horn 1987, Closed-form solution of absolute
 * orientation using unit quaternions: the rotation is the eigenvector of the greatest eigenvalue of a 4x4
 * matrix; of the device's mirror image it is the best reflection), unit and shift after Umeyama 1991. Three
 * points not on a line give everything but the hand; four not in a plane give that, too. */
#ifndef GW_TRACKING_CALIBRATE_H
#define GW_TRACKING_CALIBRATE_H

#include "base/status.h"
#include "tracking/room.h"

#include <stdint.h>

enum { GW_CALIBRATION_POINTS = 64 };

typedef struct gw_calibration_point {
    char name[32];
    double wall[3];   /* mm, measured */
    double device[3]; /* in the device's unit and axes, reported */
} gw_calibration_point;

typedef struct gw_calibration {
    gw_room room;
    double rms;                              /* mm, of the points used */
    double residuals[GW_CALIBRATION_POINTS]; /* mm, each point's */
    double alone[GW_CALIBRATION_POINTS];     /* mm, each point's by what all others say; below 0: too few */
    double spread[3];                        /* mm, deviations of the marks along their own three axes */
    int32_t left_out;                        /* the one bad point that was not used, or -1 */
    int hand_known;                          /* else the points lie in a plane: taken for right-handed */
    int unit_snapped, turn_snapped;          /* to a usual unit; to a pure axis map */
    double measured_unit, measured_turn;     /* mm and degrees, before that */
    double expected;                         /* mm: standard error of a position in the points' middle */
    double expected_turn; /* degrees: of the turn, about the axis it is worst known about */
} gw_calibration;

/* Names what is wrong as GW_BAD_INPUT: fewer than three points, points on a line, points that are the same,
 * positions of the device that never change. snap: unit and turn may become usual ones where the points do
 * not speak against it (an F test at the residuals' own size). */
gw_code gw_calibrate(const gw_calibration_point *points, uint32_t count, int snap, gw_calibration *out,
                     gw_error *error);

/* The samples of one mark: their mean, and how far they are from it. Standing still, or moving? */
enum { GW_MARK_SAMPLES = 4096 };
typedef struct gw_mark {
    uint32_t count;
    double mean[3];
    double spread;   /* root of the mean squared distance from the mean, in the samples' unit */
    double farthest; /* from the mean, of any sample */
} gw_mark;
/* Samples that are no numbers are left out. */
void gw_mark_of(double (*samples)[3], uint32_t count, gw_mark *out);

/* What a viewer's gazes at known targets were off by. Degrees; right and up as the viewer sees it. */
typedef struct gw_gaze_sample {
    double target[3], eye[3], direction[3]; /* wall space, mm */
} gw_gaze_sample;
typedef struct gw_gaze_check {
    uint32_t used, dropped; /* dropped: no direction, or a target at the eye */
    double bias[2];         /* mean error to the right and up */
    double spread[2];       /* standard deviations about it */
    double median, most;    /* of 50 and of 95 of 100 gazes, bias included */
} gw_gaze_check;
/* Returns 0 if no sample can be used. */
int gw_gaze_check_of(const gw_gaze_sample *samples, uint32_t count, gw_gaze_check *out);

#endif
