#include "build/weld.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { EMPTY_SLOT = 0 }; /* slots hold row + 1 */

static uint64_t record_hash(const uint32_t *record, size_t words) {
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (size_t i = 0; i < words; i++) {
        hash = (hash ^ record[i]) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

gw_code gw_weld(const uint32_t *records, size_t count, size_t words, uint32_t *ids, uint32_t *unique_count,
                gw_error *error) {
    *unique_count = 0;
    if (count >= UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT, "%zu vertices are more than the %u that a scene can hold", count,
                       UINT32_MAX - 1);
    size_t slots = 16;
    while (slots < 2 * count)
        slots *= 2;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, slots, sizeof(uint32_t), "weld table", error);
    if (code != GW_OK)
        return code;
    uint32_t *table = memory;
    uint32_t unique = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *record = records + i * words;
        size_t slot = (size_t)record_hash(record, words) & (slots - 1);
        while (table[slot] != EMPTY_SLOT &&
               memcmp(records + (size_t)(table[slot] - 1) * words, record, words * sizeof *record) != 0)
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == EMPTY_SLOT) {
            table[slot] = (uint32_t)i + 1;
            ids[i] = unique++;
        } else {
            ids[i] = ids[table[slot] - 1];
        }
    }
    free(table);
    *unique_count = unique;
    return GW_OK;
}
