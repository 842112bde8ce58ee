/* A person who walks and looks about, as samples that a tracker takes, with holes and without. */
#ifndef GW_TESTS_SUPPORT_TRACK_SCENE_H
#define GW_TESTS_SUPPORT_TRACK_SCENE_H

#include "tests/support/check.h"
#include "tracking/filter_turn.h"
#include "tracking/tracker.h"

#include <math.h>

static const int64_t ms = 1000000, second = 1000000000;
static const int64_t unix_time = INT64_C(1700000000000000000);
static const double neutral[3] = {0, 0, 1800};

/* A head that walks and sways, up to about 0.5 m/s; m. */
static inline void place_at(double t, double out[3]) {
    out[0] = 0.6 * sin(0.7 * t) + 0.05 * sin(3.1 * t);
    out[1] = 0.1 + 0.04 * sin(1.3 * t);
    out[2] = 2.0 + 0.2 * sin(0.5 * t + 1);
}

static inline void turn_at(double t, double out[4]) {
    const double v[3] = {0.2 * sin(0.9 * t), 1.5 * sin(0.6 * t), 0.1 * sin(1.1 * t)};
    gw_turn_from_vector(v, out);
}

static inline gw_tracking_event head_event(double t, int64_t on_its_way) {
    gw_tracking_event e = {.kind = GW_EVENT_POSE, .quality = 1};
    const int64_t sent = llrint(t * 1e9);
    e.arrival = sent + on_its_way;
    e.device_time = unix_time + sent;
    place_at(t, e.of.pose.position);
    turn_at(t, e.of.pose.orientation);
    return e;
}

static inline gw_tracking_event gaze_event(double t, int64_t on_its_way) {
    gw_tracking_event e = head_event(t, on_its_way);
    const double v[3] = {0.1 * sin(0.4 * t), 0.2 * sin(0.3 * t), 0};
    e.sensor = 1;
    gw_turn_from_vector(v, e.of.pose.orientation);
    return e;
}

enum { MOST = 40000 };
typedef struct scene {
    gw_tracking_event events[MOST];
    size_t count;
    size_t taken;
    gw_tracker *tracker;
} scene;

static inline void add(scene *s, gw_tracking_event event) {
    assert_true(s->count < MOST);
    s->events[s->count++] = event;
}

/* Head and gaze from 0 to `end` s, without those from hole_from to hole_to. */
static inline void fill(scene *s, double rate, double end, double hole_from, double hole_to) {
    s->count = 0;
    for (int i = 0; i < end * rate; i++) {
        const double t = i / rate;
        if (t > hole_from && t < hole_to)
            continue;
        add(s, head_event(t, 3 * ms));
        add(s, gaze_event(t, 3 * ms));
    }
}

static inline void open_tracker(scene *s, const char *const *settings, int adopt_first) {
    gw_settings all;
    gw_settings_init(&all);
    for (; settings && *settings; settings++)
        check_ok(gw_settings_assign(&all, *settings, &error));
    gw_tracker_setup setup;
    gw_tracker_setup_default("Test@localhost", &setup);
    const gw_tracker_options options = {&all, {neutral[0], neutral[1], neutral[2]}, adopt_first};
    s->taken = 0;
    check_ok(gw_tracker_create(&setup, &options, &s->tracker, &error));
}

/* The first viewer, for a frame that is made at `now`, with all that has arrived by then. */
static inline gw_viewer_view ask(scene *s, int64_t now, int64_t lead) {
    gw_tracker_view view;
    while (s->taken < s->count && s->events[s->taken].arrival <= now)
        gw_tracker_take(s->tracker, 0, &s->events[s->taken++]);
    gw_tracker_at(s->tracker, now, now + lead, &view);
    return view.viewers[0];
}

static inline double apart(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static inline double angle_between(const double a[4], const double b[4]) {
    double way[3];
    gw_turn_between(a, b, way);
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
}

static const char *const every_filter[][2] = {
    {NULL, NULL}, {"head_filter=one-euro", NULL}, {"head_filter=kalman", NULL}};

/* mm, the newest head sample that has been taken; one must have been. */
static inline void newest_sample(const scene *s, double out[3]) {
    out[0] = out[1] = out[2] = NAN;
    for (size_t i = s->taken; i-- > 0;)
        if (s->events[i].sensor == 0) {
            for (int k = 0; k < 3; k++)
                out[k] = 1000 * s->events[i].of.pose.position[k];
            return;
        }
}

#endif
