/* What every decoder is fed: each prefix of a good input, each single bit of it flipped, and seeded random
 * changes, each in a block of its exact size, so that a sanitizer sees a read beyond it. Header only. */
#ifndef GW_TESTS_SUPPORT_MANGLE_H
#define GW_TESTS_SUPPORT_MANGLE_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void (*mangle_reader)(const uint8_t *data, size_t size);

static inline void mangle_feed(mangle_reader read, const uint8_t *data, size_t size) {
    uint8_t *exact = calloc(size > 0 ? size : 1, 1);
    if (!exact)
        abort();
    if (size > 0)
        memcpy(exact, data, size);
    read(exact, size);
    free(exact);
}

static inline void mangle(mangle_reader read, const uint8_t *good, size_t size, int rounds) {
    uint8_t *bytes = malloc(size);
    uint64_t random = 20240611;
    if (!bytes)
        abort();
    for (size_t cut = 0; cut <= size; cut++)
        mangle_feed(read, good, cut);
    memcpy(bytes, good, size);
    for (size_t bit = 0; bit < 8 * size; bit++) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        mangle_feed(read, bytes, size);
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (int round = 0; round < rounds; round++) {
        memcpy(bytes, good, size);
        for (int change = 0; change < 1 + round % 7; change++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            const uint64_t value = random >> 24;
            bytes[(size_t)(value >> 8) % size] = (uint8_t)(value >> 3);
        }
        mangle_feed(read, bytes, round % 4 ? size : (size_t)(random >> 33) % (size + 1));
    }
    for (int round = 0; round < rounds; round++) {
        for (size_t i = 0; i < size; i++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            bytes[i] = (uint8_t)(random >> 40);
        }
        mangle_feed(read, bytes, size);
    }
    free(bytes);
}

#endif
