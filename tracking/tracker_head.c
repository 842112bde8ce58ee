/* Where eyes are: tracked, predicted, held, led away and back. */
#include "tracking/quaternion.h"
#include "tracking/tracker_internal.h"

#include <math.h>
#include <string.h>

static const double FARTHEST = 1e9; /* mm; beyond it a value is no place in a room */
static const double FASTEST = 3000; /* mm/s, of a head that is predicted */
/* rad/s: swings the eyes about the middle between them by 0.1 m/s at most. */
static const double SWING_SPEED = 3;
/* After its first sample a sensor's speed is not known yet; the prediction comes in over this time and so
 * many samples, so that it does not throw the eye ahead as soon as it is. */
static const int64_t COMING_IN = 250000000; /* ns */
static const double COMING_IN_SAMPLES = 15;

/* Seconds by which the newest sample is predicted. */
static double horizon(const gw_tracker *tracker, const gw_head_channel *head, int64_t presentation) {
    if (!tracker->tuning.predicts)
        return 0;
    const double ahead = 1e-9 * (double)(presentation - head->sensor.time) + head->place.delay;
    const double known = fmin((double)(head->sensor.time - head->sensor.returned) / (double)COMING_IN,
                              head->sensor.since_return / COMING_IN_SAMPLES);
    return fmin(fmax(ahead, 0), tracker->tuning.prediction_limit) * fmin(known, 1);
}

/* The tracked place, without glide. As the limit of the prediction is within the hold time, a sensor that is
 * silent for so long stands still before it is lost, whenever one asks. */
static void tracked_eye(const gw_tracker *tracker, const gw_head_channel *head, int64_t presentation,
                        double out[3]) {
    const double *v = head->place.velocity;
    const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double ahead = horizon(tracker, head, presentation) * (speed > FASTEST ? FASTEST / speed : 1);
    for (int i = 0; i < 3; i++)
        out[i] = head->place.at[i] + ahead * v[i];
}

/* What a change of state leaves between the old place and the new one shrinks at the glide speed, so the eye
 * moves faster than what it follows by that and no more. */
static int eye_at(const gw_tracker *tracker, const gw_head_channel *head, int64_t now, int64_t presentation,
                  double out[3]) {
    const gw_tracker_tuning *tuning = &tracker->tuning;
    const int64_t lost_at = gw_sensor_lost_at(&head->sensor, tuning->hold_time);
    const int lost = now > lost_at;
    double left[3];
    int glides = gw_glide_at(&head->glide, lost ? lost_at : now, tuning->glide_speed, left);
    tracked_eye(tracker, head, lost ? presentation - now + lost_at : presentation, out);
    for (int i = 0; i < 3; i++)
        out[i] += left[i];
    if (!lost)
        return glides;
    gw_glide away = {.since = lost_at};
    for (int i = 0; i < 3; i++)
        away.from[i] = out[i] - tracker->neutral_eye[i];
    glides = gw_glide_at(&away, now, tuning->glide_speed, left);
    for (int i = 0; i < 3; i++)
        out[i] = tracker->neutral_eye[i] + left[i];
    return glides;
}

/* The same with the head's turn, because two eyes hang on it. */
static void turn_at(const gw_tracker *tracker, const gw_head_channel *head, int64_t now, int64_t presentation,
                    double out[4]) {
    static const double ahead[4] = {0, 0, 0, 1};
    const int64_t lost_at = gw_sensor_lost_at(&head->sensor, tracker->tuning.hold_time);
    const int lost = now > lost_at;
    double left[3];
    gw_glide_at(&head->swing, lost ? lost_at : now, SWING_SPEED, left);
    gw_turn_filter_predict(&head->turn,
                           horizon(tracker, head, lost ? presentation - now + lost_at : presentation), out);
    gw_turn_on(out, left, out);
    if (!lost)
        return;
    gw_glide away = {.since = lost_at};
    gw_turn_between(ahead, out, away.from);
    gw_glide_at(&away, now, SWING_SPEED, left);
    gw_turn_on(ahead, left, out);
}

/* The eye and the head's turn in wall space; 0: no pose. */
static int read_pose(const gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event,
                     gw_head *out) {
    double turn[4];
    memcpy(turn, event->of.pose.orientation, sizeof turn);
    if (!gw_turn_normalise(turn))
        return 0;
    gw_head_of_pose(&tracker->setup, viewer, event->of.pose.position, turn, out);
    const double *eye = out->eye;
    return fabs(eye[0]) <= FARTHEST && fabs(eye[1]) <= FARTHEST && fabs(eye[2]) <= FARTHEST;
}

/* A sensor that was never heard, or was lost: its filters know nothing, and the eye comes from where it is.
 */
static void begin_anew(const gw_tracker *tracker, gw_head_channel *head, int64_t arrival, const double eye[3],
                       const double turn[4]) {
    double from[3], turn_from[4] = {0, 0, 0, 1};
    memcpy(from, tracker->neutral_eye, sizeof from);
    if (head->sensor.heard) {
        eye_at(tracker, head, arrival, arrival, from);
        turn_at(tracker, head, arrival, arrival, turn_from);
    } else if (tracker->adopt_first) {
        memcpy(from, eye, sizeof from);
        memcpy(turn_from, turn, sizeof turn_from);
    }
    head->glide.since = head->swing.since = arrival;
    for (int i = 0; i < 3; i++)
        head->glide.from[i] = from[i] - eye[i];
    gw_turn_between(turn, turn_from, head->swing.from);
    gw_position_filter_begin(&head->place, &tracker->tuning.place);
    gw_turn_filter_begin(&head->turn, &tracker->tuning.turn);
}

void gw_head_take(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event) {
    const int64_t hold_time = tracker->tuning.hold_time;
    gw_source_clock *clock = &tracker->clocks[tracker->setup.viewers[viewer].source];
    gw_head_channel *head = &tracker->heads[viewer];
    double numbers[GW_SAMPLE_NUMBERS];
    gw_head at;
    int64_t time;
    if (event->quality < 0) {
        tracker->counters.untracked++;
        return;
    }
    if (!read_pose(tracker, viewer, event, &at)) {
        tracker->counters.not_finite++;
        return;
    }
    memcpy(numbers, event->of.pose.position, 3 * sizeof *numbers);
    memcpy(numbers + 3, event->of.pose.orientation, 4 * sizeof *numbers);
    if (!gw_sample_is_new(tracker, clock, &head->order, event, numbers, &head->sensor, &time))
        return;
    if (!head->sensor.heard || event->arrival > gw_sensor_lost_at(&head->sensor, hold_time))
        begin_anew(tracker, head, event->arrival, at.eye, at.orientation);
    const double dt = 1e-9 * (double)(time - head->sensor.time);
    gw_position_filter_take(&head->place, at.eye, dt);
    gw_turn_filter_take(&head->turn, at.orientation, dt);
    tracker->counters.losses += gw_sensor_take(&head->sensor, event->arrival, time, hold_time) ? 1 : 0;
    tracker->counters.samples++;
    head->on_its_way = event->arrival - time;
    head->quality = fmin(event->quality, 1);
}

void gw_head_at(const gw_tracker *tracker, uint32_t viewer, int64_t now, int64_t presentation,
                gw_viewer_view *out) {
    const gw_head_channel *head = &tracker->heads[viewer];
    memcpy(out->eye, tracker->neutral_eye, sizeof out->eye);
    out->head[3] = 1;
    out->head_state = gw_sensor_phase_at(&head->sensor, now, tracker->tuning.hold_time);
    if (!head->sensor.heard)
        return;
    const double ahead = horizon(tracker, head, presentation);
    out->has_head = 1;
    const int glides = eye_at(tracker, head, now, presentation, out->eye);
    if (glides && out->head_state == GW_SENSOR_FRESH)
        out->head_state = GW_SENSOR_RETURNED;
    turn_at(tracker, head, now, presentation, out->head);
    out->quality = head->quality;
    out->head_age = gw_not_below_0(presentation - head->sensor.time);
    out->head_arrival = head->on_its_way;
    out->head_wait = gw_not_below_0(now - head->sensor.arrival);
    out->head_delay = (int64_t)(head->place.delay * 1e9);
    out->predicted = (int64_t)(ahead * 1e9);
}
