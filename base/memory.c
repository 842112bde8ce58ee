#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_allocate(void **out, size_t count, size_t element_size, const char *what, gw_error *error) {
    *out = NULL;
    if (count == 0 || element_size == 0) {
        return GW_OK;
    }
    /* calloc checks the product; the message gives both factors because the product may not exist. */
    *out = calloc(count, element_size);
    if (!*out) {
        return gw_fail(error, GW_MACHINE, "not enough memory for %zu %s of %zu bytes each", count, what,
                       element_size);
    }
    return GW_OK;
}

gw_code gw_grow(void **array, size_t *capacity, size_t needed, size_t element_size, const char *what,
                gw_error *error) {
    if (needed <= *capacity) {
        return GW_OK;
    }
    size_t target = *capacity < 16 ? 16 : *capacity;
    while (target < needed) {
        if (target > SIZE_MAX / 2) {
            target = needed;
            break;
        }
        target += target / 2;
    }
    if (target < needed || target > SIZE_MAX / element_size) {
        return gw_fail(error, GW_MACHINE, "not enough memory for %zu %s of %zu bytes each", needed, what,
                       element_size);
    }
    void *grown = realloc(*array, target * element_size);
    if (!grown) {
        return gw_fail(error, GW_MACHINE, "not enough memory for %zu %s of %zu bytes each", target, what,
                       element_size);
    }
    *array = grown;
    *capacity = target;
    return GW_OK;
}

char *gw_copy_text(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy) {
        memcpy(copy, text, size);
    }
    return copy;
}
