/* 128-bit content hashes (XXH3), for scenes, octrees, images and caches: not for secrets. Any thread. */
#ifndef GW_BASE_HASH_H
#define GW_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

typedef struct gw_hash {
    uint64_t high, low;
} gw_hash;

/* Hash of bytes, chained: pass the hash of what came before, or {0,0} to start. */
gw_hash gw_hash_bytes(gw_hash before, const void *data, size_t size);
int gw_hash_equal(gw_hash a, gw_hash b);
/* 32 hexadecimal digits and a zero byte. */
void gw_hash_text(gw_hash hash, char text[33]);

#endif
