#include "tracking/filter_gaze.h"

#include "base/portable_math.h"

#include <math.h>
#include <string.h>

/* ns over which samples are averaged before they are compared with those before; and the part of
 * saccade_speed that counts over them, as a saccade that is shorter than the span moves slower on average. */
static const struct span {
    int64_t length;
    double part;
} spans[GW_GAZE_SPANS] = {{10000000, 1}, {20000000, 0.85}, {40000000, 0.5}};
/* What begins so soon after a saccade is its rest: eyes need 0.1 s and more before they leave again, and so
 * long it stays within the longest span. */
static const int64_t REFRACTORY = 80000000; /* ns */
static const int64_t GAP = 200000000;       /* ns */
static const double REST = 0.5;             /* of saccade_speed: below it the saccade is over (hysteresis) */
static const double MAIN_SEQUENCE = 110;    /* deg/s of a saccade of one degree */
static const double SHORTEST = 0.021, PER_DEGREE = 0.0022; /* s of a saccade, and for each degree of it */
static const double OVERSHOOT =
    0.1;                          /* of the whole way, by which saccades land off (Becker and Fuchs 1969) */
static const double LARGEST = 60; /* deg; larger ones are made with the head */
/* While it gets faster nothing is known of its end; most saccades are of 15 degrees or less (Bahill, Adler
 * and Stark 1975), and their first half is behind by the time the speed has risen. */
static const double LEAST_TO_GO = 7; /* deg */

double gw_degrees_between(const double a[3], const double b[3]) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    const double along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return gw_atan2(sqrt(x * x + y * y + z * z), along) * (180 / GW_PI);
}

/* 1, and of length 1, if v has a length. */
static int make_unit(double v[3]) {
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 1e-9 && length < 1e150))
        return 0;
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return 1;
}

void gw_gaze_filter_begin(gw_gaze_filter *filter, const gw_gaze_tuning *tuning) {
    memset(filter, 0, sizeof *filter);
    filter->tuning = *tuning;
    for (int i = 0; i < GW_GAZE_SPANS; i++)
        filter->usual[i] = tuning->saccade_speed / 8;
}

void gw_gaze_filter_restart(gw_gaze_filter *filter) {
    filter->started = 0;
}

/* --- speed */

typedef struct mean {
    double direction[3], time; /* sums; the time in ns after the oldest that counts */
    uint32_t count;
} mean;

static void add(mean *m, const double direction[3], int64_t time) {
    for (int i = 0; i < 3; i++)
        m->direction[i] += direction[i];
    m->time += (double)time;
    m->count++;
}

/* Two neighbours alone would be mostly noise at a high rate: at 1000 Hz a tenth of a degree is 140 deg/s. So
 * the mean of the newest samples of a span is compared with that of the span before, or with the last sample
 * of all. The way between them, 1/s; 0: there are not enough samples. */
static int velocity_over(const gw_gaze_filter *f, int64_t length, double out[3]) {
    const uint32_t newest = (f->count - 1) % GW_GAZE_RING;
    const uint32_t kept = f->count < GW_GAZE_RING ? f->count : GW_GAZE_RING;
    mean now = {{0}, 0, 0}, before = {{0}, 0, 0};
    for (uint32_t age = 0; age < kept; age++) {
        const uint32_t i = (newest + GW_GAZE_RING - age) % GW_GAZE_RING;
        const int64_t past = f->ring[newest].time - f->ring[i].time;
        if (past < length)
            add(&now, f->ring[i].direction, -past);
        else if (past < 2 * length || before.count == 0)
            add(&before, f->ring[i].direction, -past);
        else
            break;
    }
    if (!before.count || !make_unit(now.direction) || !make_unit(before.direction))
        return 0;
    const double seconds = 1e-9 * (now.time / now.count - before.time / before.count);
    for (int i = 0; i < 3; i++)
        out[i] = (now.direction[i] - before.direction[i]) / seconds;
    return 1;
}

/* deg/s; chords for arcs, which over spans are 1 % apart at most. */
static double speed_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * (180 / GW_PI);
}

/* --- filter */

static void take_as_it_is(gw_gaze_filter *f, const double unit[3]) {
    memcpy(f->at, unit, sizeof f->at);
    f->slow = 0;
    f->delay = 0;
}

/* Through a saccade: as it is, or, where a single sample is so noisy that only a longer span told the
 * saccade, as the mean of the newest half of that span. */
static void follow(gw_gaze_filter *f, const double unit[3]) {
    const uint32_t newest = (f->count - 1) % GW_GAZE_RING;
    double sum[3] = {0, 0, 0};
    const int64_t length = f->tuning.filtered && f->span ? spans[f->span].length / 2 : 0;
    for (uint32_t age = 0; age < f->count && age < GW_GAZE_RING; age++) {
        const uint32_t i = (newest + GW_GAZE_RING - age) % GW_GAZE_RING;
        if (age && f->ring[newest].time - f->ring[i].time >= length)
            break;
        for (int k = 0; k < 3; k++)
            sum[k] += f->ring[i].direction[k];
    }
    take_as_it_is(f, make_unit(sum) ? sum : unit);
}

static void smooth(gw_gaze_filter *f, const double unit[3], double dt) {
    if (!f->tuning.filtered) {
        take_as_it_is(f, unit);
        return;
    }
    f->slow += gw_low_pass_weight(GW_SPEED_CUTOFF, dt) * (f->speed - f->slow);
    const double cutoff = gw_one_euro_cutoff(&f->tuning.one_euro, f->slow);
    const double weight = gw_low_pass_weight(cutoff, dt);
    /* The straight way instead of the arc: what is not a saccade moves little, and to one side of it. */
    double moved[3];
    for (int i = 0; i < 3; i++)
        moved[i] = f->at[i] + weight * (unit[i] - f->at[i]);
    if (make_unit(moved))
        memcpy(f->at, moved, sizeof f->at);
    else
        memcpy(f->at, unit, sizeof f->at);
    f->delay = gw_low_pass_delay(cutoff);
}

/* --- saccades */

static double way_of(const gw_gaze_filter *f) {
    const double way = f->peak / MAIN_SEQUENCE;
    return way * way < LARGEST ? way * way : LARGEST;
}

/* A tracker that shakes says high speeds all the time, so a speed counts that passes a multiple of the usual
 * one, told by its median, which saccades take too little of the time to move (R. Engbert, R. Kliegl:
 * Microsaccades uncover the orientation of covert attention, 2003; M. Nystrom, K. Holmqvist: An adaptive
 * algorithm for fixation, saccade, and glissade detection, 2010): 4 medians are passed by one in 65,000
 * speeds of plain noise (Rayleigh's distribution). Engbert and Kliegl look at one span; what drowns in a
 * short one stands out in a longer one, over which noise averages out, so each span has a median of its own.
 * Up and down by equal parts, it comes to rest where half of the speeds lie on either side. What the eyes do
 * between saccades - pursuit - is taken off. */
static double threshold(const gw_gaze_filter *f, int span) {
    return fmax(f->tuning.saccade_speed * spans[span].part, 4 * f->usual[span]);
}

/* Ends by rest, or because no saccade lasts as long: then it is the tracker that shakes. */
static int goes_on(const gw_gaze_filter *f, const double speeds[GW_GAZE_SPANS], int64_t time) {
    const double gone = 1e-9 * (double)(time - f->since), slack = 0.05;
    int moves = 0;
    for (int i = 0; i <= f->span; i++)
        moves |= speeds[i] >= REST * threshold(f, i);
    return moves && gone <= SHORTEST + PER_DEGREE * LARGEST + slack;
}

/* Spans that are looked at for a saccade: a shorter one that sees it, too, tells its end sooner; one that was
 * just over is still within the longer ones. */
static int was_just_over(const gw_gaze_filter *f, int64_t time) {
    return f->saccades && time - f->ended < REFRACTORY;
}

static int spans_to_look_at(const gw_gaze_filter *f, int64_t time) {
    if (f->in_saccade)
        return f->span;
    return was_just_over(f, time) ? f->span + 1 : GW_GAZE_SPANS;
}

static void begin_saccade(gw_gaze_filter *f, const double before[3], int64_t time) {
    f->in_saccade = 1;
    if (was_just_over(f, time))
        return; /* the same one */
    f->saccades++;
    f->since = time;
    f->peak = 0;
    memcpy(f->from, before, sizeof f->from);
}

/* Of longer spans than the one by which a saccade was seen nothing is learned while they hold it. That one
 * goes on learning, or a tracker that shakes more than it did would be in a saccade for ever. */
static void learn(gw_gaze_filter *f, const double speeds[GW_GAZE_SPANS], const double velocity[3], double dt,
                  int64_t time) {
    const double part = fmin(dt / 0.3, 0.2), weight = fmin(dt / 0.2, 0.5);
    const int held = f->in_saccade || was_just_over(f, time);
    for (int i = 0; i < (held ? f->span + 1 : GW_GAZE_SPANS); i++)
        f->usual[i] = fmin(fmax(f->usual[i] * (speeds[i] > f->usual[i] ? 1 + part : 1 - part), 1), 1000);
    for (int i = 0; i < 3 && !held; i++)
        f->drift[i] += weight * (velocity[i] - f->drift[i]);
}

static void watch(gw_gaze_filter *f, const double before[3], double dt, int64_t time) {
    double velocities[GW_GAZE_SPANS][3] = {{0}}, speeds[GW_GAZE_SPANS];
    for (int i = 0; i < GW_GAZE_SPANS; i++) {
        double beyond[3] = {0, 0, 0};
        if (velocity_over(f, spans[i].length, velocities[i]))
            for (int k = 0; k < 3; k++)
                beyond[k] = velocities[i][k] - f->drift[k];
        speeds[i] = speed_of(beyond);
    }
    f->speed = speed_of(velocities[0]);
    if (f->tuning.saccade_speed <= 0)
        return;
    if (f->in_saccade && !goes_on(f, speeds, time)) {
        f->in_saccade = 0;
        f->ended = time;
    }
    const int count = spans_to_look_at(f, time);
    int seen = 0;
    while (seen < count && speeds[seen] < threshold(f, seen))
        seen++;
    if (seen < count && !f->in_saccade)
        begin_saccade(f, before, time);
    f->span = seen < count ? seen : f->span;
    if (f->in_saccade)
        f->peak = fmax(f->peak, f->speed);
    learn(f, speeds, velocities[GW_GAZE_SPANS - 1], dt, time);
}

static void keep(gw_gaze_filter *f, const double unit[3], int64_t time) {
    const uint32_t place = f->count++ % GW_GAZE_RING;
    f->ring[place].time = time;
    memcpy(f->ring[place].direction, unit, sizeof f->ring[place].direction);
}

int gw_gaze_filter_take(gw_gaze_filter *f, const double direction[3], int64_t time) {
    double unit[3] = {direction[0], direction[1], direction[2]}, before[3];
    if (!make_unit(unit))
        return 0;
    const int64_t last = f->count ? f->ring[(f->count - 1) % GW_GAZE_RING].time : time;
    if (f->started && time <= last)
        return 0;
    if (!f->started || time - last > GAP) {
        const uint32_t saccades = f->saccades;
        double usual[GW_GAZE_SPANS];
        memcpy(usual, f->usual, sizeof usual);
        const gw_gaze_tuning tuning = f->tuning;
        gw_gaze_filter_begin(f, &tuning);
        f->saccades = saccades;
        memcpy(f->usual, usual, sizeof usual);
        f->started = 1;
        keep(f, unit, time);
        take_as_it_is(f, unit);
        f->delay = tuning.filtered ? gw_low_pass_delay(tuning.one_euro.cutoff) : 0;
        return 1;
    }
    memcpy(before, f->at, sizeof before);
    keep(f, unit, time);
    const int was = f->in_saccade;
    const double dt = 1e-9 * (double)(time - last);
    watch(f, before, dt, time);
    /* The sample at which it comes to rest is the first of the fixation. */
    if (f->in_saccade || was)
        follow(f, unit);
    else
        smooth(f, unit, dt);
    return 1;
}

double gw_gaze_filter_widening(const gw_gaze_filter *f, double late) {
    if (!f->in_saccade)
        return 0;
    const double gone = gw_degrees_between(f->from, f->at), way = way_of(f);
    const double rising = f->speed >= f->peak ? LEAST_TO_GO : 0;
    const double to_go = fmax((1 + OVERSHOOT) * way - gone, fmax(OVERSHOOT * way, rising));
    const double moving = f->speed * fmax(late, 0);
    return fmin(fmax(to_go, fmin(moving, LARGEST)), f->tuning.widening_limit);
}

void gw_gaze_filter_predict(const gw_gaze_filter *f, double seconds, double out[3]) {
    memcpy(out, f->at, sizeof f->at);
    if (f->in_saccade || seconds <= 0)
        return;
    for (int i = 0; i < 3; i++)
        out[i] += seconds * f->drift[i];
    if (!make_unit(out))
        memcpy(out, f->at, sizeof f->at);
}

uint32_t gw_gaze_filter_recent(const gw_gaze_filter *f, int64_t span, uint32_t most, uint32_t *places) {
    const uint32_t kept = f->count < GW_GAZE_RING ? f->count : GW_GAZE_RING;
    uint32_t count = 0;
    if (!f->started || f->in_saccade)
        return 0;
    const uint32_t newest = (f->count - 1) % GW_GAZE_RING;
    for (; count < kept && count < most; count++) {
        const uint32_t i = (newest + GW_GAZE_RING - count) % GW_GAZE_RING;
        if (f->ring[newest].time - f->ring[i].time >= span || (f->saccades && f->ring[i].time < f->ended))
            break;
    }
    for (uint32_t k = 0; k < count; k++)
        places[count - 1 - k] = (newest + GW_GAZE_RING - k) % GW_GAZE_RING;
    return count;
}
