/* What a track says at a moment, and the demo track. */
#include "base/embedded.h"
#include "base/portable_math.h"
#include "tracking/quaternion.h"
#include "tracking/track.h"

#include <math.h>

static const double FRESH = 0.1; /* s: six reports at 60 Hz may be missing before confidence falls */
static const double LOST = 0.5;  /* s */

/* The wall in front of which the demo track was recorded, mm. */
static const double RECORDED_WIDTH = 2000.0, RECORDED_HEIGHT = 1125.0;

typedef struct pose {
    double position[3], orientation[4];
    int64_t age;
} pose;

static void slerp(const double a[4], const double b[4], double t, double out[4]) {
    double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    double sign =
        dot < 0.0 ? -1.0 : 1.0; /* q and -q are one orientation: take the nearer, so the way is the shorter */
    double angle = gw_acos(sign * dot);
    double weight_a = 1.0 - t, weight_b = t;
    if (angle > 1e-4) { /* below it the straight line differs from the arc by less than rounding */
        double sine = gw_sin(angle);
        weight_a = gw_sin((1.0 - t) * angle) / sine;
        weight_b = gw_sin(t * angle) / sine;
    }
    double length = 0.0;
    for (int i = 0; i < 4; i++) {
        out[i] = weight_a * a[i] + sign * weight_b * b[i];
        length += out[i] * out[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 4; i++)
        out[i] /= length;
}

/* How many of the sensor's reports are at or before time. */
static size_t reports_until(const gw_track *track, int sensor, int64_t time) {
    size_t low = 0, high = track->sensor_count[sensor];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (track->reports[track->sensor_reports[sensor][middle]].time <= time)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static int pose_at(const gw_track *track, int sensor, int64_t time, pose *out) {
    size_t count = track->sensor_count[sensor];
    if (count == 0)
        return 0;
    size_t until = reports_until(track, sensor, time);
    const gw_pose_report *before = &track->reports[track->sensor_reports[sensor][until > 0 ? until - 1 : 0]];
    const gw_pose_report *after =
        &track->reports[track->sensor_reports[sensor][until < count ? until : count - 1]];
    double t = 0.0;
    if (after->time > before->time)
        t = (double)(time - before->time) / (double)(after->time - before->time);
    for (int i = 0; i < 3; i++)
        out->position[i] = before->position[i] + (after->position[i] - before->position[i]) * t;
    slerp(before->orientation, after->orientation, t, out->orientation);
    out->age = time >= before->time ? time - before->time : before->time - time;
    return 1;
}

/* (0,0,-1) turned by the quaternion. */
static void gaze_of(const double q[4], double direction[3]) {
    double x = q[0], y = q[1], z = q[2], w = q[3];
    direction[0] = -2.0 * (x * z + w * y);
    direction[1] = -2.0 * (y * z - w * x);
    direction[2] = -(1.0 - 2.0 * (x * x + y * y));
    double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    for (int i = 0; i < 3; i++)
        direction[i] /= length;
}

/* (1,0,0) turned by the quaternion. */
static void right_of(const double q[4], double direction[3]) {
    double x = q[0], y = q[1], z = q[2], w = q[3];
    direction[0] = 1.0 - 2.0 * (y * y + z * z);
    direction[1] = 2.0 * (x * y + w * z);
    direction[2] = 2.0 * (x * z - w * y);
    double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    for (int i = 0; i < 3; i++)
        direction[i] /= length;
}

void gw_track_at(const gw_track *track, uint32_t viewer, int64_t time, gw_track_sample *out) {
    *out = (gw_track_sample){0};
    int64_t moment = time < 0 ? 0 : time > track->duration ? track->duration : time;
    const int first = 2 * (int)viewer;
    int64_t oldest = 0;
    pose at;
    if (pose_at(track, first + GW_SENSOR_HEAD, moment, &at)) {
        out->has_head = 1;
        out->head_age = oldest = at.age;
        for (int i = 0; i < 3; i++)
            out->eye[i] = at.position[i];
        right_of(at.orientation, out->head_right);
    }
    if (pose_at(track, first + GW_SENSOR_GAZE, moment, &at)) {
        out->has_gaze = 1;
        out->gaze_age = at.age;
        oldest = at.age > oldest ? at.age : oldest;
        gaze_of(at.orientation, out->gaze_direction);
    }
    double fall = ((double)oldest * 1e-9 - FRESH) / (LOST - FRESH);
    if (out->has_head || out->has_gaze)
        out->confidence = fall <= 0.0 ? 1.0 : fall >= 1.0 ? 0.0 : 1.0 - fall;
}

gw_code gw_track_demo(double width, double height, gw_track **out, gw_error *error) {
    *out = NULL;
    if (!(width > 0.0 && height > 0.0 && isfinite(width) && isfinite(height)))
        return gw_fail(error, GW_BAD_INPUT, "demo track: a wall of %g x %g mm has no area", width, height);
    const gw_embedded_file *file = gw_embedded_find("configs/tracks/demo.vrpn");
    if (file == NULL)
        return gw_fail(error, GW_MACHINE,
                       "demo track: configs/tracks/demo.vrpn is not in this program; build it again");
    gw_code code = gw_track_parse(file->data, file->size, "demo", NULL, out, error);
    if (code != GW_OK)
        return code;
    double scale[3] = {width / RECORDED_WIDTH, height / RECORDED_HEIGHT, 0.0};
    scale[2] = sqrt(scale[0] * scale[1]);
    for (size_t i = 0; i < (*out)->report_count; i++) {
        gw_pose_report *report = &(*out)->reports[i];
        for (int axis = 0; axis < 3; axis++)
            report->position[axis] *= scale[axis];
        if (report->sensor != GW_SENSOR_GAZE)
            continue;
        /* Eye and wall point are scaled alike, so the line between them is: the point stays the corresponding
         * one. */
        double direction[3], length = 0.0;
        gaze_of(report->orientation, direction);
        for (int axis = 0; axis < 3; axis++) {
            direction[axis] *= scale[axis];
            length += direction[axis] * direction[axis];
        }
        for (int axis = 0; axis < 3; axis++)
            direction[axis] /= sqrt(length);
        gw_turn_onto(direction, report->orientation);
    }
    return GW_OK;
}
