#include "build/demo_parts.h"

#include <math.h>

uint32_t demo_hash(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t h = a * 0x9e3779b1u ^ (b * 0x85ebca77u + 0x27d4eb2fu) ^ (c * 0xc2b2ae3du + 0x165667b1u);
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

double demo_random(uint32_t *state) {
    *state += 1;
    return (demo_hash(*state, *state >> 16, 77u) >> 8) * (1.0 / 16777216.0);
}

/* 0 <= result < 1; the row's part of the hash is mixed once for two columns. */
static double lattice(uint32_t column, uint32_t row) {
    uint32_t h = (column * 0x9e3779b1u) ^ row;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    return (h ^ h >> 14) * (1.0 / 4294967296.0);
}

double demo_noise(double x, double y, uint32_t period, uint32_t seed) {
    double fx = floor(x), fy = floor(y), s = x - fx, t = y - fy;
    /* No texture has as many periods to the left of its origin as are added here; it keeps the remainder
     * positive. */
    uint32_t x0 = ((uint32_t)(int32_t)fx + 64u * period) % period, x1 = x0 + 1 == period ? 0 : x0 + 1;
    uint32_t y0 = ((uint32_t)(int32_t)fy + 64u * period) % period, y1 = y0 + 1 == period ? 0 : y0 + 1;
    uint32_t low = demo_hash(y0, seed, 1), high = demo_hash(y1, seed, 1);
    s = s * s * (3.0 - 2.0 * s);
    t = t * t * (3.0 - 2.0 * t);
    double a = lattice(x0, low), b = lattice(x1, low), c = lattice(x0, high), d = lattice(x1, high);
    return (a + (b - a) * s) * (1.0 - t) + (c + (d - c) * s) * t;
}

double demo_fractal(double x, double y, uint32_t period, int octaves, uint32_t seed) {
    double sum = 0.0, weight = 0.5, total = 0.0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * demo_noise(x, y, period, seed + (uint32_t)i);
        total += weight;
        x *= 2.0;
        y *= 2.0;
        period *= 2;
        weight *= 0.5;
    }
    return sum / total;
}
