#include "tracking/tracker_internal.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double radians_per_degree = 0.017453292519943295;
static const int64_t SLOWEST_GAZE = 33333333; /* ns: no eye tracker has fewer than 30 samples a second */

static gw_tracker_tuning tuning_of(const gw_settings *s) {
    const double limit = s->prediction_limit < s->hold_time ? s->prediction_limit : s->hold_time;
    _Static_assert((int)GW_HEAD_ONE_EURO == (int)GW_FILTER_KIND_ONE_EURO &&
                       (int)GW_HEAD_KALMAN == (int)GW_FILTER_KIND_KALMAN,
                   "the setting's choices are the filters");
    return (gw_tracker_tuning){.place = {.kind = (gw_filter_kind)s->head_filter,
                                         .one_euro = {s->head_cutoff, s->head_cutoff_growth * 1e-3},
                                         .noise = s->head_noise,
                                         .acceleration = s->head_acceleration * 1e3},
                               .turn = {s->head_filter != GW_HEAD_NONE,
                                        {s->turn_cutoff, s->turn_cutoff_growth / radians_per_degree}},
                               .gaze = {s->gaze_filter,
                                        {s->gaze_cutoff, s->gaze_cutoff_growth},
                                        s->saccade_speed,
                                        s->saccade_growth_limit},
                               .predicts = s->prediction,
                               .predicts_gaze = s->gaze_prediction,
                               .prediction_limit = limit,
                               .hold_time = (int64_t)(s->hold_time * 1e9),
                               .gaze_fade = (int64_t)(s->gaze_fade * 1e9),
                               .glide_speed = s->glide_speed * 1e3};
}

void gw_tracker_reset(gw_tracker *tracker) {
    memset(tracker->clocks, 0, sizeof tracker->clocks);
    memset(&tracker->wand, 0, sizeof tracker->wand);
    memset(tracker->heads, 0, sizeof tracker->heads);
    memset(tracker->gazes, 0, sizeof tracker->gazes);
    for (int i = 0; i < GW_TRACK_VIEWERS; i++) {
        gw_gaze_filter_begin(&tracker->gazes[i].filter, &tracker->tuning.gaze);
        tracker->gazes[i].sensor.period = SLOWEST_GAZE; /* until it is known */
    }
}

gw_code gw_tracker_create(const gw_tracker_setup *setup, const gw_tracker_options *options, gw_tracker **out,
                          gw_error *error) {
    void *memory = NULL;
    *out = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_tracker), "tracker", error);
    if (code)
        return code;
    gw_tracker *tracker = memory;
    tracker->setup = *setup;
    tracker->tuning = tuning_of(options->settings);
    tracker->adopt_first = options->adopt_first;
    gw_tracker_set_neutral(tracker, options->neutral_eye);
    gw_tracker_reset(tracker);
    *out = tracker;
    return GW_OK;
}

void gw_tracker_destroy(gw_tracker **tracker) {
    free(*tracker);
    *tracker = NULL;
}

void gw_tracker_set_neutral(gw_tracker *tracker, const double eye[3]) {
    memcpy(tracker->neutral_eye, eye, sizeof tracker->neutral_eye);
}

static int is_gaze_of(const gw_tracker_viewer *viewer, int source, const gw_tracking_event *event) {
    if (viewer->gaze_source != source)
        return 0;
    const int any = viewer->gaze == GW_GAZE_KIND_ANY;
    if (event->kind == GW_EVENT_GAZE)
        return (any || viewer->gaze == GW_GAZE_KIND_EVENTS) && viewer->gaze_viewer == event->sensor;
    return (any || viewer->gaze == GW_GAZE_KIND_SENSOR) && viewer->gaze_sensor == event->sensor;
}

/* An axis in its range, still where a hand that lets go leaves it. */
static double deflection(double value) {
    const double rest = 0.1;
    return fabs(value) < rest ? 0 : fmin(fmax(value, -1), 1);
}

/* 1 when the event is of the device that navigates. */
static int move_wand(gw_wand *wand, const gw_tracker_navigation *navigation, const gw_tracking_event *event) {
    if (event->kind == GW_EVENT_BUTTON && event->sensor == navigation->reset)
        wand->resets += event->of.button.pressed != 0;
    else if (event->kind == GW_EVENT_ANALOG && event->sensor == navigation->forward)
        wand->forward = deflection(event->of.analog.value);
    else if (event->kind == GW_EVENT_ANALOG && event->sensor == navigation->turn)
        wand->turn = deflection(event->of.analog.value);
    else if (event->kind == GW_EVENT_LINK && !event->of.link.up)
        wand->forward = wand->turn = 0; /* nobody flies on a stick that is gone */
    else
        return 0;
    return event->kind != GW_EVENT_LINK;
}

void gw_tracker_take(gw_tracker *tracker, int source, const gw_tracking_event *event) {
    if (event->arrival > GW_LATEST || event->arrival < -GW_LATEST) {
        tracker->counters.not_finite++;
        return;
    }
    int taken = event->sensor >= 0 && source == tracker->setup.navigation.source &&
                move_wand(&tracker->wand, &tracker->setup.navigation, event);
    const int told = event->kind == GW_EVENT_POSE || event->kind == GW_EVENT_GAZE;
    if (told && event->sensor >= 0 && source >= 0 && (uint32_t)source < tracker->setup.source_count)
        for (uint32_t i = 0; i < tracker->setup.viewer_count && i < GW_TRACK_VIEWERS; i++) {
            const gw_tracker_viewer *viewer = &tracker->setup.viewers[i];
            if (event->kind == GW_EVENT_POSE && viewer->source == source &&
                viewer->head_sensor == event->sensor) {
                if (event->quality >= 0)
                    gw_room_watch(&tracker->sanity[source], &tracker->setup.sources[source].room,
                                  event->of.pose.position);
                gw_head_take(tracker, i, event);
                taken = 1;
            }
            if (is_gaze_of(viewer, source, event)) {
                gw_gaze_take(tracker, i, event);
                taken = 1;
            }
        }
    tracker->counters.unassigned += taken ? 0 : 1;
}

void gw_tracker_at(const gw_tracker *tracker, int64_t now, int64_t presentation, gw_tracker_view *out) {
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < GW_TRACK_VIEWERS; i++) {
        gw_head_at(tracker, i, now, presentation, &out->viewers[i]);
        gw_gaze_at(tracker, i, now, presentation, &out->viewers[i]);
    }
}

void gw_tracker_wand(const gw_tracker *tracker, gw_wand *out) {
    *out = tracker->wand;
}

/* The next samples are about another place: they must not count as a head or an eye that moved there. */
static void note_moves(gw_tracker *tracker, const int8_t *room_changed, uint32_t viewer, int sensor_changed) {
    const gw_tracker_viewer *who = &tracker->setup.viewers[viewer];
    const int head = who->source >= 0 && room_changed[who->source];
    const int gaze = who->gaze_source >= 0 && room_changed[who->gaze_source];
    if (head || sensor_changed)
        tracker->heads[viewer].moved = 1;
    if (head || gaze || sensor_changed)
        gw_gaze_filter_restart(&tracker->gazes[viewer].filter);
}

void gw_tracker_set_rooms(gw_tracker *tracker, const gw_tracker_setup *setup) {
    gw_tracker_setup *own = &tracker->setup;
    int8_t changed[GW_TRACKER_SOURCES] = {0};
    for (uint32_t s = 0; s < own->source_count && s < setup->source_count; s++) {
        changed[s] = !gw_room_equal(&own->sources[s].room, &setup->sources[s].room);
        own->sources[s].room = setup->sources[s].room;
    }
    memset(tracker->sanity, 0, sizeof tracker->sanity);
    for (uint32_t v = 0; v < own->viewer_count && v < setup->viewer_count; v++) {
        gw_tracker_viewer *to = &own->viewers[v];
        const gw_tracker_viewer *from = &setup->viewers[v];
        const int sensor_changed = memcmp(to->head_turn, from->head_turn, sizeof to->head_turn) != 0 ||
                                   memcmp(to->eye_offset, from->eye_offset, sizeof to->eye_offset) != 0;
        memcpy(to->head_turn, from->head_turn, sizeof to->head_turn);
        memcpy(to->eye_offset, from->eye_offset, sizeof to->eye_offset);
        to->gaze_error = from->gaze_error;
        note_moves(tracker, changed, v, sensor_changed);
    }
}

int gw_tracker_suspect(const gw_tracker *tracker, int source, char *text, size_t size) {
    return gw_room_suspect(&tracker->sanity[source], &tracker->setup.sources[source].room, text, size);
}

const gw_tracker_counters *gw_tracker_count(const gw_tracker *tracker) {
    return &tracker->counters;
}
