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

double demo_noise(double x, double y, uint32_t period, uint32_t seed) {
    double fx = floor(x), fy = floor(y);
    int64_t ix = (int64_t)fx, iy = (int64_t)fy, n = period;
    uint32_t x0 = (uint32_t)(((ix % n) + n) % n), y0 = (uint32_t)(((iy % n) + n) % n);
    uint32_t x1 = x0 + 1 == period ? 0 : x0 + 1, y1 = y0 + 1 == period ? 0 : y0 + 1;
    double s = x - fx, t = y - fy;
    s = s * s * (3.0 - 2.0 * s);
    t = t * t * (3.0 - 2.0 * t);
    const double unit = 1.0 / 4294967296.0;
    double a = demo_hash(x0, y0, seed) * unit, b = demo_hash(x1, y0, seed) * unit;
    double c = demo_hash(x0, y1, seed) * unit, d = demo_hash(x1, y1, seed) * unit;
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
