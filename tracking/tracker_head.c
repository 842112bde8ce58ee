/* Where eyes are: tracked, predicted, held, led away and back. */
#include "tracking/quaternion.h"
#include "tracking/tracker_internal.h"

#include <math.h>
#include <string.h>

static const double FARTHEST = 1e9; /* mm; beyond it a value is no place in a room */
/* After its first sample a sensor's speed is not known yet; the prediction comes in over this time and so
 * many samples, so that it does not throw the eye ahead as soon as it is. */
static const int64_t COMING_IN = 250000000; /* ns */
static const double COMING_IN_SAMPLES = 15;

static gw_head_motion motion_of(const gw_head_channel *head) {
    const double known = fmin((double)(head->sensor.time - head->sensor.returned) / (double)COMING_IN,
                              head->sensor.since_return / COMING_IN_SAMPLES);
    gw_head_motion m = {.delay = head->place.delay, .known = fmin(known, 1), .time = head->sensor.time};
    memcpy(m.at, head->place.at, sizeof m.at);
    memcpy(m.velocity, head->place.velocity, sizeof m.velocity);
    memcpy(m.turn, head->turn.at, sizeof m.turn);
    memcpy(m.spin, head->turn.velocity, sizeof m.spin);
    return m;
}

/* From there to the neutral eye, looking ahead. */
static int lead_away(const gw_tracker *tracker, int64_t lost_at, int64_t now, gw_head_pose *pose) {
    static const double ahead[4] = {0, 0, 0, 1};
    gw_glide away = {.since = lost_at}, swing = {.since = lost_at};
    double left[3];
    gw_turn_between(ahead, pose->turn, swing.from);
    gw_glide_at(&swing, now, GW_SWING_SPEED, left);
    gw_turn_on(ahead, left, pose->turn);
    for (int i = 0; i < 3; i++)
        away.from[i] = pose->eye[i] - tracker->neutral_eye[i];
    const int glides = gw_glide_at(&away, now, tracker->tuning.glide_speed, left);
    for (int i = 0; i < 3; i++)
        pose->eye[i] = tracker->neutral_eye[i] + left[i];
    return glides;
}

/* What a change of state leaves between the old place and the new one shrinks at the glide speed, so the eye
 * moves faster than what it follows by that and no more. As the limit of the prediction is within the hold
 * time, a sensor that is silent for so long stands still before it is lost, whenever one asks. */
static int pose_at(const gw_tracker *tracker, const gw_head_channel *head, int64_t now, int64_t presentation,
                   gw_head_pose *out) {
    const gw_tracker_tuning *tuning = &tracker->tuning;
    const int64_t lost_at = gw_sensor_lost_at(&head->sensor, tuning->hold_time), lead = presentation - now;
    const int lost = now > lost_at;
    const int64_t until = lost ? lost_at : now;
    const gw_head_motion motion = motion_of(head);
    double left[3], turn_left[3];
    const int glides = gw_head_glide(tuning, head, until, lead, left, turn_left);
    gw_head_predict(tuning, &motion, until + lead, out);
    for (int i = 0; i < 3; i++)
        out->eye[i] += left[i];
    gw_turn_on(out->turn, turn_left, out->turn);
    return lost ? lead_away(tracker, lost_at, now, out) : glides;
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

static void forget(const gw_tracker *tracker, gw_head_channel *head) {
    gw_position_filter_begin(&head->place, &tracker->tuning.place);
    gw_turn_filter_begin(&head->turn, &tracker->tuning.turn);
}

/* A sensor that was never heard, or was lost: its filters know nothing, and the eye comes from where it is.
 */
static gw_head_change *begin_anew(const gw_tracker *tracker, gw_head_channel *head, int64_t arrival,
                                  const gw_head *sample) {
    gw_head_pose from = {.turn = {0, 0, 0, 1}};
    memcpy(from.eye, tracker->neutral_eye, sizeof from.eye);
    if (head->sensor.heard) {
        pose_at(tracker, head, arrival, arrival, &from);
    } else if (tracker->adopt_first) {
        memcpy(from.eye, sample->eye, sizeof from.eye);
        memcpy(from.turn, sample->orientation, sizeof from.turn);
    }
    head->change_count = 0;
    gw_head_change *change = gw_head_change_add(&tracker->tuning, head, arrival);
    change->stood = 1;
    change->from = from;
    forget(tracker, head);
    return change;
}

/* The change that a sample is, with all of it that is known before the sample counts; NULL: it is none, but
 * follows from those before. */
static gw_head_change *change_of(const gw_tracker *tracker, gw_head_channel *head, int64_t arrival,
                                 const gw_head *sample) {
    const gw_sensor_phase phase = gw_sensor_phase_at(&head->sensor, arrival, tracker->tuning.hold_time);
    if (phase == GW_SENSOR_ABSENT || phase == GW_SENSOR_LOST)
        return begin_anew(tracker, head, arrival, sample);
    if (phase != GW_SENSOR_HELD && !head->moved)
        return NULL;
    gw_head_change *change = gw_head_change_add(&tracker->tuning, head, arrival);
    change->before = motion_of(head);
    if (head->moved)
        forget(tracker, head);
    return change;
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
    gw_head_change *change = change_of(tracker, head, event->arrival, &at);
    const double dt = 1e-9 * (double)(time - head->sensor.time);
    gw_position_filter_take(&head->place, at.eye, dt);
    gw_turn_filter_take(&head->turn, at.orientation, dt);
    tracker->counters.losses += gw_sensor_take(&head->sensor, event->arrival, time, hold_time) ? 1 : 0;
    if (head->moved)
        gw_sensor_restart(&head->sensor);
    head->moved = 0;
    if (change)
        change->after = motion_of(head);
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
    const gw_head_motion motion = motion_of(head);
    gw_head_pose pose;
    out->has_head = 1;
    const int glides = pose_at(tracker, head, now, presentation, &pose);
    if (glides && out->head_state == GW_SENSOR_FRESH)
        out->head_state = GW_SENSOR_RETURNED;
    memcpy(out->eye, pose.eye, sizeof out->eye);
    memcpy(out->head, pose.turn, sizeof out->head);
    out->quality = head->quality;
    out->head_age = gw_not_below_0(presentation - head->sensor.time);
    out->head_arrival = head->on_its_way;
    out->head_wait = gw_not_below_0(now - head->sensor.arrival);
    out->head_delay = (int64_t)(head->place.delay * 1e9);
    out->predicted = (int64_t)(gw_head_horizon(&tracker->tuning, &motion, presentation) * 1e9);
}
