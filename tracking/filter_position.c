#include "tracking/filter_position.h"

#include <math.h>
#include <string.h>

/* Hz, of the velocity of samples that no Kalman filter estimates. Heads turn back about once a second; a
 * lower cutoff predicts them past the turn, a higher one shakes (docs/tracking.md has the table). One-Euro's
 * own cutoff holds where it is lower, or what it steadied the prediction would shake again. */
static const double VELOCITY_CUTOFF = 6;

void gw_position_filter_begin(gw_position_filter *filter, const gw_position_tuning *tuning) {
    memset(filter, 0, sizeof *filter);
    filter->tuning = *tuning;
}

static void start(gw_position_filter *f, const double sample[3]) {
    const double fastest = 1000; /* mm/s: as far as the first sample knows, it may be any walk */
    f->started = 1;
    memcpy(f->last, sample, sizeof f->last);
    memcpy(f->at, sample, sizeof f->at);
    f->place_variance = f->tuning.noise * f->tuning.noise;
    f->velocity_variance = fastest * fastest;
    f->delay = f->tuning.kind == GW_FILTER_KIND_ONE_EURO ? gw_low_pass_delay(f->tuning.one_euro.cutoff) : 0;
}

/* The paper takes the speed from the sample and the filtered place before it, which counts the filter's own
 * lag as speed, the more the higher the rate is; two samples give the same at any rate. */
static void estimate_velocity(double velocity[3], const double last[3], const double sample[3], double cutoff,
                              double dt) {
    const double weight = gw_low_pass_weight(fmin(cutoff, VELOCITY_CUTOFF), dt);
    for (int i = 0; i < 3; i++)
        velocity[i] += weight * ((sample[i] - last[i]) / dt - velocity[i]);
}

static void take_one_euro(gw_position_filter *f, const double sample[3], double dt) {
    estimate_velocity(f->slow, f->last, sample, GW_SPEED_CUTOFF, dt);
    const double speed = sqrt(f->slow[0] * f->slow[0] + f->slow[1] * f->slow[1] + f->slow[2] * f->slow[2]);
    const double cutoff = gw_one_euro_cutoff(&f->tuning.one_euro, speed);
    const double weight = gw_low_pass_weight(cutoff, dt);
    estimate_velocity(f->velocity, f->last, sample, cutoff, dt);
    for (int i = 0; i < 3; i++)
        f->at[i] += weight * (sample[i] - f->at[i]);
    f->delay = gw_low_pass_delay(cutoff);
}

/* Y. Bar-Shalom, X. R. Li, T. Kirubarajan: Estimation with Applications to Tracking and Navigation (2001),
 * 6.2.2: velocity disturbed by white noise of density q, here the square of the usual acceleration times the
 * 0.1 s over which heads keep one. Follows even speed without lag, so its group delay is 0. */
static void take_kalman(gw_position_filter *f, const double sample[3], double dt) {
    const double lasting = 0.1; /* s */
    const double q = f->tuning.acceleration * f->tuning.acceleration * lasting;
    const double pp =
        f->place_variance + dt * (2 * f->covariance + dt * f->velocity_variance) + q * dt * dt * dt / 3;
    const double pv = f->covariance + dt * f->velocity_variance + q * dt * dt / 2;
    const double vv = f->velocity_variance + q * dt;
    const double innovation = pp + f->tuning.noise * f->tuning.noise;
    const double place_gain = pp / innovation, velocity_gain = pv / innovation;
    for (int i = 0; i < 3; i++) {
        const double predicted = f->at[i] + dt * f->velocity[i], surprise = sample[i] - predicted;
        f->at[i] = predicted + place_gain * surprise;
        f->velocity[i] += velocity_gain * surprise;
    }
    f->place_variance = (1 - place_gain) * pp;
    f->covariance = (1 - place_gain) * pv;
    f->velocity_variance = vv - velocity_gain * pv;
}

int gw_position_filter_take(gw_position_filter *f, const double sample[3], double dt) {
    if (!(isfinite(sample[0]) && isfinite(sample[1]) && isfinite(sample[2])))
        return 0;
    if (!f->started) {
        start(f, sample);
        return 1;
    }
    dt = gw_filter_step(dt);
    if (f->tuning.kind == GW_FILTER_KIND_KALMAN) {
        take_kalman(f, sample, dt);
    } else if (f->tuning.kind == GW_FILTER_KIND_ONE_EURO) {
        take_one_euro(f, sample, dt);
    } else {
        estimate_velocity(f->velocity, f->last, sample, VELOCITY_CUTOFF, dt);
        memcpy(f->at, sample, sizeof f->at);
    }
    memcpy(f->last, sample, sizeof f->last);
    return 1;
}
