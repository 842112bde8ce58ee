/* Finds equal records: the base of welding positions and of merging vertices. Any thread. */
#ifndef GW_BUILD_WELD_H
#define GW_BUILD_WELD_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* records: count rows of `words` 32-bit words. ids[i] becomes the number of the row's content, numbered 0..
 * in order of first occurrence; *unique_count the number of different rows. */
gw_code gw_weld(const uint32_t *records, size_t count, size_t words, uint32_t *ids, uint32_t *unique_count,
                gw_error *error);

#endif
