/* Where viewers look: gaze sensors, gaze events, or the head alone. */
#include "tracking/quaternion.h"
#include "tracking/tracker_internal.h"

#include <math.h>
#include <string.h>

static const double FARTHEST = 1e9;      /* mm */
static const int64_t RECENT = 300000000; /* ns: a usual fixation */

/* Of a gaze event, in wall space. Eyes turn back as the head turns on, so it is in the room that a gaze
 * rests, and there that it is filtered. 0: it cannot be told, and why is counted. */
static int read_event(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event,
                      double direction[3]) {
    gw_gaze_channel *gaze = &tracker->gazes[viewer];
    const gw_room *room = &tracker->setup.sources[tracker->setup.viewers[viewer].gaze_source].room;
    const gw_head_channel *channel = &tracker->heads[viewer];
    gw_head head;
    gw_gaze_line line = {0};
    memcpy(head.sensor, channel->place.last, sizeof head.sensor);
    memcpy(head.eye, channel->place.last, sizeof head.eye);
    memcpy(head.orientation, channel->turn.last, sizeof head.orientation);
    if (event->of.gaze.frame == GW_GAZE_IN_HEAD && !channel->sensor.heard) {
        tracker->counters.headless++;
        return 0;
    }
    gw_gaze_of_event(event, room, channel->sensor.heard ? &head : NULL, &line);
    memcpy(direction, line.direction, sizeof line.direction);
    gaze->has_origin = line.has_origin && fabs(line.origin[0]) <= FARTHEST &&
                       fabs(line.origin[1]) <= FARTHEST && fabs(line.origin[2]) <= FARTHEST;
    memcpy(gaze->origin, line.origin, sizeof gaze->origin);
    return 1;
}

/* Of a sensor whose orientation turns (0, 0, -1) onto the gaze. */
static int read_pose(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event,
                     double direction[3]) {
    const gw_room *room = &tracker->setup.sources[tracker->setup.viewers[viewer].gaze_source].room;
    double turn[4], place[3];
    memcpy(turn, event->of.pose.orientation, sizeof turn);
    if (!gw_turn_normalise(turn)) {
        tracker->counters.not_finite++;
        return 0;
    }
    gw_room_pose(room, event->of.pose.position, turn, place, turn);
    gw_gaze_along(turn, direction);
    return 1;
}

static void numbers_of(const gw_tracking_event *event, double numbers[GW_SAMPLE_NUMBERS]) {
    memset(numbers, 0, GW_SAMPLE_NUMBERS * sizeof *numbers);
    if (event->kind == GW_EVENT_GAZE) {
        memcpy(numbers, event->of.gaze.direction, 3 * sizeof *numbers);
        memcpy(numbers + 3, event->of.gaze.origin, 3 * sizeof *numbers);
    } else {
        memcpy(numbers, event->of.pose.orientation, 4 * sizeof *numbers);
        memcpy(numbers + 4, event->of.pose.position, 3 * sizeof *numbers);
    }
}

static int is_usable(const double direction[3]) {
    const double square =
        direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2];
    return square > 1e-18 && square < 1e300;
}

/* Of the newest direction. */
static void keep_eye(gw_tracker *tracker, uint32_t viewer) {
    gw_gaze_channel *gaze = &tracker->gazes[viewer];
    const gw_head_channel *head = &tracker->heads[viewer];
    const double *eye = head->sensor.heard ? head->place.last
                        : gaze->has_origin ? gaze->origin
                                           : tracker->neutral_eye;
    memcpy(gaze->eyes[(gaze->filter.count - 1) % GW_GAZE_RING], eye, sizeof gaze->eyes[0]);
}

void gw_gaze_take(gw_tracker *tracker, uint32_t viewer, const gw_tracking_event *event) {
    gw_gaze_channel *gaze = &tracker->gazes[viewer];
    const int is_event = event->kind == GW_EVENT_GAZE;
    double direction[3], numbers[GW_SAMPLE_NUMBERS];
    int64_t time;
    if (is_event ? !gw_gaze_is_open(event) : event->quality < 0) {
        tracker->counters.untracked++;
        return;
    }
    if (!(is_event ? read_event : read_pose)(tracker, viewer, event, direction))
        return;
    if (!is_usable(direction)) {
        tracker->counters.not_finite++;
        return;
    }
    numbers_of(event, numbers);
    gw_source_clock *clock = &tracker->clocks[tracker->setup.viewers[viewer].gaze_source];
    if (!gw_sample_is_new(tracker, clock, &gaze->order, event, numbers, &gaze->sensor, &time))
        return;
    const uint32_t saccades = gaze->filter.saccades;
    if (gw_gaze_filter_take(&gaze->filter, direction, time))
        keep_eye(tracker, viewer);
    tracker->counters.samples++;
    tracker->counters.saccades += gaze->filter.saccades - saccades;
    tracker->counters.losses +=
        gw_sensor_take(&gaze->sensor, event->arrival, time, tracker->tuning.hold_time) ? 1 : 0;
    gaze->on_its_way = event->arrival - time;
    gaze->quality = fmin(event->quality, 1);
}

/* Where the head points: for viewers without anything that follows their eyes. */
static void look_ahead(const gw_tracker *tracker, uint32_t viewer, gw_viewer_view *out) {
    const gw_head_channel *head = &tracker->heads[viewer];
    out->gaze_state = out->head_state;
    out->has_gaze = out->has_head;
    gw_gaze_along(out->head, out->gaze_direction);
    out->gaze_age = out->head_age;
    out->gaze_arrival = out->head_arrival;
    out->gaze_wait = out->head_wait;
    out->gaze_delay = (int64_t)(head->turn.delay * 1e9);
}

static void look_as_told(const gw_tracker *tracker, const gw_gaze_channel *gaze, int64_t now,
                         int64_t presentation, gw_viewer_view *out) {
    out->gaze_state = gw_sensor_phase_at(&gaze->sensor, now, tracker->tuning.hold_time);
    if (!gaze->sensor.heard)
        return;
    out->has_gaze = 1;
    out->gaze_age = gw_not_below_0(presentation - gaze->sensor.time);
    const double ahead =
        fmin(1e-9 * (double)out->gaze_age + gaze->filter.delay, tracker->tuning.prediction_limit);
    gw_gaze_filter_predict(&gaze->filter, tracker->tuning.predicts_gaze ? ahead : 0, out->gaze_direction);
    if (gaze->has_origin && !out->has_head)
        memcpy(out->gaze_origin, gaze->origin, sizeof out->gaze_origin);
    out->gaze_arrival = gaze->on_its_way;
    out->gaze_wait = gw_not_below_0(now - gaze->sensor.arrival);
    out->gaze_delay = (int64_t)(gaze->filter.delay * 1e9);
    out->in_saccade = gaze->filter.in_saccade;
    out->gaze_widening = gw_gaze_filter_widening(&gaze->filter, 1e-9 * (double)out->gaze_age);
}

void gw_gaze_at(const gw_tracker *tracker, uint32_t viewer, int64_t now, int64_t presentation,
                gw_viewer_view *out) {
    const gw_tracker_tuning *tuning = &tracker->tuning;
    const gw_tracker_viewer *who = &tracker->setup.viewers[viewer];
    const gw_gaze_channel *gaze = &tracker->gazes[viewer];
    const gw_head_channel *head = &tracker->heads[viewer];
    memcpy(out->gaze_origin, out->eye, sizeof out->gaze_origin);
    if (viewer >= tracker->setup.viewer_count || who->gaze == GW_GAZE_KIND_NONE)
        return;
    out->gaze_error = gw_tracker_gaze_error(who);
    const double seen =
        out->has_head ? gw_sensor_confidence(&head->sensor, now, tuning->hold_time, tuning->gaze_fade) : 1;
    if (who->gaze == GW_GAZE_KIND_HEAD) {
        look_ahead(tracker, viewer, out);
        out->confidence = out->has_gaze ? seen * out->quality : 0;
        return;
    }
    look_as_told(tracker, gaze, now, presentation, out);
    const double told = gw_sensor_confidence(&gaze->sensor, now, tuning->hold_time, tuning->gaze_fade);
    out->confidence = fmin(seen, told) * gaze->quality;
}

uint32_t gw_tracker_recent_gazes(const gw_tracker *tracker, uint32_t viewer, int64_t now,
                                 gw_gaze_ray out[GW_RECENT_GAZES]) {
    _Static_assert((int)GW_RECENT_GAZES == (int)GW_FIXATION_SPOTS, "as many as a fixation takes");
    const gw_gaze_channel *gaze = &tracker->gazes[viewer];
    uint32_t places[GW_RECENT_GAZES];
    if (viewer >= tracker->setup.viewer_count)
        return 0;
    if (tracker->setup.viewers[viewer].gaze == GW_GAZE_KIND_HEAD) {
        gw_viewer_view view = {0};
        gw_head_at(tracker, viewer, now, now, &view);
        memcpy(out[0].from, view.eye, sizeof out[0].from);
        gw_gaze_along(view.head, out[0].direction);
        return (uint32_t)view.has_head;
    }
    const uint32_t count = gw_gaze_filter_recent(&gaze->filter, RECENT, GW_RECENT_GAZES, places);
    for (uint32_t i = 0; i < count; i++) {
        memcpy(out[i].from, gaze->eyes[places[i]], sizeof out[i].from);
        memcpy(out[i].direction, gaze->filter.ring[places[i]].direction, sizeof out[i].direction);
    }
    return count;
}
