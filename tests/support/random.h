/* Random numbers of property tests: the same for the same seed on every machine. Tests print their seed. */
#ifndef GW_TESTS_SUPPORT_RANDOM_H
#define GW_TESTS_SUPPORT_RANDOM_H

#include <stdint.h>

/* S. Vigna: splitmix64. */
static inline uint64_t random_bits(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* 0 to 1. */
static inline double random_unit(uint64_t *seed) {
    return (double)(random_bits(seed) >> 11) * 0x1p-53;
}

/* Nearly normal, of standard deviation 1: the sum of twelve. */
static inline double random_normal(uint64_t *seed) {
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += random_unit(seed);
    return sum;
}

#endif
