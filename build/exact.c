#include "build/exact.h"

#include <math.h>
#include <stddef.h>

/* Shewchuk's bound for the sign of a 2x2 determinant of rounded differences: (3 + 16 eps) eps with eps =
 * 2^-53. */
static const double determinant_bound = 3.3306690738754716e-16;

enum { PRODUCTS = 6, TERMS = 2 * PRODUCTS };

/* Adds one term to a nonoverlapping expansion without error; returns its new length. */
static size_t expansion_add(double *expansion, size_t length, double term) {
    size_t kept = 0;
    for (size_t i = 0; i < length; i++) {
        double sum = term + expansion[i];
        double part = sum - term;
        double error = (term - (sum - part)) + (expansion[i] - part);
        if (error != 0.0)
            expansion[kept++] = error;
        term = sum;
    }
    if (term != 0.0)
        expansion[kept++] = term;
    return kept;
}

/* Twice the signed area of the projection is zero, exactly: the sum of six products, each as its rounded
 * value and its rounding error. */
static int projection_is_zero(const double a[3], const double b[3], const double c[3], int x, int y) {
    const double factors[PRODUCTS][2] = {{a[x], b[y]},  {-a[y], b[x]}, {b[x], c[y]},
                                         {-b[y], c[x]}, {c[x], a[y]},  {-c[y], a[x]}};
    double expansion[TERMS];
    size_t length = 0;
    for (size_t i = 0; i < PRODUCTS; i++) {
        double product = factors[i][0] * factors[i][1];
        length = expansion_add(expansion, length, fma(factors[i][0], factors[i][1], -product));
        length = expansion_add(expansion, length, product);
    }
    return length == 0;
}

/* The rounded determinant already proves that the points are not on one line. */
static int projection_surely_not_zero(const double a[3], const double b[3], const double c[3], int x, int y) {
    double left = (b[x] - a[x]) * (c[y] - a[y]);
    double right = (b[y] - a[y]) * (c[x] - a[x]);
    return fabs(left - right) > determinant_bound * (fabs(left) + fabs(right));
}

int gw_collinear(const double a_in[3], const double b_in[3], const double c_in[3]) {
    static const int axes[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    double a[3], b[3], c[3], largest = 0.0;
    for (int i = 0; i < 3; i++) {
        a[i] = a_in[i];
        b[i] = b_in[i];
        c[i] = c_in[i];
        largest = fmax(largest, fmax(fabs(a[i]), fmax(fabs(b[i]), fabs(c[i]))));
    }
    if (largest == 0.0)
        return 1;
    if (largest > 1e100 || largest < 1e-100) { /* products would leave the range of double: scale, exactly */
        int exponent = -ilogb(largest);
        for (int i = 0; i < 3; i++) {
            a[i] = scalbn(a[i], exponent);
            b[i] = scalbn(b[i], exponent);
            c[i] = scalbn(c[i], exponent);
        }
    }
    for (int i = 0; i < 3; i++)
        if (projection_surely_not_zero(a, b, c, axes[i][0], axes[i][1]))
            return 0;
    for (int i = 0; i < 3; i++)
        if (!projection_is_zero(a, b, c, axes[i][0], axes[i][1]))
            return 0;
    return 1;
}
