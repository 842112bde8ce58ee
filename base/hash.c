#include "base/hash.h"

#include <stdio.h>
#include <xxhash.h>

/* Little-endian whatever the host, so that a hash in a report means the same everywhere. */
static void put_word(uint8_t *bytes, uint64_t word) {
    for (int i = 0; i < 8; i++) {
        bytes[i] = (uint8_t)(word >> (8 * i));
    }
}

gw_hash gw_hash_bytes(gw_hash before, const void *data, size_t size) {
    /* The block's own hash, its size and what came before are hashed together; so "ab","c" and "a","bc"
     * differ. */
    XXH128_hash_t block = XXH3_128bits(data, size);
    uint8_t words[40];
    put_word(words, before.high);
    put_word(words + 8, before.low);
    put_word(words + 16, block.high64);
    put_word(words + 24, block.low64);
    put_word(words + 32, size);
    XXH128_hash_t chained = XXH3_128bits(words, sizeof words);
    return (gw_hash){.high = chained.high64, .low = chained.low64};
}

int gw_hash_equal(gw_hash a, gw_hash b) {
    return a.high == b.high && a.low == b.low;
}

void gw_hash_text(gw_hash hash, char text[33]) {
    snprintf(text, 33, "%016llx%016llx", (unsigned long long)hash.high, (unsigned long long)hash.low);
}
