/* `bench tracking`: gazes. */
#include "wall/bench_tracking.h"

#include "base/memory.h"
#include "tracking/filter_gaze.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const gw_tracking_gaze_figures[GW_TRACKING_FIGURES] = {
    "lag_ms",          "told_ms",        "jitter_deg",     "after_saccade_deg",
    "saccades_missed", "saccades_false", "ahead_error_deg"};

const char *const gw_tracking_gaze_filters[GW_TRACKING_GAZE_FILTERS] = {
    "gaze_filter=none",
    "gaze_filter=one-euro",
    "gaze_filter=one-euro gaze_cutoff=1 gaze_cutoff_growth=0.02",
    "gaze_filter=one-euro saccade_speed=0",
    "gaze_filter=none gaze_prediction=on",
};

typedef struct eyes {
    gw_person person; /* owned by the caller */
    int rests;        /* 1: they do not move at all */
} eyes;

static void look(const eyes *e, double time, double out[3]) {
    double openness;
    if (e->rests) {
        out[0] = out[1] = 0;
        out[2] = -1;
    } else {
        gw_person_gaze(&e->person, time, out, &openness);
    }
}

/* Slower moves are eyes that fall behind what they follow. */
static int is_saccade(const gw_move *m) {
    return m->duration < 0.2;
}

double gw_tracking_since_saccade(const gw_person *person, double time) {
    double since = 1000;
    for (size_t i = 0; i < person->saccade_count; i++) {
        const gw_move *m = &person->saccades[i];
        if (!is_saccade(m))
            continue;
        if (time > m->start && time < m->start + m->duration)
            return 1000;
        if (time >= m->start + m->duration)
            since = time - m->start - m->duration;
    }
    return since;
}

typedef struct result {
    double lag, told, error, after, ahead;
    double missed, wrong; /* saccades that were made and not found; found and not made */
} result;

void gw_tracking_note(const gw_person *person, double time, double late, uint64_t told,
                      gw_tracking_findings *f) {
    const int news = told > f->told;
    f->told = told;
    for (size_t i = 0; news && i < person->saccade_count && i < GW_TRACKING_SACCADES; i++) {
        const gw_move *m = &person->saccades[i];
        if (!f->found[i] && is_saccade(m) && time >= m->start && time <= m->start + m->duration + late) {
            f->found[i] = 1;
            return;
        }
    }
    f->wrong += news;
}

/* Smaller ones lie within every margin of a gaze; what a blink hides nobody sees. */
static int is_worth_finding(const gw_person *person, const gw_move *m) {
    const double smallest = 2, open = 0.35;
    double from[3], to[3], openness[3], between[3];
    if (!is_saccade(m))
        return 0;
    gw_person_gaze(person, m->start, from, &openness[0]);
    gw_person_gaze(person, m->start + 0.5 * m->duration, between, &openness[1]);
    gw_person_gaze(person, m->start + m->duration, to, &openness[2]);
    return gw_degrees_between(from, to) >= smallest && openness[0] > open && openness[1] > open &&
           openness[2] > open;
}

double gw_tracking_missed(const gw_person *person, double seconds, const gw_tracking_findings *f) {
    double missed = 0;
    for (size_t i = 0; i < person->saccade_count && i < GW_TRACKING_SACCADES; i++)
        missed += person->saccades[i].start + person->saccades[i].duration < seconds && !f->found[i] &&
                  is_worth_finding(person, &person->saccades[i]);
    return missed;
}

/* Root mean squares in degrees: of all that is seen, and of the 0.1 s after a saccade and one sample. */
static gw_code watch(const eyes *e, double seconds, const gw_tracking_row *row, result *out,
                     gw_error *error) {
    gw_random random = {43};
    gw_tracker *tracker = NULL;
    gw_tracker_view view;
    const size_t count = (size_t)(seconds * row->rate), grid = (size_t)(seconds * GW_TRACKING_GRID);
    gw_tracking_path path = {.seconds = seconds};
    double *times = NULL, (*seen)[3] = NULL, sum = 0, after = 0;
    size_t landed = 0;
    gw_tracking_findings f = {.wrong = 0};
    gw_code code = gw_bench_tracker(row->filter, NULL, &tracker, error);
    if (!code)
        code = gw_allocate((void **)&path.at, grid, sizeof *path.at, "a path", error);
    if (!code)
        code = gw_allocate((void **)&times, count, sizeof *times, "times", error);
    if (!code)
        code = gw_allocate((void **)&seen, count, sizeof *seen, "gazes", error);
    for (size_t i = 0; i < grid && !code; i++)
        look(e, (double)i / GW_TRACKING_GRID, path.at[i]);
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < count && !code; i++) {
        times[i] = (double)i / row->rate;
        double truth[3];
        look(e, times[i], truth);
        gw_tracking_event event = {.kind = GW_EVENT_GAZE, .quality = 1, .device_time = GW_NO_TIME};
        event.arrival = llrint(times[i] * 1e9);
        event.of.gaze.openness = 1;
        for (int k = 0; k < 3; k++)
            event.of.gaze.direction[k] = truth[k] + row->noise * 0.0174533 * gw_random_normal(&random);
        gw_tracker_take(tracker, 0, &event);
        gw_tracker_at(tracker, event.arrival, event.arrival, &view);
        memcpy(seen[i], view.viewers[0].gaze_direction, sizeof *seen);
        const double off = gw_degrees_between(seen[i], truth);
        const double since = gw_tracking_since_saccade(&e->person, times[i]);
        gw_tracking_note(&e->person, times[i], 0.02 + 1 / row->rate, gw_tracker_count(tracker)->saccades, &f);
        sum += off * off;
        out->told += 1e-9 * (double)view.viewers[0].gaze_delay;
        gw_tracker_at(tracker, event.arrival, event.arrival + llrint(1e9 * GW_TRACKING_LEAD), &view);
        look(e, times[i] + GW_TRACKING_LEAD, truth);
        const double ahead = gw_degrees_between(view.viewers[0].gaze_direction, truth);
        out->ahead += ahead * ahead;
        if (since > 1 / row->rate && since < 0.1) {
            after += off * off;
            landed++;
        }
    }
    if (!code) {
        out->lag = gw_tracking_lag(&path, times, seen, count);
        out->told /= (double)count;
        out->error = sqrt(sum / (double)count);
        out->ahead = sqrt(out->ahead / (double)count);
        out->after = sqrt(after / (double)(landed ? landed : 1));
        out->missed = gw_tracking_missed(&e->person, seconds, &f);
        out->wrong = f.wrong;
    }
    gw_tracker_destroy(&tracker);
    free(path.at);
    free(times);
    free(seen);
    return code;
}

static gw_code measure(const eyes *pursuing, const eyes *jumping, const eyes *resting, double seconds,
                       gw_tracking_row *row, gw_error *error) {
    result pursuit, jumps, rest;
    gw_code code = watch(pursuing, seconds, row, &pursuit, error);
    if (!code)
        code = watch(jumping, seconds, row, &jumps, error);
    if (!code)
        code = watch(resting, seconds, row, &rest, error);
    if (code)
        return code;
    const double figures[GW_TRACKING_FIGURES] = {1e3 * pursuit.lag, 1e3 * pursuit.told, rest.error,
                                                 jumps.after,       jumps.missed,       jumps.wrong,
                                                 pursuit.ahead};
    memcpy(row->figures, figures, sizeof figures);
    return GW_OK;
}

gw_code gw_bench_tracking_gaze(double seconds, gw_tracking_row *rows, uint32_t *count, gw_error *error) {
    static const double rates[] = {60, 240}, noises[] = {0.1, 0.5};
    const gw_person_habits pursues = {.place = {0, 0.05, 1.8},
                                      .pursues = 1,
                                      .sway = 1,
                                      .fixation = {0.25, 1.1},
                                      .amplitude = {1, 15},
                                      .blink_every = {2, 6}},
                           jumps = {.place = {0, 0.05, 1.8},
                                    .sway = 1,
                                    .fixation = {0.22, 0.45},
                                    .amplitude = {2, 20},
                                    .blink_every = {2, 6}};
    eyes pursuing = {.rests = 0}, jumping = {.rests = 0}, resting = {.rests = 1};
    int made = gw_person_init(&pursuing.person, &pursues, 3, seconds);
    made = made && gw_person_init(&jumping.person, &jumps, 4, seconds);
    gw_code code = made ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while making a person");
    for (size_t n = 0; n < 2; n++)
        for (size_t r = 0; r < 2; r++)
            for (size_t f = 0; f < GW_TRACKING_GAZE_FILTERS && !code; f++) {
                gw_tracking_row *row = &rows[(*count)++];
                *row = (gw_tracking_row){.table = "gaze", .rate = rates[r], .noise = noises[n]};
                snprintf(row->filter, sizeof row->filter, "%s", gw_tracking_gaze_filters[f]);
                code = measure(&pursuing, &jumping, &resting, seconds, row, error);
            }
    gw_person_finish(&pursuing.person);
    gw_person_finish(&jumping.person);
    return code;
}
