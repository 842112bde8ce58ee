/* Unit quaternions x, y, z, w as turns: q v q*, as VRPN has them. Values; any thread. Only + - * / and square
 * roots, so the same bits on every machine. */
#ifndef GW_TRACKING_QUATERNION_H
#define GW_TRACKING_QUATERNION_H

#include <math.h>

/* out = the turn `earlier` followed by the turn `later`; out may be either. */
static inline void gw_turn_after(const double later[4], const double earlier[4], double out[4]) {
    const double a = later[0], b = later[1], c = later[2], d = later[3];
    const double x = earlier[0], y = earlier[1], z = earlier[2], w = earlier[3];
    out[0] = d * x + a * w + b * z - c * y;
    out[1] = d * y - a * z + b * w + c * x;
    out[2] = d * z + a * y - b * x + c * w;
    out[3] = d * w - a * x - b * y - c * z;
}

/* out = v turned by q: v + 2 w (u x v) + 2 u x (u x v), with q = (u, w); out may be v. */
static inline void gw_turn_vector(const double q[4], const double v[3], double out[3]) {
    const double s = 2 * (q[1] * v[2] - q[2] * v[1]), t = 2 * (q[2] * v[0] - q[0] * v[2]),
                 r = 2 * (q[0] * v[1] - q[1] * v[0]);
    const double x = v[0], y = v[1], z = v[2];
    out[0] = x + q[3] * s + (q[1] * r - q[2] * t);
    out[1] = y + q[3] * t + (q[2] * s - q[0] * r);
    out[2] = z + q[3] * r + (q[0] * t - q[1] * s);
}

static inline void gw_turn_back(const double q[4], double out[4]) {
    out[0] = -q[0];
    out[1] = -q[1];
    out[2] = -q[2];
    out[3] = q[3];
}

/* To length 1. Returns 0, and leaves q alone, if it has no length or one that is no number. One of length 1
 * but for rounding keeps its bits: sent, recorded and read again it is the same. */
static inline int gw_turn_normalise(double q[4]) {
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], length = sqrt(square);
    if (fabs(square - 1) < 1e-15)
        return 1;
    if (!(length > 1e-9 && length < 1e150))
        return 0;
    for (int i = 0; i < 4; i++)
        q[i] /= length;
    return 1;
}

/* The shortest turn of (0, 0, -1), where a sensor that tells a gaze looks, onto a unit direction. */
static inline void gw_turn_onto(const double direction[3], double q[4]) {
    const double w = 1 - direction[2]; /* the half-way vector, not yet of length 1 */
    if (w < 1e-12) {                   /* straight back: a half turn about y */
        q[0] = q[2] = q[3] = 0;
        q[1] = 1;
        return;
    }
    const double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + w * w);
    q[0] = direction[1] / length;
    q[1] = -direction[0] / length;
    q[2] = 0;
    q[3] = w / length;
}

/* The turn that takes x, y and z to axes[0], [1] and [2], a right-handed set of unit vectors (Shepperd 1978:
 * the largest of the four numbers is found first, so nothing is divided by a small one). */
static inline void gw_turn_of_axes(double axes[3][3], double q[4]) {
    const double trace = axes[0][0] + axes[1][1] + axes[2][2];
    int largest = 3;
    double best = trace;
    for (int i = 0; i < 3; i++)
        if (axes[i][i] > best) {
            best = axes[i][i];
            largest = i;
        }
    const int i = largest % 3, j = (i + 1) % 3, k = (i + 2) % 3;
    if (largest == 3) {
        q[3] = 1 + trace;
        for (int c = 0; c < 3; c++)
            q[c] = axes[(c + 1) % 3][(c + 2) % 3] - axes[(c + 2) % 3][(c + 1) % 3];
    } else {
        q[i] = 1 + axes[i][i] - axes[j][j] - axes[k][k];
        q[j] = axes[i][j] + axes[j][i];
        q[k] = axes[i][k] + axes[k][i];
        q[3] = axes[j][k] - axes[k][j];
    }
    gw_turn_normalise(q);
}

#endif
