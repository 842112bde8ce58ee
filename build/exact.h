/* Exact geometric predicates on double coordinates. Any thread. */
#ifndef GW_BUILD_EXACT_H
#define GW_BUILD_EXACT_H

/* 1 when the three finite points lie on one line (equal points included), decided without rounding error. */
int gw_collinear(const double a[3], const double b[3], const double c[3]);

#endif
