/* `bench tracking`: the shipped tracks, as they were recorded with noise, blinks, holes and a clock of their
 * own, beside the people that they were made from. The note of each track says which person that is. */
#include "wall/bench_tracking.h"

#include "base/memory.h"
#include "tracking/filter_gaze.h"
#include "tracking/generator.h"
#include "tracking/player.h"
#include "tracking/track.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SETTLED = 0.5; /* s */

/* A track and whom it was made from; times of the person are those of the recording plus `ahead` s. */
typedef struct subject {
    const char *name;
    gw_recording *recording;
    gw_tracker_setup setup;
    int8_t sources[GW_RECORDING_SENDERS];
    gw_person person;
    int has_person;
    double ahead, seconds;
    gw_tracking_path path; /* of the head in mm, or of the gaze's direction */
} subject;

static gw_code open_subject(const char *name, int gaze, subject *s, gw_error *error) {
    char kind[32] = "", *at;
    uint64_t seed = 0;
    int64_t begun;
    int is_site;
    *s = (subject){.name = name};
    gw_code code = gw_track_load(name, &s->recording, error);
    if (!code)
        code = gw_player_setup(s->recording, NULL, &s->setup, s->sources, &is_site, error);
    if (code)
        return code;
    at = s->recording->note_count ? strstr(s->recording->notes[0], "generate:") : NULL;
    if (!at || sscanf(at, "generate:%31s --seed %" SCNu64 " --seconds %lf", kind, &seed, &s->seconds) != 3)
        return gw_fail(error, GW_MACHINE, "track %s: its note does not tell how it was made", name);
    code = gw_generated_person(kind, seed, s->seconds, &s->person, &begun, error);
    if (code)
        return code;
    s->has_person = 1;
    s->ahead = 1e-9 * (double)(s->recording->start - begun);
    s->path.seconds = s->seconds;
    const size_t count = (size_t)(s->seconds * GW_TRACKING_GRID);
    code = gw_allocate((void **)&s->path.at, count, sizeof *s->path.at, "a path", error);
    for (size_t i = 0; i < count && !code; i++) {
        double other[4], openness;
        if (gaze)
            gw_person_gaze(&s->person, (double)i / GW_TRACKING_GRID, s->path.at[i], &openness);
        else
            gw_person_head(&s->person, (double)i / GW_TRACKING_GRID, s->path.at[i], other);
        for (int k = 0; k < 3 && !gaze; k++)
            s->path.at[i][k] *= 1000;
    }
    return code;
}

static void close_subject(subject *s) {
    free(s->path.at);
    if (s->has_person)
        gw_person_finish(&s->person);
    gw_recording_destroy(&s->recording);
}

/* What is seen at each arrival of a sample of viewer 0. */
typedef struct seen {
    size_t count;
    double *times, (*at)[3]; /* s, of the person; owned */
    double told;             /* s, mean group delay */
    double lost; /* part of the samples at which the eye was led away or back: they do not count */
    gw_tracking_findings findings;
} seen;

static int is_sample(const gw_tracking_event *event, int gaze) {
    return event->quality >= 0 && event->sensor == 0 && event->kind == (gaze ? GW_EVENT_GAZE : GW_EVENT_POSE);
}

static gw_code watch(const subject *s, const char *settings, int gaze, double lead, seen *out,
                     gw_error *error) {
    gw_tracker *tracker = NULL;
    gw_player *player = NULL;
    gw_tracker_view view;
    const size_t most = s->recording->count;
    memset(out, 0, sizeof *out);
    gw_code code = gw_bench_tracker(settings, &s->setup, &tracker, error);
    if (!code)
        code = gw_player_open(s->recording, s->sources, 0, &player, error);
    if (!code)
        code = gw_allocate((void **)&out->times, most, sizeof *out->times, "times", error);
    if (!code)
        code = gw_allocate((void **)&out->at, most, sizeof *out->at, "what is seen", error);
    for (size_t i = 0; i < most && !code; i++) {
        const gw_tracking_event *event = &s->recording->events[i].event;
        const double time = 1e-9 * (double)event->arrival + s->ahead;
        if (!is_sample(event, gaze))
            continue;
        gw_player_feed(player, tracker, event->arrival);
        gw_tracker_at(tracker, event->arrival, event->arrival + llrint(lead * 1e9), &view);
        const gw_viewer_view *v = &view.viewers[0];
        gw_tracking_note(&s->person, time, 0.03, gw_tracker_count(tracker)->saccades, &out->findings);
        if (time < SETTLED || time > s->seconds - SETTLED)
            continue;
        if (!gaze && v->head_state != GW_SENSOR_FRESH) {
            out->lost++;
            continue;
        }
        out->times[out->count] = time;
        memcpy(out->at[out->count++], gaze ? v->gaze_direction : v->eye, sizeof *out->at);
        out->told += 1e-9 * (double)(gaze ? v->gaze_delay : v->head_delay);
    }
    out->told /= out->count ? (double)out->count : 1;
    gw_player_close(&player);
    gw_tracker_destroy(&tracker);
    return code;
}

static void finish_seen(seen *w) {
    free(w->times);
    free(w->at);
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* Root mean square distance from the path `ahead` s later. */
static double error_of(const subject *s, const seen *w, double ahead) {
    double sum = 0, truth[3];
    for (size_t i = 0; i < w->count; i++) {
        gw_tracking_path_at(&s->path, w->times[i] + ahead, truth);
        sum += distance(w->at[i], truth) * distance(w->at[i], truth);
    }
    return sqrt(sum / (double)(w->count ? w->count : 1));
}

/* How much what is seen shakes about the path: its second differences from sample to sample, which lag hardly
 * changes. Noise of each sample by itself, of root mean square r, gives r. */
static double jitter_of(const subject *s, const seen *w) {
    double sum = 0, off[3][3];
    size_t count = 0;
    for (size_t i = 2; i < w->count; i++) {
        double truth[3], second = 0;
        for (size_t k = 0; k < 3; k++) {
            gw_tracking_path_at(&s->path, w->times[i - k], truth);
            for (int axis = 0; axis < 3; axis++)
                off[k][axis] = w->at[i - k][axis] - truth[axis];
        }
        if (w->times[i] - w->times[i - 2] > 0.05)
            continue; /* over a hole */
        for (int axis = 0; axis < 3; axis++) {
            const double d = off[0][axis] - 2 * off[1][axis] + off[2][axis];
            second += d * d;
        }
        sum += second / 6;
        count++;
    }
    return sqrt(sum / (double)(count ? count : 1));
}

static gw_code measure_head(const subject *s, gw_tracking_row *row, gw_error *error) {
    char still[128];
    seen now = {0}, ahead = {0};
    snprintf(still, sizeof still, "%s prediction=off", row->filter);
    gw_code code = watch(s, still, 0, 0, &now, error);
    if (!code)
        code = watch(s, row->filter, 0, GW_TRACKING_LEAD, &ahead, error);
    if (!code) {
        row->figures[0] = 1e3 * gw_tracking_lag(&s->path, now.times, now.at, now.count);
        row->figures[1] = 1e3 * now.told;
        row->figures[2] = jitter_of(s, &now);
        row->figures[3] = error_of(s, &now, GW_TRACKING_LEAD);
        row->figures[4] = error_of(s, &ahead, GW_TRACKING_LEAD);
        row->figures[5] = jitter_of(s, &ahead);
    }
    finish_seen(&now);
    finish_seen(&ahead);
    return code;
}

/* Root mean square in degrees in the 0.1 s after a saccade and one sample. */
static double after_saccades(const subject *s, const seen *w) {
    double sum = 0, truth[3];
    size_t count = 0;
    for (size_t i = 1; i < w->count; i++) {
        const double since = gw_tracking_since_saccade(&s->person, w->times[i]);
        if (since < w->times[i] - w->times[i - 1] || since > 0.1)
            continue;
        gw_tracking_path_at(&s->path, w->times[i], truth);
        sum += gw_degrees_between(w->at[i], truth) * gw_degrees_between(w->at[i], truth);
        count++;
    }
    return sqrt(sum / (double)(count ? count : 1));
}

static gw_code measure_gaze(const subject *s, gw_tracking_row *row, gw_error *error) {
    const double degrees = 57.29577951308232;
    seen w = {0}, ahead = {0};
    gw_code code = watch(s, row->filter, 1, 0, &w, error);
    if (!code)
        code = watch(s, row->filter, 1, GW_TRACKING_LEAD, &ahead, error);
    if (!code) {
        row->figures[0] = 1e3 * gw_tracking_lag(&s->path, w.times, w.at, w.count);
        row->figures[1] = 1e3 * w.told;
        row->figures[2] = degrees * jitter_of(s, &w);
        row->figures[3] = after_saccades(s, &w);
        row->figures[4] = gw_tracking_missed(&s->person, s->seconds, &w.findings);
        row->figures[5] = w.findings.wrong;
        row->figures[6] = degrees * error_of(s, &ahead, GW_TRACKING_LEAD);
    }
    finish_seen(&w);
    finish_seen(&ahead);
    return code;
}

static gw_code measure(const char *name, int gaze, gw_tracking_row *rows, uint32_t *count, gw_error *error) {
    const char *const *filters = gaze ? gw_tracking_gaze_filters : gw_tracking_head_filters;
    const int filter_count = gaze ? GW_TRACKING_GAZE_FILTERS : GW_TRACKING_HEAD_FILTERS;
    subject s;
    gw_code code = open_subject(name, gaze, &s, error);
    for (int f = 0; f < filter_count && !code; f++) {
        gw_tracking_row *row = &rows[(*count)++];
        *row = (gw_tracking_row){
            .table = gaze ? "gaze" : "head", .rate = gaze ? 120 : 60, .noise = gaze ? 0.086 : 0.1};
        snprintf(row->track, sizeof row->track, "%s", name);
        snprintf(row->filter, sizeof row->filter, "%s", filters[f]);
        code = gaze ? measure_gaze(&s, row, error) : measure_head(&s, row, error);
    }
    close_subject(&s);
    return code;
}

gw_code gw_bench_tracking_shipped(gw_tracking_row *rows, uint32_t *count, gw_error *error) {
    static const char *const heads[] = {"standing", "walking", "dropouts"}, *const gazes[] = {"standing",
                                                                                              "pursuit",
                                                                                              "saccades"};
    gw_code code = GW_OK;
    for (size_t i = 0; i < sizeof heads / sizeof *heads && !code; i++)
        code = measure(heads[i], 0, rows, count, error);
    for (size_t i = 0; i < sizeof gazes / sizeof *gazes && !code; i++)
        code = measure(gazes[i], 1, rows, count, error);
    return code;
}
