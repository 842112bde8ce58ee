/* A One-Euro filter of orientations. q and -q are one orientation and both arrive, so samples are compared by
 * the turn that leads from one to the other, on its shorter way; a turn of 180 degrees has two, of which it
 * takes one. A value; one thread at a time; the same bits on every machine. */
#ifndef GW_TRACKING_FILTER_TURN_H
#define GW_TRACKING_FILTER_TURN_H

#include "tracking/one_euro.h"

typedef struct gw_turn_tuning {
    int filtered;         /* 0: orientations pass as they are */
    gw_one_euro one_euro; /* growth in Hz per rad/s */
} gw_turn_tuning;

typedef struct gw_turn_filter {
    gw_turn_tuning tuning;
    int started;
    double last[4];     /* unit quaternion x, y, z, w: the newest sample as it came */
    double at[4];       /* filtered */
    double velocity[3]; /* rad/s, about the sensor's own axes */
    double slow[3];     /* as One-Euro's cutoff sees it */
    double delay;       /* s, group delay now */
} gw_turn_filter;

void gw_turn_filter_begin(gw_turn_filter *filter, const gw_turn_tuning *tuning);
/* Any length but 0; one that is not finite or has none is left out: 0. dt as gw_position_filter_take(). */
int gw_turn_filter_take(gw_turn_filter *filter, const double sample[4], double dt);

/* The rotation vector (axis times radians, 0 to pi) of a unit quaternion, and back. */
void gw_turn_to_vector(const double q[4], double out[3]);
void gw_turn_from_vector(const double vector[3], double out[4]);
/* The rotation vector, told in the axes of `from`, that leads to `to`; and what it leads to. */
void gw_turn_between(const double from[4], const double to[4], double out[3]);
void gw_turn_on(const double from[4], const double vector[3], double out[4]);

#endif
