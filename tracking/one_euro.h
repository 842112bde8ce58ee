/* The One-Euro filter's two formulas (G. Casiez, N. Roussel, D. Vogel: 1 Euro Filter: A Simple Speed-based
 * Low-pass Filter for Noisy Input in Interactive Systems, CHI 2012): a low-pass of first order whose cutoff
 * rises with speed, so that what rests is steady and what moves is not late. Values; any thread; the same
 * bits on every machine. */
#ifndef GW_TRACKING_ONE_EURO_H
#define GW_TRACKING_ONE_EURO_H

typedef struct gw_one_euro {
    double cutoff; /* Hz, of what rests; above 0 */
    double growth; /* Hz per unit of speed (the paper's beta) */
} gw_one_euro;

enum { GW_SPEED_CUTOFF = 1 }; /* Hz, of the speed that steers the cutoff, as in the paper */

/* Seconds by which a low-pass of this cutoff is late: 1 / (2 pi f). It is also the group delay at rest and at
 * even speed of the sampled filter, whatever its rate: (1 - a) / a * dt for the weight a below. */
static inline double gw_low_pass_delay(double cutoff) {
    return 0.15915494309189535 / cutoff;
}

/* Weight of the newest sample, dt seconds after the one before: 1 / (1 + delay / dt). */
static inline double gw_low_pass_weight(double cutoff, double dt) {
    return dt / (dt + gw_low_pass_delay(cutoff));
}

static inline double gw_one_euro_cutoff(const gw_one_euro *tuning, double speed) {
    return tuning->cutoff + tuning->growth * speed;
}

#endif
