/* What the files of the tracker share: tracker.c sorts events, tracker_order.c says which samples are new and
 * when they were taken, tracker_head.c leads the eyes, tracker_glide.c from one place to another without a
 * jump, tracker_gaze.c follows the gazes. */
#ifndef GW_TRACKING_TRACKER_INTERNAL_H
#define GW_TRACKING_TRACKER_INTERNAL_H

#include "tracking/clock_offset.h"
#include "tracking/filter_gaze.h"
#include "tracking/filter_position.h"
#include "tracking/filter_turn.h"
#include "tracking/gaze_model.h"
#include "tracking/tracker.h"

enum { GW_SAMPLE_NUMBERS = 7 };
#define GW_LATEST INT64_C(4000000000000000000) /* ns: times beyond it (126 years) are none */

/* Settings in the units of the tracker. */
typedef struct gw_tracker_tuning {
    gw_position_tuning place;
    gw_turn_tuning turn;
    gw_gaze_tuning gaze;
    int predicts, predicts_gaze;
    double prediction_limit; /* s, not beyond the hold time */
    int64_t hold_time, gaze_fade;
    double glide_speed; /* mm/s */
} gw_tracker_tuning;

/* The clock of one source. */
typedef struct gw_source_clock {
    gw_clock_offset offset;
    uint32_t
        epoch; /* rises when the clock is set anew: stamps of before mean nothing beside those of after */
} gw_source_clock;

/* What was told last by one sensor, to know the next sample as new. */
typedef struct gw_sample_order {
    int known;
    uint32_t epoch;
    int64_t stamp, arrival;
    double numbers[GW_SAMPLE_NUMBERS];
    int behind_known; /* the last stamp, if it lay behind `stamp` */
    int64_t behind;
} gw_sample_order;

/* How a head moves on, as its filters knew it at one moment. */
typedef struct gw_head_motion {
    double at[3], velocity[3]; /* mm, mm/s */
    double turn[4], spin[3];   /* rad/s about its own axes */
    double delay;              /* s, of the filter */
    double known;              /* 0 to 1: how far it is predicted already */
    int64_t time;              /* ns, of the newest sample */
} gw_head_motion;

typedef struct gw_head_pose {
    double eye[3], turn[4];
} gw_head_pose;

/* A sample that did not follow from the one before: the first, one after a silence, one of a room that was
 * changed. Where the eye was just before and where it is just after depends on how far ahead frames are seen,
 * which only who asks knows; so both motions are kept. */
typedef struct gw_head_change {
    int64_t since; /* ns, its arrival */
    int stood;     /* 1: the eye was at `from` however far ahead one looks */
    gw_head_pose from;
    gw_head_motion before, after;
    double rest[3], turn_rest[3]; /* what was left then of changes that are no longer kept */
} gw_head_change;

/* rad/s: swings the eyes about the middle between them by 0.1 m/s at most. */
#define GW_SWING_SPEED 3.0
/* More within one glide are a rare thing: the oldest are then merged. */
enum { GW_HEAD_CHANGES = 3 };

typedef struct gw_head_channel {
    gw_sample_order order;
    gw_sensor_state sensor;
    gw_position_filter place;
    gw_turn_filter turn;
    gw_head_change changes[GW_HEAD_CHANGES]; /* the newest last */
    uint32_t change_count;
    int moved;          /* the room or the sensor's place on the head was changed since the newest sample */
    int64_t on_its_way; /* ns, of the newest sample */
    double quality;
} gw_head_channel;

typedef struct gw_gaze_channel {
    gw_sample_order order;
    gw_sensor_state sensor;
    gw_gaze_filter filter;
    double eyes[GW_GAZE_RING][3]; /* mm: where the eye was, for each direction in the filter's ring */
    int has_origin;
    double origin[3]; /* mm */
    int64_t on_its_way;
    double quality;
} gw_gaze_channel;

struct gw_tracker {
    gw_tracker_setup setup;
    gw_tracker_tuning tuning;
    double neutral_eye[3];
    int adopt_first;
    gw_source_clock clocks[GW_TRACKER_SOURCES];
    gw_head_channel heads[GW_TRACK_VIEWERS];
    gw_gaze_channel gazes[GW_TRACK_VIEWERS];
    gw_wand wand;
    gw_room_sanity sanity[GW_TRACKER_SOURCES]; /* of heads */
    gw_tracker_counters counters;
};

/* tracker_order.c: 1 when the sample is new; *time is when it was taken, on our clock, and after *last. */
int gw_sample_is_new(gw_tracker *tracker, gw_source_clock *clock, gw_sample_order *order,
                     const gw_tracking_event *event, const double numbers[GW_SAMPLE_NUMBERS],
                     const gw_sensor_state *sensor, int64_t *time);

/* tracker_glide.c: predicts a motion; presentation is when the frame is seen, ns. */
double gw_head_horizon(const gw_tracker_tuning *tuning, const gw_head_motion *motion, int64_t presentation);
void gw_head_predict(const gw_tracker_tuning *tuning, const gw_head_motion *motion, int64_t presentation,
                     gw_head_pose *out);
/* Makes room for one more change and returns it, all 0 but `since`. */
gw_head_change *gw_head_change_add(const gw_tracker_tuning *tuning, gw_head_channel *head, int64_t since);
/* What is left of all changes at `now`, for frames that are seen `lead` ns later: mm, and a rotation vector
 * in the head's axes. 0: nothing of the place. */
int gw_head_glide(const gw_tracker_tuning *tuning, const gw_head_channel *head, int64_t now, int64_t lead,
                  double eye[3], double turn[3]);

/* tracker_head.c */
void gw_head_take(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event);
void gw_head_at(const gw_tracker *tracker, uint32_t viewer, int64_t now, int64_t presentation,
                gw_viewer_view *out);

/* tracker_gaze.c: events of both kinds; gw_gaze_at() after gw_head_at(). */
void gw_gaze_take(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event);
void gw_gaze_at(const gw_tracker *tracker, uint32_t viewer, int64_t now, int64_t presentation,
                gw_viewer_view *out);

static inline int64_t gw_not_below_0(int64_t time) {
    return time > 0 ? time : 0;
}

#endif
