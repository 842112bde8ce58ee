/* What fuzzers and unit tests do with the bytes of a recording (VRPN log or CSV, plain or gzipped): read it,
 * check what came out, play it. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_RECORDING_ENTRY_H
#define GW_TESTS_FUZZ_RECORDING_ENTRY_H

#include "tracking/player.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_holds(int holds) {
    if (!holds)
        abort();
}

static inline int fuzz_is_unit(const double *vector, int count) {
    double length = 0.0;
    for (int i = 0; i < count; i++)
        length += vector[i] * vector[i];
    return fabs(length - 1.0) < 1e-9;
}

static inline void fuzz_check_event(const gw_tracking_event *event) {
    fuzz_holds(event->sensor >= 0 && event->latency >= 0 && fabs(event->quality) <= 1.0);
    if (event->kind == GW_EVENT_POSE)
        fuzz_holds(fuzz_is_unit(event->of.pose.orientation, 4) && isfinite(event->of.pose.position[0]) &&
                   isfinite(event->of.pose.position[1]) && isfinite(event->of.pose.position[2]));
    else if (event->kind == GW_EVENT_GAZE)
        fuzz_holds(fuzz_is_unit(event->of.gaze.direction, 3) && isfinite(event->of.gaze.origin[0]) &&
                   event->of.gaze.openness >= 0.0 && event->of.gaze.openness <= 1.0);
    else if (event->kind == GW_EVENT_ANALOG)
        fuzz_holds(isfinite(event->of.analog.value));
}

/* Every view of it is finite, whenever one asks; all its devices are the one of the plain convention. */
static inline void fuzz_play(const gw_recording *recording) {
    static const int8_t sources[GW_RECORDING_SENDERS] = {0};
    gw_error error = {0};
    gw_settings settings;
    gw_tracker_setup setup;
    gw_tracker *tracker = NULL;
    gw_player *player = NULL;
    gw_settings_init(&settings);
    gw_tracker_setup_default("Fuzz0", &setup);
    const gw_tracker_options options = {&settings, {0, 0, 1800}, 1};
    fuzz_holds(gw_tracker_create(&setup, &options, &tracker, &error) == GW_OK);
    fuzz_holds(gw_player_open(recording, sources, 0, &player, &error) == GW_OK);
    for (int step = -1; step < 9; step++) {
        gw_tracker_view view;
        const int64_t time = recording->duration / 8 * step;
        gw_player_feed(player, tracker, time);
        gw_tracker_at(tracker, time, time, &view);
        for (int i = 0; i < GW_TRACK_VIEWERS; i++) {
            const gw_viewer_view *v = &view.viewers[i];
            fuzz_holds(v->confidence >= 0 && v->confidence <= 1 && v->head_age >= 0);
            fuzz_holds(isfinite(v->eye[0]) && isfinite(v->eye[1]) && isfinite(v->eye[2]));
            fuzz_holds(!v->has_gaze || fuzz_is_unit(v->gaze_direction, 3));
        }
    }
    gw_player_close(&player);
    gw_tracker_destroy(&tracker);
}

/* Returns how many events were read, -1 when the start was refused. */
static inline long fuzz_recording(const uint8_t *data, size_t size) {
    gw_error error = {0};
    gw_recording *recording = NULL;
    gw_code code = gw_recording_parse(data, size, "fuzz", &recording, &error);
    fuzz_holds((code == GW_OK) == (recording != NULL));
    if (code != GW_OK) {
        fuzz_holds(error.text[0] != '\0');
        return -1;
    }
    const gw_recording_counters *c = &recording->counters;
    fuzz_holds(recording->count == c->poses + c->gazes + c->buttons + c->analogs + c->links);
    fuzz_holds(c->records == c->used + c->stamps + c->texts + c->descriptions + c->other_type +
                                 c->unknown_type + c->unknown_sender + c->bad_payload + c->bad_sensor +
                                 c->not_finite);
    for (size_t i = 0; i < recording->count; i++) {
        const gw_recorded_event *r = &recording->events[i];
        fuzz_holds(r->sender < recording->sender_count && strlen(recording->senders[r->sender]) < 96);
        fuzz_holds(i == 0 ? r->event.arrival == 0 : r->event.arrival >= r[-1].event.arrival);
        fuzz_check_event(&r->event);
    }
    fuzz_holds(recording->duration ==
               (recording->count > 0 ? recording->events[recording->count - 1].event.arrival : 0));
    char text[512];
    gw_recording_damage_text(recording, text, sizeof text);
    fuzz_holds((text[0] != '\0') == (recording->damage.found != 0));
    fuzz_holds(!recording->damage.found || recording->damage.offset <= c->bytes);
    if (recording->count > 0)
        fuzz_play(recording);
    const long count = (long)recording->count;
    gw_recording_destroy(&recording);
    return count;
}

#endif
