/* Sine, cosine, arc tangent and powers of two with the same bits on every machine.
 *
 * libm's versions differ in the last bit between libraries and processors (variants with fused multiply-add
 * are chosen at run time); what is made by formula and hashed - the demo scene, the demo track - must not.
 * These use only
 * + - * / sqrt and floor in double, which IEEE 754 rounds exactly, and need -ffp-contract=off (the Makefile's
 * flag). Absolute error below 2e-16 for |x| up to 1e6 (sine, cosine), 2e-15 (arc tangent, arc cosine). Any
 * thread. */
#ifndef GW_BASE_PORTABLE_MATH_H
#define GW_BASE_PORTABLE_MATH_H

#define GW_PI 3.14159265358979323846

double gw_sin(double radians);
double gw_cos(double radians);
double gw_atan2(double y, double x); /* -pi..pi; 0 for (0, 0) */
double gw_exp2(double exponent);     /* relative error below 4e-16 for exponents within 1000 */
double gw_acos(double cosine);       /* 0..pi; arguments beyond -1..1 are clamped */

#endif
