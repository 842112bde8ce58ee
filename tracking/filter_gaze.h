/* What an eye does, from the directions in which it looks: fixations and pursuit, in which a One-Euro filter
 * may steady the gaze, and saccades, in which it is dropped, because it would trail behind by many degrees,
 * and in which the gaze counts as uncertain by what the saccade still has to go. A value; one thread at a
 * time; the same bits on every machine. */
#ifndef GW_TRACKING_FILTER_GAZE_H
#define GW_TRACKING_FILTER_GAZE_H

#include "tracking/one_euro.h"

#include <stdint.h>

enum {
    GW_GAZE_RING = 128, /* samples; more than 80 ms up to 1500 a second */
    GW_GAZE_SPANS = 3   /* over which it looks for saccades: 10, 20 and 40 ms */
};

typedef struct gw_gaze_tuning {
    int filtered;         /* 0: directions pass as they are */
    gw_one_euro one_euro; /* growth in Hz per deg/s */
    double saccade_speed; /* deg/s from which a gaze is a saccade, or 4 times its usual speed; 0: no search */
    double widening_limit; /* deg */
} gw_gaze_tuning;

typedef struct gw_gaze_filter {
    gw_gaze_tuning tuning;
    int started;
    double at[3]; /* unit: filtered */
    double delay; /* s, group delay now */
    double speed; /* deg/s, over the newest 10 ms against those before, or of the last two samples */
    double slow;  /* deg/s, as One-Euro's cutoff sees it */
    double usual[GW_GAZE_SPANS]; /* deg/s, about the median of speeds over each span: noise, mostly */
    double drift[3];      /* 1/s: how the gaze moves between saccades, about the mean of the last 0.2 s */
    int64_t ended;        /* ns: the last saccade; 0: none yet */
    int in_saccade;       /* since the sample at `since` */
    int span;             /* the shortest over which it was seen */
    int64_t since;        /* ns */
    double from[3], peak; /* where it began; deg/s */
    uint32_t saccades;    /* how many were seen to begin */
    uint32_t count;       /* of samples in the ring, in all */
    struct {
        int64_t time;
        double direction[3];
    } ring[GW_GAZE_RING];
} gw_gaze_filter;

void gw_gaze_filter_begin(gw_gaze_filter *filter, const gw_gaze_tuning *tuning);
/* What was told does not go with what comes: what comes next is no saccade from there. */
void gw_gaze_filter_restart(gw_gaze_filter *filter);
/* A direction of any length but 0 at a time (ns); one that is not finite, has no length or is not newer than
 * the one before is left out: 0. After a gap of more than 0.2 s nothing is known of what came before. */
int gw_gaze_filter_take(gw_gaze_filter *filter, const double direction[3], int64_t time);

/* Degrees by which the gaze may be elsewhere `late` seconds after the newest sample because of a saccade that
 * goes on; 0 when none does. The main sequence says how far it will go: a saccade of A degrees reaches
 * 110 sqrt(A) deg/s (P. Lebedev, P. Van Gelder, W. H. Tsui: Square-root relations between main saccadic
 * parameters, 1996; within a fifth of A. T. Bahill, M. R. Clark, L. Stark: The main sequence, 1975, from 2 to
 * 30 degrees), and takes 21 ms and 2.2 ms a degree (R. H. S. Carpenter: Movements of the Eyes, 1988). */
double gw_gaze_filter_widening(const gw_gaze_filter *filter, double late);

/* Where the gaze is so many seconds later if it goes on as it does between saccades: pursuit is smooth and
 * lasts, where a saccade leads cannot be known (P. Lebedev and others as above; C. H. Meyer, A. G. Lasker, D.
 * A. Robinson: The upper limit of human smooth pursuit velocity, 1985). In a saccade, where it is. A unit
 * vector. */
void gw_gaze_filter_predict(const gw_gaze_filter *filter, double seconds, double out[3]);

/* Places in the ring of the newest directions, the oldest first: of the last `span` ns, since the last
 * saccade ended, at most `most`. None in a saccade. How many. */
uint32_t gw_gaze_filter_recent(const gw_gaze_filter *filter, int64_t span, uint32_t most, uint32_t *places);

/* Degrees between two unit vectors. */
double gw_degrees_between(const double a[3], const double b[3]);

#endif
