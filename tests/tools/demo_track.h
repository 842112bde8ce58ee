/* The demo track by formula: what configs/tracks/demo.vrpn records. Included by the tool that writes the file
 * (make_demo_track.c) and by the test that proves the file to be its output, bit for bit.
 *
 * A viewer in front of a wall of 2000 x 1125 mm centred on (0,0,0): the head sways, the gaze rests on points
 * of the wall, jumps between them (saccades of 40 to 60 ms) and follows one moving point, crossing the
 * borders of a 2x2 wall in both directions. 60 Hz, 8 s, the last report like the first, so that it can be
 * repeated without a jump. */
#ifndef GW_TESTS_TOOLS_DEMO_TRACK_H
#define GW_TESTS_TOOLS_DEMO_TRACK_H

#include "base/portable_math.h"
#include "tracking/recording_writer.h"
#include "tracking/track.h"

#include <math.h>
#include <string.h>

enum { DEMO_RATE = 60, DEMO_SECONDS = 8, DEMO_REPORTS = 2 * (DEMO_RATE * DEMO_SECONDS + 1) };

/* From `from` until the next row's `from` the gaze rests on (or, if the next has travel 1, glides towards) a
 * point. */
typedef struct demo_fixation {
    double from;   /* s */
    double travel; /* s to get here from the point before: a saccade, or more for following something that
                      moves */
    double x, y;   /* mm on the wall */
} demo_fixation;

/* Window, knot's foot, tree, pot, trees further back, carpet, ivy, knot; along the cornice; column, knot,
 * window. */
static const demo_fixation demo_fixations[] = {
    {0.00, 0.00, 20.0, 90.0},     {0.60, 0.05, -370.0, -100.0}, {1.10, 0.06, 450.0, 110.0},
    {1.80, 0.05, 440.0, -330.0},  {2.35, 0.05, 200.0, 10.0},    {2.95, 0.05, -30.0, -380.0},
    {3.50, 0.05, -650.0, -120.0}, {4.05, 0.05, -390.0, 170.0},  {4.60, 1.10, 520.0, 250.0},
    {6.05, 0.06, 640.0, -90.0},   {6.60, 0.06, -250.0, 60.0},   {7.40, 0.05, 20.0, 90.0},
};

/* 0..1 with no velocity and acceleration at either end, as eyes and heads move. */
static inline double demo_ease(double t) {
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

static inline void demo_gaze_point(double time, double point[2]) {
    size_t last = sizeof demo_fixations / sizeof demo_fixations[0] - 1, i = 0;
    while (i < last && demo_fixations[i + 1].from <= time)
        i++;
    const demo_fixation *to = &demo_fixations[i], *before = i > 0 ? to - 1 : to;
    double t = to->travel > 0.0 ? demo_ease((time - to->from) / to->travel) : 1.0;
    /* A resting eye drifts by about a tenth of a degree: 3 mm here. */
    double turn = 2.0 * GW_PI * time;
    point[0] = before->x + (to->x - before->x) * t + 2.0 * gw_sin(turn * 1.75) + gw_sin(turn * 3.5);
    point[1] = before->y + (to->y - before->y) * t + 2.0 * gw_sin(turn * 2.25) + gw_sin(turn * 4.0);
}

static inline void demo_eye(double time, double eye[3]) {
    double turn = 2.0 * GW_PI * time / DEMO_SECONDS;
    eye[0] = 280.0 * gw_sin(turn) + 30.0 * gw_sin(3.0 * turn);
    eye[1] = 60.0 + 25.0 * gw_sin(2.0 * turn + 0.6) + 6.0 * gw_sin(7.0 * turn);
    eye[2] = 1760.0 + 180.0 * gw_sin(turn + 1.9) + 20.0 * gw_sin(4.0 * turn);
}

/* Shortest turn from (0,0,-1) to a direction of any length. */
static inline void demo_turn(const double direction[3], double q[4]) {
    double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    q[0] = direction[1];
    q[1] = -direction[0];
    q[2] = 0.0;
    q[3] = length - direction[2];
    length = sqrt(q[0] * q[0] + q[1] * q[1] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
}

/* The pose of sensor 0 or 1 at a time, in metres as VRPN has it. */
static inline void demo_pose(double time, int sensor, gw_tracking_event *out) {
    double eye[3], point[2];
    demo_eye(time, eye);
    demo_gaze_point(time, point);
    double to_wall[3] = {point[0] - eye[0], point[1] - eye[1], -eye[2]};
    /* The head turns half as far as the eyes do. */
    double facing[3] = {0.5 * to_wall[0], 0.5 * to_wall[1], to_wall[2]};
    *out = (gw_tracking_event){.kind = GW_EVENT_POSE, .sensor = sensor, .quality = 1.0};
    for (int i = 0; i < 3; i++)
        out->of.pose.position[i] = eye[i] / 1000.0;
    demo_turn(sensor == GW_SENSOR_GAZE ? to_wall : facing, out->of.pose.orientation);
}

/* Writes the file; its clock starts at Unix second 1000000000. */
static inline gw_code demo_write(const char *path, gw_error *error) {
    const int64_t start = (int64_t)1000000000 * 1000000000;
    gw_recording_writer *writer = NULL;
    uint32_t sender = 0;
    gw_code code = gw_recording_writer_open(path, GW_RECORDING_BY_NAME, start, 1, &writer, error);
    if (code == GW_OK)
        code = gw_recording_writer_sender(writer, "Demo0", &sender, error);
    for (int i = 0; i < DEMO_REPORTS && code == GW_OK; i++) {
        const int64_t time = (int64_t)(i / 2) * 1000000000 / DEMO_RATE;
        gw_tracking_event event;
        demo_pose((double)(i / 2) / DEMO_RATE, i % 2, &event);
        event.arrival = (time + 500) / 1000 * 1000; /* whole microseconds, as VRPN's logs have them */
        event.device_time = start + event.arrival;
        code = gw_recording_writer_event(writer, sender, &event, error);
    }
    gw_code closed = gw_recording_writer_close(&writer, code == GW_OK ? error : NULL);
    return code != GW_OK ? code : closed;
}

#endif
