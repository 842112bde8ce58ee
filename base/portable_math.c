#include "base/portable_math.h"

#include <math.h>

/* pi/2 in two parts: the first has 33 significant bits, so k * HALF_PI_HIGH is exact for |k| < 2^20. */
#define HALF_PI_HIGH 1.57079632673412561417e+00
#define HALF_PI_LOW 6.07710050650619224932e-11

/* Taylor series on |r| <= pi/4: the first omitted term is below 1e-19. */
static double sine_series(double r) {
    double s = r * r;
    double p = -1.0 / 121645100408832000.0; /* 1/19! */
    p = p * s + 1.0 / 355687428096000.0;
    p = p * s - 1.0 / 1307674368000.0;
    p = p * s + 1.0 / 6227020800.0;
    p = p * s - 1.0 / 39916800.0;
    p = p * s + 1.0 / 362880.0;
    p = p * s - 1.0 / 5040.0;
    p = p * s + 1.0 / 120.0;
    p = p * s - 1.0 / 6.0;
    return r + r * s * p;
}

static double cosine_series(double r) {
    double s = r * r;
    double p = 1.0 / 2432902008176640000.0; /* 1/20! */
    p = p * s - 1.0 / 6402373705728000.0;
    p = p * s + 1.0 / 20922789888000.0;
    p = p * s - 1.0 / 87178291200.0;
    p = p * s + 1.0 / 479001600.0;
    p = p * s - 1.0 / 3628800.0;
    p = p * s + 1.0 / 40320.0;
    p = p * s - 1.0 / 720.0;
    p = p * s + 1.0 / 24.0;
    p = p * s - 0.5;
    return 1.0 + s * p;
}

/* sin(radians + quarter * pi/2). */
static double sine_of_quarter(double radians, int quarter) {
    double k = floor(radians * (2.0 / GW_PI) + 0.5);
    double r = (radians - k * HALF_PI_HIGH) - k * HALF_PI_LOW;
    double phase = k + quarter;
    switch ((int)(phase - 4.0 * floor(phase / 4.0))) {
    case 0:
        return sine_series(r);
    case 1:
        return cosine_series(r);
    case 2:
        return -sine_series(r);
    default:
        return -cosine_series(r);
    }
}

double gw_sin(double radians) {
    return sine_of_quarter(radians, 0);
}

double gw_cos(double radians) {
    return sine_of_quarter(radians, 1);
}

/* Arc tangent on 0..1: three half-angle steps bring it below tan(pi/32), where the series converges at once.
 */
static double arc_tangent_unit(double t) {
    for (int i = 0; i < 3; i++)
        t = t / (1.0 + sqrt(1.0 + t * t));
    double s = t * t;
    double sum = 0.0;
    for (int i = 9; i >= 0; i--)
        sum = 1.0 / (2 * i + 1) - s * sum;
    return 8.0 * t * sum;
}

double gw_atan2(double y, double x) {
    double ax = x < 0.0 ? -x : x;
    double ay = y < 0.0 ? -y : y;
    if (ax == 0.0 && ay == 0.0)
        return 0.0;
    double angle = ay <= ax ? arc_tangent_unit(ay / ax) : GW_PI / 2.0 - arc_tangent_unit(ax / ay);
    if (x < 0.0)
        angle = GW_PI - angle;
    return y < 0.0 ? -angle : angle;
}

double gw_acos(double cosine) {
    double c = cosine < -1.0 ? -1.0 : cosine > 1.0 ? 1.0 : cosine;
    return 2.0 * gw_atan2(sqrt(1.0 - c), sqrt(1.0 + c));
}

double gw_exp2(double exponent) {
    const double ln2 = 0.69314718055994530942, whole = floor(exponent + 0.5), x = (exponent - whole) * ln2;
    double sum = 1;
    for (int i = 15; i > 0; i--)
        sum = 1 + sum * x / i; /* Taylor's series; |x| <= 0.35 */
    return ldexp(sum, (int)whole);
}
