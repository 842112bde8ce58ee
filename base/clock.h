/* One monotonic clock, nanoseconds. Any thread. */
#ifndef GW_BASE_CLOCK_H
#define GW_BASE_CLOCK_H

#include <stdint.h>

int64_t gw_now_ns(void); /* CLOCK_MONOTONIC */

#endif
