/* How a person moves: where the head is, where the eyes look, when they blink. All functions of time are
 * smooth and exactly reproducible. */
#ifndef GW_TRACKING_GENERATOR_MOTION_H
#define GW_TRACKING_GENERATOR_MOTION_H

#include <stddef.h>
#include <stdint.h>

/* Random numbers that are the same everywhere (SplitMix64, Steele et al. 2014). */
typedef struct gw_random {
    uint64_t state;
} gw_random;

double gw_random_between(gw_random *random, double low, double high);
/* Mean 0, standard deviation 1, never beyond 6: the sum of twelve uniform ones. */
double gw_random_normal(gw_random *random);

/* 0 to 1 with no velocity and acceleration at either end: minimum jerk (Flash, Hogan 1985). */
double gw_minimum_jerk(double t);

/* Degrees per second at the fastest moment of a saccade: 551 (1 - exp(-A / 14)) (Baloh et al. 1975, Neurology
 * 25, 1065; the main sequence of Bahill et al. 1975, Mathematical Biosciences 24, 191). */
double gw_saccade_peak(double degrees);
/* Seconds that a saccade of this amplitude takes along a path of minimum jerk, whose peak is 1.875 A / D.
 * From 2 to 20 degrees within 20 % of the 37 ms + 2.7 ms per degree that Baloh et al. measured. */
double gw_saccade_duration(double degrees);

enum { GW_WAVES = 12, GW_MOVES = 4096 };

/* Noise whose power falls as 1 / frequency: waves an equal step of pitch apart have equal amplitudes. */
typedef struct gw_wander {
    double frequency[GW_WAVES], phase[GW_WAVES], amplitude;
} gw_wander;

/* A step of something along a path of minimum jerk; later steps add to earlier ones. */
typedef struct gw_move {
    double start, duration; /* s */
    double way[3];
} gw_move;

typedef struct gw_person {
    double place[3];    /* m: where the head is on average at first */
    double looks_at[2]; /* m on the wall, at first */
    gw_wander sway[3], drift[2];
    gw_move *walk, *saccades; /* owned: gw_person_finish frees them */
    size_t walk_count, saccade_count;
    gw_move *blinks; /* start and duration of being shut */
    size_t blink_count;
    double pursuit[2], pursuit_turn[2]; /* m, radians per s: what the eyes follow, if they follow */
} gw_person;

typedef struct gw_person_habits {
    double place[3];
    int walks, pursues;
    double sway;           /* 1: standing still */
    double fixation[2];    /* s: shortest and longest rest of the eyes between saccades */
    double amplitude[2];   /* degrees: smallest and largest saccade */
    double blink_every[2]; /* s */
} gw_person_habits;

/* Returns 0 when memory is out. */
int gw_person_init(gw_person *person, const gw_person_habits *habits, uint64_t seed, double seconds);
void gw_person_finish(gw_person *person);

/* The middle between the eyes, m; the head's orientation. */
void gw_person_head(const gw_person *person, double time, double position[3], double orientation[4]);
/* Where the eyes look, a unit vector from that place, and how far they are open. */
void gw_person_gaze(const gw_person *person, double time, double direction[3], double *openness);

#endif
