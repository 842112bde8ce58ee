#include "tracking/filter_gaze.h"

#include "base/portable_math.h"

#include <math.h>
#include <string.h>

static const int64_t SPAN = 10000000;    /* ns over which samples are averaged before they are compared */
static const int64_t GAP = 200000000;    /* ns */
static const double REST = 0.5;          /* of saccade_speed: below it the saccade is over (hysteresis) */
static const double MAIN_SEQUENCE = 110; /* deg/s of a saccade of one degree */
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
    filter->usual = tuning->saccade_speed / 8;
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
 * the mean of the newest SPAN is compared with that of the SPAN before, or with the last sample of all. */
static double speed_of(const gw_gaze_filter *f) {
    const uint32_t newest = (f->count - 1) % GW_GAZE_RING;
    const uint32_t kept = f->count < GW_GAZE_RING ? f->count : GW_GAZE_RING;
    mean now = {{0}, 0, 0}, before = {{0}, 0, 0};
    for (uint32_t age = 0; age < kept; age++) {
        const uint32_t i = (newest + GW_GAZE_RING - age) % GW_GAZE_RING;
        const int64_t past = f->ring[newest].time - f->ring[i].time;
        if (past < SPAN)
            add(&now, f->ring[i].direction, -past);
        else if (past < 2 * SPAN || before.count == 0)
            add(&before, f->ring[i].direction, -past);
        else
            break;
    }
    if (!before.count || !make_unit(now.direction) || !make_unit(before.direction))
        return 0;
    const double seconds = 1e-9 * (now.time / now.count - before.time / before.count);
    return gw_degrees_between(now.direction, before.direction) / seconds;
}

/* --- filter */

static void take_as_it_is(gw_gaze_filter *f, const double unit[3]) {
    memcpy(f->at, unit, sizeof f->at);
    f->slow = 0;
    f->delay = 0;
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

/* A tracker that shakes says high speeds all the time: 4 times the median is passed by one in 65,000 speeds
 * of plain noise (Rayleigh's distribution), whatever its size (after M. Nystrom, K. Holmqvist: An adaptive
 * algorithm for fixation, saccade, and glissade detection, 2010). Up and down by equal parts, it comes to
 * rest where half of the speeds lie on either side; saccades take too little of the time to move it. */
static double threshold(gw_gaze_filter *f, double dt) {
    const double part = fmin(dt / 0.3, 0.2), now = fmax(f->tuning.saccade_speed, 4 * f->usual);
    f->usual = fmin(fmax(f->usual * (f->speed > f->usual ? 1 + part : 1 - part), 1), 1000);
    return now;
}

/* Ends by rest, or because no saccade lasts as long: then it is the tracker that shakes. */
static int goes_on(const gw_gaze_filter *f, double least, int64_t time) {
    const double gone = 1e-9 * (double)(time - f->since), slack = 0.05;
    return f->speed >= REST * least && gone <= SHORTEST + PER_DEGREE * LARGEST + slack;
}

static void watch(gw_gaze_filter *f, const double before[3], double dt, int64_t time) {
    if (f->tuning.saccade_speed <= 0)
        return;
    const double least = threshold(f, dt);
    if (f->in_saccade) {
        f->peak = f->speed > f->peak ? f->speed : f->peak;
        f->in_saccade = goes_on(f, least, time);
    } else if (f->speed >= least) {
        f->in_saccade = 1;
        f->saccades++;
        f->since = time;
        f->peak = f->speed;
        memcpy(f->from, before, sizeof f->from);
    }
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
        const double usual = f->usual;
        const gw_gaze_tuning tuning = f->tuning;
        gw_gaze_filter_begin(f, &tuning);
        f->saccades = saccades;
        f->usual = usual;
        f->started = 1;
        keep(f, unit, time);
        take_as_it_is(f, unit);
        f->delay = tuning.filtered ? gw_low_pass_delay(tuning.one_euro.cutoff) : 0;
        return 1;
    }
    memcpy(before, f->at, sizeof before);
    keep(f, unit, time);
    f->speed = speed_of(f);
    const int was = f->in_saccade;
    const double dt = 1e-9 * (double)(time - last);
    watch(f, before, dt, time);
    /* The sample at which it comes to rest is the first of the fixation. */
    if (f->in_saccade || was)
        take_as_it_is(f, unit);
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
