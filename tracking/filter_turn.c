#include "tracking/filter_turn.h"

#include "base/portable_math.h"
#include "tracking/filter_position.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <string.h>

/* Hz, of the angular velocity that predicts. */
static const double VELOCITY_CUTOFF = 6;

void gw_turn_to_vector(const double q[4], double out[3]) {
    const double sign = q[3] < 0 ? -1 : 1; /* of the two ways the one of at most half a turn */
    const double sine = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const double angle = 2 * gw_atan2(sine, sign * q[3]);
    const double scale = sine > 1e-12 ? sign * angle / sine : 2 * sign;
    for (int i = 0; i < 3; i++)
        out[i] = scale * q[i];
}

void gw_turn_from_vector(const double vector[3], double out[4]) {
    const double angle = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    const double scale = angle > 1e-12 ? gw_sin(0.5 * angle) / angle : 0.5;
    for (int i = 0; i < 3; i++)
        out[i] = scale * vector[i];
    out[3] = gw_cos(0.5 * angle);
}

void gw_turn_between(const double from[4], const double to[4], double out[3]) {
    double back[4], turn[4];
    gw_turn_back(from, back);
    gw_turn_after(back, to, turn);
    gw_turn_to_vector(turn, out);
}

void gw_turn_on(const double from[4], const double vector[3], double out[4]) {
    double turn[4];
    gw_turn_from_vector(vector, turn);
    gw_turn_after(from, turn, out);
    gw_turn_normalise(out);
}

void gw_turn_filter_begin(gw_turn_filter *filter, const gw_turn_tuning *tuning) {
    memset(filter, 0, sizeof *filter);
    filter->tuning = *tuning;
}

static void start(gw_turn_filter *f, const double sample[4]) {
    f->started = 1;
    memcpy(f->last, sample, sizeof f->last);
    memcpy(f->at, sample, sizeof f->at);
    f->delay = f->tuning.filtered ? gw_low_pass_delay(f->tuning.one_euro.cutoff) : 0;
}

static void estimate_velocity(gw_turn_filter *f, const double sample[4], double dt) {
    const double fast = gw_low_pass_weight(VELOCITY_CUTOFF, dt),
                 slow = gw_low_pass_weight(GW_SPEED_CUTOFF, dt);
    double way[3];
    gw_turn_between(f->last, sample, way);
    for (int i = 0; i < 3; i++) {
        f->velocity[i] += fast * (way[i] / dt - f->velocity[i]);
        f->slow[i] += slow * (way[i] / dt - f->slow[i]);
    }
}

int gw_turn_filter_take(gw_turn_filter *f, const double sample[4], double dt) {
    double unit[4], way[3];
    memcpy(unit, sample, sizeof unit);
    if (!gw_turn_normalise(unit))
        return 0;
    if (!f->started) {
        start(f, unit);
        return 1;
    }
    dt = gw_filter_step(dt);
    estimate_velocity(f, unit, dt);
    memcpy(f->last, unit, sizeof f->last);
    if (!f->tuning.filtered) {
        memcpy(f->at, unit, sizeof f->at);
        return 1;
    }
    const double speed = sqrt(f->slow[0] * f->slow[0] + f->slow[1] * f->slow[1] + f->slow[2] * f->slow[2]);
    const double cutoff = gw_one_euro_cutoff(&f->tuning.one_euro, speed);
    gw_turn_between(f->at, unit, way);
    const double weight = gw_low_pass_weight(cutoff, dt);
    for (int i = 0; i < 3; i++)
        way[i] *= weight;
    gw_turn_on(f->at, way, f->at);
    f->delay = gw_low_pass_delay(cutoff);
    return 1;
}
