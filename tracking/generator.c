/* Measuring people who do not exist: sensors with a rate, noise and a clock, and a line that delays, loses,
 * doubles and reorders. */
#include "tracking/generator.h"

#include "base/memory.h"
#include "tracking/generator_motion.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const gw_generator_kind gw_generator_kinds[] = {
    {"standing", "sway of the head, fixations, saccades, blinks"},
    {"walking", "from place to place, with the bob of steps"},
    {"pursuit", "eyes that follow something, catching up"},
    {"saccades", "jumps of 2 to 20 degrees, three a second"},
    {"two-viewers", "one standing, one walking"},
    {"dropouts", "standing, badly measured: holes, jitter, order,\n                       doubles, a clock's "
                 "step; button, axis"},
};
const size_t gw_generator_kind_count = sizeof gw_generator_kinds / sizeof *gw_generator_kinds;

enum { STANDING, WALKING, PURSUIT, SACCADES, TWO_VIEWERS, DROPOUTS };

static const int64_t START = (int64_t)1700000000 * 1000000000; /* ns since 1970 of arrival 0 */
static const double HEAD_RATE = 60.0, GAZE_RATE = 120.0;       /* Hz */
static const double PLACE_NOISE = 0.0001, TURN_NOISE = 0.0004; /* m, radians (0.02 degrees) */
static const double GAZE_NOISE = 0.0015;                       /* radians: 0.09 degrees */
static const double PLACE_UNIT = 0x1p-17, TURN_UNIT = 0x1p-21; /* what numbers are cut to */

/* What a line does to what it carries. */
typedef struct line {
    double delay, jitter;        /* s: least, and standard deviation of the rest */
    double doubled, reordered;   /* parts of all packets */
    double drift, step, step_at; /* of the device's clock: s per s; s */
    double hidden[8][2];         /* s: from, to: nothing comes */
    int hidden_count, clicks;
    double ahead; /* s that the device's clock is ahead of ours */
} line;

typedef struct maker {
    gw_recording *recording;
    size_t capacity;
    gw_random random;
    line line;
    double seconds;
} maker;

static double cut(double value, double unit) {
    return floor(value / unit + 0.5) * unit;
}

static int is_hidden(const line *l, double time) {
    for (int i = 0; i < l->hidden_count; i++)
        if (time >= l->hidden[i][0] && time < l->hidden[i][1])
            return 1;
    return 0;
}

static gw_code append(maker *m, const gw_tracking_event *event, gw_error *error) {
    gw_recording *recording = m->recording;
    void *memory = recording->events;
    gw_code code = gw_grow(&memory, &m->capacity, recording->count + 1, sizeof *recording->events,
                           "generated events", error);
    recording->events = memory;
    if (code == GW_OK)
        recording->events[recording->count++] = (gw_recorded_event){.sender = 0, .event = *event};
    return code;
}

/* Sends what was measured at `time` over the line; *before is the arrival of the sensor's packet before. */
static gw_code send(maker *m, gw_tracking_event *event, double time, double *before, gw_error *error) {
    const line *l = &m->line;
    const double late = fabs(gw_random_normal(&m->random)) * l->jitter;
    const double overtaken = gw_random_between(&m->random, 0.0, 1.0) < l->reordered ? 0.022 : 0.0;
    const int twice = gw_random_between(&m->random, 0.0, 1.0) < l->doubled;
    double arrival = time + l->delay + late;
    if (overtaken == 0.0) /* a line keeps the order, unless it is the one that does not */
        *before = arrival = fmax(arrival, *before + 0.0001);
    const double clock = time * (1.0 + l->drift) + l->ahead + (time >= l->step_at ? l->step : 0.0);
    event->arrival = (int64_t)((arrival + overtaken) * 1e6) * 1000;
    event->device_time = START + (int64_t)(clock * 1e6) * 1000;
    gw_code code = append(m, event, error);
    if (code == GW_OK && twice) {
        event->arrival += 300000;
        code = append(m, event, error);
    }
    return code;
}

static gw_code measure_head(maker *m, const gw_person *person, int32_t viewer, gw_error *error) {
    double before = 0.0;
    gw_code code = GW_OK;
    for (int64_t i = 0; (double)i < m->seconds * HEAD_RATE && code == GW_OK; i++) {
        const double time = (double)i / HEAD_RATE;
        gw_tracking_event event = {.kind = GW_EVENT_POSE, .sensor = 2 * viewer, .quality = 1.0};
        gw_person_head(person, time, event.of.pose.position, event.of.pose.orientation);
        for (int axis = 0; axis < 3; axis++) {
            event.of.pose.position[axis] =
                cut(event.of.pose.position[axis] + PLACE_NOISE * gw_random_normal(&m->random), PLACE_UNIT);
            event.of.pose.orientation[axis] = cut(
                event.of.pose.orientation[axis] + 0.5 * TURN_NOISE * gw_random_normal(&m->random), TURN_UNIT);
        }
        event.of.pose.orientation[3] = cut(event.of.pose.orientation[3], TURN_UNIT);
        if (!is_hidden(&m->line, time))
            code = send(m, &event, time, &before, error);
    }
    return code;
}

static gw_code measure_gaze(maker *m, const gw_person *person, int32_t viewer, gw_error *error) {
    const double unseen = 0.35; /* openness below which an eye tracker loses the pupil */
    double before = 0.0;
    gw_code code = GW_OK;
    for (int64_t i = 0; (double)i < m->seconds * GAZE_RATE && code == GW_OK; i++) {
        const double time = (double)i / GAZE_RATE;
        double turn[4], openness, direction[3];
        gw_tracking_event event = {.kind = GW_EVENT_GAZE, .sensor = viewer, .quality = 1.0};
        gw_person_head(person, time, event.of.gaze.origin, turn);
        gw_person_gaze(person, time, direction, &openness);
        event.of.gaze.has_origin = 1;
        event.of.gaze.openness = cut(openness, 0x1p-8);
        for (int axis = 0; axis < 3; axis++) {
            event.of.gaze.origin[axis] = cut(event.of.gaze.origin[axis], PLACE_UNIT);
            const double noise = axis < 2 ? GAZE_NOISE * gw_random_normal(&m->random) : 0.0;
            event.of.gaze.direction[axis] = direction[axis] + noise;
        }
        const double *d = event.of.gaze.direction;
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int axis = 0; axis < 3; axis++)
            event.of.gaze.direction[axis] = cut(event.of.gaze.direction[axis] / length, TURN_UNIT);
        if (openness < unseen)
            event.quality = -1.0;
        if (!is_hidden(&m->line, time))
            code = send(m, &event, time, &before, error);
    }
    return code;
}

/* A button that is pressed for a second in every four, an axis that is pushed in between; the link. */
static gw_code measure_wand(maker *m, gw_error *error) {
    double before = 0.0;
    gw_code code = GW_OK;
    for (double time = 1.0; time < m->seconds && code == GW_OK; time += 1.0) {
        const int64_t phase = (int64_t)time % 4;
        gw_tracking_event event = {.kind = GW_EVENT_BUTTON, .quality = 1.0};
        event.of.button.pressed = phase == 1;
        if (phase == 1 || phase == 2)
            code = send(m, &event, time, &before, error);
        event = (gw_tracking_event){.kind = GW_EVENT_ANALOG, .quality = 1.0};
        event.of.analog.value = phase == 3 ? cut(gw_random_between(&m->random, -1.0, 1.0), 0x1p-8) : 0.0;
        if (code == GW_OK && phase != 1)
            code = send(m, &event, time + 0.25, &before, error);
    }
    for (int i = 0; i < 2 && code == GW_OK; i++) {
        gw_tracking_event event = {
            .kind = GW_EVENT_LINK, .device_time = GW_NO_TIME, .quality = 1.0, .of.link = {i}};
        event.arrival = (int64_t)((m->line.hidden[0][i] + 0.05) * 1e6) * 1000;
        if (m->line.hidden[0][i] < m->seconds)
            code = append(m, &event, error);
    }
    return code;
}

/* By arrival; what arrives at one moment stays as it was made. */
static void sort_events(gw_recorded_event *events, gw_recorded_event *spare, size_t count) {
    if (count < 2)
        return;
    const size_t half = count / 2;
    sort_events(events, spare, half);
    sort_events(events + half, spare, count - half);
    memcpy(spare, events, half * sizeof *events);
    size_t left = 0, right = half, to = 0;
    while (left < half && right < count)
        events[to++] =
            spare[left].event.arrival <= events[right].event.arrival ? spare[left++] : events[right++];
    memcpy(events + to, spare + left, (half - left) * sizeof *events);
}

/* Order, counters, and arrivals from 0. */
static gw_code finish(maker *m, gw_error *error) {
    gw_recording *recording = m->recording;
    void *spare = NULL;
    gw_code code = gw_allocate(&spare, recording->count, sizeof *recording->events, "sorting events", error);
    if (code != GW_OK)
        return code;
    sort_events(recording->events, spare, recording->count);
    free(spare);
    const int64_t first = recording->events[0].event.arrival;
    for (size_t i = 0; i < recording->count; i++) {
        gw_tracking_event *event = &recording->events[i].event;
        event->arrival -= first;
        recording->counters.poses += event->kind == GW_EVENT_POSE;
        recording->counters.gazes += event->kind == GW_EVENT_GAZE;
        recording->counters.buttons += event->kind == GW_EVENT_BUTTON;
        recording->counters.analogs += event->kind == GW_EVENT_ANALOG;
        recording->counters.links += event->kind == GW_EVENT_LINK;
    }
    recording->start = START + first;
    recording->duration = recording->events[recording->count - 1].event.arrival;
    return GW_OK;
}

static void choose_line(maker *m, int kind) {
    m->line = (line){.delay = 0.006, .jitter = 0.0008, .step_at = INFINITY, .ahead = 0.25};
    if (kind != DROPOUTS)
        return;
    m->line = (line){.delay = 0.010,
                     .jitter = 0.006,
                     .doubled = 0.02,
                     .reordered = 0.03,
                     .drift = 80e-6,
                     .step = -1.5,
                     .step_at = 0.8 * m->seconds,
                     .hidden = {{0.3 * m->seconds, 0.3 * m->seconds + 3.0}},
                     .hidden_count = 1,
                     .clicks = 1,
                     .ahead = -12.0};
    for (double time = 1.0; m->line.hidden_count < 8;) {
        const double from = time + gw_random_between(&m->random, 0.3, 1.5);
        time = from + gw_random_between(&m->random, 0.05, 0.6);
        m->line.hidden[m->line.hidden_count][0] = from;
        m->line.hidden[m->line.hidden_count++][1] = time;
    }
}

/* The seed is the state of the random numbers at that moment, so what viewers do depends on the kind. */
static gw_code make_person(const maker *m, const gw_person_habits *habits, int32_t viewer, gw_person *out,
                           gw_error *error) {
    const uint64_t seed = m->random.state + 0x1000u * (uint64_t)viewer + 1;
    return gw_person_init(out, habits, seed, m->seconds)
               ? GW_OK
               : gw_fail(error, GW_MACHINE, "out of memory for a generated viewer");
}

static gw_code measure_person(maker *m, const gw_person_habits *habits, int32_t viewer, gw_error *error) {
    gw_person person;
    gw_code code = make_person(m, habits, viewer, &person, error);
    if (code != GW_OK)
        return code;
    code = measure_head(m, &person, viewer, error);
    if (code == GW_OK)
        code = measure_gaze(m, &person, viewer, error);
    gw_person_finish(&person);
    return code;
}

static gw_person_habits habits_of(int kind) {
    gw_person_habits habits = {.place = {0.0, 0.05, 1.8},
                               .walks = kind == WALKING,
                               .pursues = kind == PURSUIT,
                               .sway = 1.0,
                               .fixation = {0.25, 1.1},
                               .amplitude = {1.0, 15.0},
                               .blink_every = {2.0, 6.0}};
    if (kind == SACCADES) {
        habits.fixation[0] = 0.22;
        habits.fixation[1] = 0.45;
        habits.amplitude[0] = 2.0;
        habits.amplitude[1] = 20.0;
        habits.sway = 0.3;
    }
    if (kind == TWO_VIEWERS)
        habits.place[0] = -0.5;
    return habits;
}

static gw_code measure_all(maker *m, int kind, gw_error *error) {
    gw_person_habits habits = habits_of(kind);
    gw_code code = measure_person(m, &habits, 0, error);
    if (code == GW_OK && kind == TWO_VIEWERS) {
        habits.place[0] = 0.6;
        habits.place[1] = -0.1;
        habits.place[2] = 2.3;
        habits.walks = 1;
        code = measure_person(m, &habits, 1, error);
    }
    return code == GW_OK && m->line.clicks ? measure_wand(m, error) : code;
}

static gw_code name_all(gw_recording *recording, const char *kind, uint64_t seed, double seconds,
                        gw_error *error) {
    char name[96];
    void *memory = NULL;
    snprintf(name, sizeof name, "generate:%s", kind);
    recording->name = gw_copy_text(name);
    gw_code code = gw_allocate(&memory, 1, sizeof *recording->senders, "senders", error);
    recording->senders = memory;
    memory = NULL;
    if (code == GW_OK)
        code = gw_allocate(&memory, 1, sizeof *recording->notes, "notes", error);
    recording->notes = memory;
    if (code == GW_OK && recording->name == NULL)
        code = gw_fail(error, GW_MACHINE, "out of memory for a generated track");
    if (code != GW_OK)
        return code;
    recording->sender_count = recording->note_count = 1;
    snprintf(recording->senders[0], GW_SENDER_NAME, "Synthetic0");
    snprintf(recording->notes[0], GW_NOTE_SIZE,
             "synthetic: made by formula, of nobody; gazewall record generate:%s --seed %" PRIu64
             " --seconds %g",
             kind, seed, seconds);
    return GW_OK;
}

/* Its number; GW_BAD_INPUT for a kind or a length that cannot be made. */
static gw_code begin(const char *kind, uint64_t seed, double seconds, int *number, maker *out,
                     gw_error *error) {
    size_t at = 0;
    while (at < gw_generator_kind_count && strcmp(kind, gw_generator_kinds[at].name) != 0)
        at++;
    if (at == gw_generator_kind_count)
        return gw_fail(error, GW_BAD_INPUT,
                       "generate:%s: the kinds are standing, walking, pursuit, saccades, two-viewers and "
                       "dropouts",
                       kind);
    if (!(seconds >= 0.1 && seconds <= 600.0))
        return gw_fail(error, GW_BAD_INPUT, "generate:%s: 0.1 to 600 seconds can be made, not %g", kind,
                       seconds);
    *out = (maker){.random = {seed * 0x2545f4914f6cdd1du + at}, .seconds = seconds};
    *number = (int)at;
    choose_line(out, *number);
    return GW_OK;
}

gw_code gw_generate(const char *kind, uint64_t seed, double seconds, gw_recording **out, gw_error *error) {
    void *memory = NULL;
    maker m;
    int number;
    *out = NULL;
    gw_code code = begin(kind, seed, seconds, &number, &m, error);
    if (code == GW_OK)
        code = gw_allocate(&memory, 1, sizeof(gw_recording), "generated track", error);
    if (code != GW_OK)
        return code;
    m.recording = memory;
    code = name_all(m.recording, kind, seed, seconds, error);
    if (code == GW_OK)
        code = measure_all(&m, number, error);
    if (code == GW_OK)
        code = finish(&m, error);
    if (code == GW_OK)
        *out = m.recording;
    else
        gw_recording_destroy(&m.recording);
    return code;
}

gw_code gw_generated_person(const char *kind, uint64_t seed, double seconds, gw_person *out, int64_t *begun,
                            gw_error *error) {
    maker m;
    int number;
    gw_code code = begin(kind, seed, seconds, &number, &m, error);
    if (code != GW_OK)
        return code;
    const gw_person_habits habits = habits_of(number);
    *begun = START;
    return make_person(&m, &habits, 0, out, error);
}
