/* Rows of 3 x 4: transforms of points in double precision, one expression each, so that every caller has the
 * same bits. Header only. */
#ifndef GW_BUILD_MATRIX_H
#define GW_BUILD_MATRIX_H

#include <math.h>

static inline void gw_matrix_multiply(const double a[3][4], const double b[3][4], double out[3][4]) {
    double product[3][4];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            product[i][k] =
                a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k] + (k == 3 ? a[i][3] : 0.0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            out[i][k] = product[i][k];
}

static inline double gw_matrix_determinant(const double m[3][4]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static inline void gw_matrix_point(const double m[3][4], const double p[3], double out[3]) {
    const double q[3] = {p[0], p[1], p[2]};
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * q[0] + m[i][1] * q[1] + m[i][2] * q[2] + m[i][3];
}

/* The matrix of cofactors, which carries normals also through scalings that differ by axis; turned over where
 * the transform mirrors. */
static inline void gw_matrix_cofactors(const double m[3][4], double out[3][3]) {
    const double sign = gw_matrix_determinant(m) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
            out[i][k] = sign * (m[a][c] * m[b][d] - m[a][d] * m[b][c]);
        }
}

/* A unit normal through cofactors; zero where there is none. */
static inline void gw_matrix_normal(const double cofactors[3][3], const float n[3], float out[3]) {
    double turned[3], length = 0.0;
    for (int i = 0; i < 3; i++) {
        turned[i] =
            cofactors[i][0] * (double)n[0] + cofactors[i][1] * (double)n[1] + cofactors[i][2] * (double)n[2];
        length += turned[i] * turned[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3; i++)
        out[i] = length > 0.0 ? (float)(turned[i] / length) : 0.0f;
}

#endif
