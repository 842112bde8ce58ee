/* "Did you mean": the nearest known name to a mistyped one. Any thread. */
#ifndef GW_BASE_SUGGEST_H
#define GW_BASE_SUGGEST_H

#include <stddef.h>

/* Nearest of names[0..count) by edit distance, or NULL when nothing is close (distance above a third of the
 * word, at least 2). */
const char *gw_suggest(const char *word, const char *const *names, size_t count);

#endif
