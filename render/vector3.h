/* Three doubles as a vector: what view, gaze and rates compute with on the host. Plain values; any thread. */
#ifndef GW_RENDER_VECTOR3_H
#define GW_RENDER_VECTOR3_H

#include <math.h>

static inline double gw_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double gw_length(const double v[3]) {
    return sqrt(gw_dot(v, v));
}

static inline void gw_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Makes v a unit vector; 0, and v as it was, when its length is not finite or not above `least`. */
static inline int gw_normalise(double v[3], double least) {
    double length = sqrt(gw_dot(v, v));
    if (!(length > least) || !isfinite(length))
        return 0;
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
    return 1;
}

#endif
