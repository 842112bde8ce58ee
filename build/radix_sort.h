/* Stable sort of numbers with 64-bit keys, in linear time. Any thread. */
#ifndef GW_BUILD_RADIX_SORT_H
#define GW_BUILD_RADIX_SORT_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_keyed {
    uint64_t key;
    uint32_t value;
} gw_keyed;

/* Rising keys; equal keys keep their order. */
gw_code gw_radix_sort(gw_keyed *entries, size_t count, gw_error *error);

#endif
