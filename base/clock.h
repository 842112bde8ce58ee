/* Clocks, nanoseconds. Any thread. */
#ifndef GW_BASE_CLOCK_H
#define GW_BASE_CLOCK_H

#include <stdint.h>

int64_t gw_now_ns(void);       /* monotonic */
int64_t gw_unix_ns(void);      /* since 1970; people and time servers set it, also back */
int64_t gw_processor_ns(void); /* spent by all threads of this process */

#endif
