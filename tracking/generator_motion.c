#include "tracking/generator_motion.h"

#include "base/portable_math.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double DEGREES = 180.0 / GW_PI;
static const double WALL[2] = {0.85, 0.45}; /* m: half the extent of what is looked at */

static uint64_t random_bits(gw_random *random) {
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double gw_random_between(gw_random *random, double low, double high) {
    return low + (high - low) * ((double)(random_bits(random) >> 11) * 0x1p-53);
}

double gw_random_normal(gw_random *random) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += gw_random_between(random, 0.0, 1.0);
    return sum;
}

double gw_minimum_jerk(double t) {
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

/* exp(-x) for x >= 0 with + and * alone, so the same bits everywhere: the series of x / 256, squared eight
 * times. */
static double decay(double x) {
    double sum = 1.0, term = 1.0;
    for (int i = 1; i < 12; i++) {
        term *= -x / 256.0 / i;
        sum += term;
    }
    for (int i = 0; i < 8; i++)
        sum *= sum;
    return sum;
}

double gw_saccade_peak(double degrees) {
    return 551.0 * (1.0 - decay(degrees / 14.0));
}

double gw_saccade_duration(double degrees) {
    const double peak_of_minimum_jerk = 1.875;
    return degrees > 0.0 ? peak_of_minimum_jerk * degrees / gw_saccade_peak(degrees) : 0.0;
}

/* low and high in Hz; rms in the unit of what wanders. */
static void init_wander(gw_wander *wander, gw_random *random, double low, double high, double rms) {
    double step = high / low, frequency = low;
    for (int halving = 0; halving < 4; halving++) /* the sixteenth root, so that twelve steps stay below */
        step = sqrt(step);
    for (int i = 0; i < GW_WAVES; i++, frequency *= step) {
        wander->frequency[i] = frequency * gw_random_between(random, 0.97, 1.03);
        wander->phase[i] = gw_random_between(random, 0.0, 2.0 * GW_PI);
    }
    wander->amplitude = rms * sqrt(2.0 / GW_WAVES);
}

static double wander_at(const gw_wander *wander, double time) {
    double sum = 0.0;
    for (int i = 0; i < GW_WAVES; i++)
        sum += gw_sin(2.0 * GW_PI * wander->frequency[i] * time + wander->phase[i]);
    return sum * wander->amplitude;
}

/* Adds what the moves have gone at `time`; speed, if given, is the largest part of its peak that any has. */
static void add_moves(const gw_move *moves, size_t count, double time, double part, int axes, double *at,
                      double *speed) {
    for (size_t i = 0; i < count && moves[i].start < time; i++) {
        const double t = (time - moves[i].start) / moves[i].duration, way = part * gw_minimum_jerk(t);
        for (int axis = 0; axis < axes; axis++)
            at[axis] += moves[i].way[axis] * way;
        if (speed != NULL && t < 1.0)
            *speed = fmax(*speed, 16.0 * t * t * (1.0 - t) * (1.0 - t));
    }
}

static void target_at(const gw_person *person, double time, double at[2]) {
    for (int axis = 0; axis < 2; axis++)
        at[axis] = person->pursuit[axis] * gw_sin(person->pursuit_turn[axis] * time);
}

/* Head without what the feet do. */
static void head_place(const gw_person *person, double time, double at[3]) {
    double speed = 0.0;
    memcpy(at, person->place, sizeof person->place);
    add_moves(person->walk, person->walk_count, time, 1.0, 3, at, &speed);
    for (int axis = 0; axis < 3; axis++)
        at[axis] += wander_at(&person->sway[axis], time);
    /* Two steps a stride: up and down with each step, from side to side with each stride. */
    const double steps = 1.9;
    at[1] += 0.020 * speed * gw_sin(2.0 * GW_PI * steps * time);
    at[0] += 0.012 * speed * gw_sin(GW_PI * steps * time);
}

/* The point on the wall that the eyes are turned to. */
static void gaze_point(const gw_person *person, double time, double at[2]) {
    double target[2];
    target_at(person, time, target);
    for (int axis = 0; axis < 2; axis++)
        at[axis] = person->looks_at[axis] + target[axis] + wander_at(&person->drift[axis], time);
    add_moves(person->saccades, person->saccade_count, time, 1.0, 2, at, NULL);
}

/* The shortest turn of (0,0,-1) onto a direction to the wall, of any length. */
static void turn_to(const double direction[3], double q[4]) {
    const double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    q[0] = direction[1];
    q[1] = -direction[0];
    q[2] = 0.0;
    q[3] = length - direction[2];
    gw_turn_normalise(q);
}

void gw_person_head(const gw_person *person, double time, double position[3], double orientation[4]) {
    const double share = 0.4, delay = 0.05, slower = 5.0; /* of the head in a turn of the gaze */
    double faces[2] = {share * person->looks_at[0], share * person->looks_at[1]}, target[2];
    head_place(person, time, position);
    target_at(person, time - 2.0 * delay, target);
    for (size_t i = 0; i < person->saccade_count && person->saccades[i].start + delay < time; i++) {
        const gw_move *move = &person->saccades[i];
        const double t = gw_minimum_jerk((time - delay - move->start) / (slower * move->duration + 0.1));
        faces[0] += share * move->way[0] * t;
        faces[1] += share * move->way[1] * t;
    }
    const double direction[3] = {faces[0] + share * target[0] - position[0],
                                 faces[1] + share * target[1] - position[1], -position[2]};
    turn_to(direction, orientation);
}

void gw_person_gaze(const gw_person *person, double time, double direction[3], double *openness) {
    const double lid = 0.06; /* s that a lid takes to shut; it opens in twice that */
    double at[2], eye[3];
    gaze_point(person, time, at);
    head_place(person, time, eye);
    direction[0] = at[0] - eye[0];
    direction[1] = at[1] - eye[1];
    direction[2] = -eye[2];
    const double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    for (int i = 0; i < 3; i++)
        direction[i] /= length;
    *openness = 1.0;
    for (size_t i = 0; i < person->blink_count; i++) {
        const gw_move *blink = &person->blinks[i];
        const double shut = gw_minimum_jerk((time - (blink->start - lid)) / lid) -
                            gw_minimum_jerk((time - (blink->start + blink->duration)) / (2.0 * lid));
        *openness = fmin(*openness, 1.0 - shut);
    }
}

static gw_move *new_moves(void) {
    return calloc(GW_MOVES, sizeof(gw_move));
}

/* From place to place in front of the wall, about 0.7 m/s, resting in between. */
static void plan_walk(gw_person *person, gw_random *random, double seconds) {
    double at[3];
    memcpy(at, person->place, sizeof at);
    for (double time = 1.0; time < seconds && person->walk_count < GW_MOVES;) {
        const double side = gw_random_between(random, -1.1, 1.1);
        const double to[3] = {side, at[1], gw_random_between(random, 1.2, 2.6)};
        gw_move *move = &person->walk[person->walk_count++];
        const double x = to[0] - at[0], z = to[2] - at[2];
        *move = (gw_move){.start = time, .duration = fmax(1.0, sqrt(x * x + z * z) / 0.7), .way = {x, 0, z}};
        memcpy(at, to, sizeof at);
        time += move->duration + gw_random_between(random, 0.3, 1.2);
    }
}

/* A saccade of the eyes at `time` by `way` on the wall; its degrees as seen from where the head is then. */
static void add_saccade(gw_person *person, double time, const double way[2]) {
    double eye[3], from[2], before[3], after[3], dot = 0.0, lengths[2] = {0.0, 0.0};
    if (person->saccade_count == GW_MOVES)
        return;
    head_place(person, time, eye);
    gaze_point(person, time, from);
    for (int i = 0; i < 3; i++) {
        before[i] = (i < 2 ? from[i] : 0.0) - eye[i];
        after[i] = before[i] + (i < 2 ? way[i] : 0.0);
        dot += before[i] * after[i];
        lengths[0] += before[i] * before[i];
        lengths[1] += after[i] * after[i];
    }
    const double degrees = gw_acos(dot / sqrt(lengths[0] * lengths[1])) * DEGREES;
    person->saccades[person->saccade_count++] = (gw_move){
        .start = time, .duration = fmax(0.01, gw_saccade_duration(degrees)), .way = {way[0], way[1], 0.0}};
}

static void plan_saccades(gw_person *person, gw_random *random, const gw_person_habits *habits,
                          double seconds) {
    double time = gw_random_between(random, habits->fixation[0], habits->fixation[1]);
    while (time < seconds && person->saccade_count < GW_MOVES) {
        const double degrees = gw_random_between(random, habits->amplitude[0], habits->amplitude[1]);
        double from[2], eye[3], way[2] = {0.0, 0.0};
        gaze_point(person, time, from);
        head_place(person, time, eye);
        /* Any direction that stays on the wall; after some tries, towards its middle. */
        for (int tries = 0; tries < 16; tries++) {
            const double turn = gw_random_between(random, 0.0, 2.0 * GW_PI),
                         reach = eye[2] * degrees / DEGREES;
            way[0] = reach * gw_cos(turn);
            way[1] = reach * gw_sin(turn);
            if (fabs(from[0] + way[0]) < WALL[0] && fabs(from[1] + way[1]) < WALL[1])
                break;
            way[0] = -0.5 * from[0];
            way[1] = -0.5 * from[1];
        }
        add_saccade(person, time, way);
        time += gw_random_between(random, habits->fixation[0], habits->fixation[1]);
    }
}

/* The eyes follow at 0.92 of the target's speed (gains of 0.9 to 1 are usual below 30 degrees/s: Meyer,
 * Lasker, Robinson 1985); saccades catch up. */
static void plan_pursuit(gw_person *person, gw_random *random, const gw_person_habits *habits,
                         double seconds) {
    const double slip = 0.08;
    double time = 0.0, before[2], now[2];
    target_at(person, 0.0, before);
    while (time < seconds && person->saccade_count + 1 < GW_MOVES) {
        const double rest = gw_random_between(random, habits->fixation[0], habits->fixation[1]);
        target_at(person, time + rest, now);
        const double behind[2] = {slip * (now[0] - before[0]), slip * (now[1] - before[1])};
        /* Falling behind is a slow move against the target, and the saccade takes it back. */
        person->saccades[person->saccade_count++] =
            (gw_move){.start = time, .duration = rest, .way = {-behind[0], -behind[1], 0.0}};
        add_saccade(person, time + rest, behind);
        memcpy(before, now, sizeof before);
        time += rest;
    }
}

static void plan_blinks(gw_person *person, gw_random *random, const gw_person_habits *habits,
                        double seconds) {
    double time = gw_random_between(random, 0.5, habits->blink_every[1]);
    while (time < seconds && person->blink_count < GW_MOVES) {
        const double shut = gw_random_between(random, 0.10, 0.30);
        person->blinks[person->blink_count++] = (gw_move){.start = time, .duration = shut};
        time += gw_random_between(random, habits->blink_every[0], habits->blink_every[1]);
    }
}

int gw_person_init(gw_person *person, const gw_person_habits *habits, uint64_t seed, double seconds) {
    /* Standing people's heads sway by 5 to 15 mm, more to the front than to the side. */
    static const double sway[3] = {0.004, 0.0015, 0.006};
    gw_random random = {seed};
    *person = (gw_person){.walk = new_moves(), .saccades = new_moves(), .blinks = new_moves()};
    if (person->walk == NULL || person->saccades == NULL || person->blinks == NULL) {
        gw_person_finish(person);
        return 0;
    }
    memcpy(person->place, habits->place, sizeof person->place);
    for (int axis = 0; axis < 3; axis++)
        init_wander(&person->sway[axis], &random, 0.05, 2.0, habits->sway * sway[axis]);
    for (int axis = 0; axis < 2; axis++) {
        /* A resting eye drifts by about a tenth of a degree (Rucci, Poletti 2015). */
        init_wander(&person->drift[axis], &random, 0.3, 8.0, 0.06 / DEGREES * habits->place[2]);
        person->looks_at[axis] = habits->pursues ? 0.0 : gw_random_between(&random, -0.4, 0.4) * WALL[axis];
    }
    if (habits->walks)
        plan_walk(person, &random, seconds);
    if (habits->pursues) {
        person->pursuit[0] = 0.75;
        person->pursuit[1] = 0.35;
        person->pursuit_turn[0] = 2.0 * GW_PI * gw_random_between(&random, 0.10, 0.14);
        person->pursuit_turn[1] = 2.0 * GW_PI * gw_random_between(&random, 0.15, 0.21);
        plan_pursuit(person, &random, habits, seconds);
    } else {
        plan_saccades(person, &random, habits, seconds);
    }
    plan_blinks(person, &random, habits, seconds);
    return 1;
}

void gw_person_finish(gw_person *person) {
    free(person->walk);
    free(person->saccades);
    free(person->blinks);
    *person = (gw_person){0};
}
