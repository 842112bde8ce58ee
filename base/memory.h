/* Checked memory: sizes are multiplied with overflow checks, growth is geometric, failure is an error value.
 * Any thread may call these. Memory is released with free(). */
#ifndef GW_BASE_MEMORY_H
#define GW_BASE_MEMORY_H

#include "base/status.h"

#include <stddef.h>

/* Zeroed array of count elements; *out is NULL for count 0. what names it in the error ("triangle indices").
 */
gw_code gw_allocate(void **out, size_t count, size_t element_size, const char *what, gw_error *error);

/* Makes room for at least `needed` elements in *array, which has *capacity; old contents are kept, new memory
 * is not cleared. */
gw_code gw_grow(void **array, size_t *capacity, size_t needed, size_t element_size, const char *what,
                gw_error *error);

/* Copy of a string, or NULL when memory is out. */
char *gw_copy_text(const char *text);

#endif
