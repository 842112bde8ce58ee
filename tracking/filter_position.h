/* Filters of a position: none, One-Euro, or a Kalman filter of constant velocity. Samples may come unevenly:
 * each brings the seconds since the one before. All know how fast what they follow moves, for prediction, and
 * how late they are. A value; one thread at a time; the same bits on every machine. */
#ifndef GW_TRACKING_FILTER_POSITION_H
#define GW_TRACKING_FILTER_POSITION_H

#include "tracking/one_euro.h"

typedef enum gw_filter_kind {
    GW_FILTER_KIND_NONE,
    GW_FILTER_KIND_ONE_EURO,
    GW_FILTER_KIND_KALMAN
} gw_filter_kind;

typedef struct gw_position_tuning {
    gw_filter_kind kind;
    gw_one_euro one_euro; /* growth in Hz per mm/s */
    double noise;         /* mm, standard deviation of a sample along an axis: Kalman */
    double acceleration;  /* mm/s^2, usual of what moves: Kalman */
} gw_position_tuning;

typedef struct gw_position_filter {
    gw_position_tuning tuning;
    int started;
    double last[3];     /* mm, the newest sample as it came */
    double at[3];       /* mm, filtered */
    double velocity[3]; /* mm/s */
    double slow[3];     /* mm/s, as One-Euro's cutoff sees it */
    double delay;       /* s, group delay now */
    /* Covariance of (place, velocity) along each axis, alike for all three: mm^2, mm^2/s, mm^2/s^2. */
    double place_variance, covariance, velocity_variance;
} gw_position_filter;

/* Nothing is known of what came before. */
void gw_position_filter_begin(gw_position_filter *filter, const gw_position_tuning *tuning);
/* dt: seconds since the sample before, brought into 1e-4 to 10; not used by the first sample. A sample that
 * is not finite is left out: 0. */
int gw_position_filter_take(gw_position_filter *filter, const double sample[3], double dt);

/* Seconds since the sample before, as all filters take them. */
static inline double gw_filter_step(double dt) {
    return dt > 1e-4 ? (dt < 10 ? dt : 10) : 1e-4;
}

#endif
