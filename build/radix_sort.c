#include "build/radix_sort.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { DIGIT_BITS = 16, DIGITS = 1 << DIGIT_BITS };

/* One pass over one digit. */
static void sort_digit(const gw_keyed *from, gw_keyed *to, size_t count, int shift, size_t *histogram) {
    memset(histogram, 0, DIGITS * sizeof *histogram);
    for (size_t i = 0; i < count; i++)
        histogram[from[i].key >> shift & (DIGITS - 1)]++;
    size_t begin = 0;
    for (size_t digit = 0; digit < DIGITS; digit++) {
        const size_t size = histogram[digit];
        histogram[digit] = begin;
        begin += size;
    }
    for (size_t i = 0; i < count; i++)
        to[histogram[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
}

gw_code gw_radix_sort(gw_keyed *entries, size_t count, gw_error *error) {
    gw_keyed *spare = NULL;
    size_t *histogram = NULL;
    gw_code code = gw_allocate((void **)&spare, count, sizeof *spare, "sorting", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&histogram, DIGITS, sizeof *histogram, "sorting", error);
    for (int shift = 0; code == GW_OK && shift < 64; shift += 2 * DIGIT_BITS) { /* there and back */
        sort_digit(entries, spare, count, shift, histogram);
        sort_digit(spare, entries, count, shift + DIGIT_BITS, histogram);
    }
    free(spare);
    free(histogram);
    return code;
}
