/* From a device's clock to ours. Messages carry the time at which the sender stamped them and the time at
 * which they arrived here; their difference is the clocks' offset plus the time on the way. The offset is
 * estimated as the least difference over a window of some seconds (D. L. Mills, RFC 5905, section 10, "clock
 * filter": the sample of least delay is the best), so a delay that every message has cannot be told from an
 * offset and is not seen, while all that comes on top of it is.
 *
 * Slow drift is followed: as the window slides when the device's clock loses, at once when it gains. A clock
 * that is set anew is found, counted, and its window begun again. A value; any thread; integers only. */
#ifndef GW_TRACKING_CLOCK_OFFSET_H
#define GW_TRACKING_CLOCK_OFFSET_H

#include <stdint.h>

enum { GW_CLOCK_BUCKETS = 16 };
#define GW_CLOCK_BUCKET INT64_C(250000000) /* ns: the window is 4 s */
#define GW_CLOCK_STEP INT64_C(100000000)   /* ns: smaller differences are delays, not steps */

typedef enum gw_clock_verdict {
    GW_CLOCK_STEADY,
    GW_CLOCK_STEPPED /* this stamp is of a clock that was set anew; older stamps mean nothing beside it */
} gw_clock_verdict;

typedef struct gw_clock_offset {
    int started;
    int64_t begun;                   /* arrival of the window's first stamp */
    int64_t bucket;                  /* number of the newest: arrival / GW_CLOCK_BUCKET */
    int64_t least[GW_CLOCK_BUCKETS]; /* of arrival - stamp; INT64_MAX: none */
    int64_t offset;                  /* add it to a stamp to have it on our clock */
    uint32_t count;                  /* stamps since `begun` */
    /* Stamps that all came later than GW_CLOCK_STEP: a clock set back, if it lasts. */
    uint32_t late_count;
    int64_t late_since, late_least;
    uint32_t steps;    /* how often the clock was found to be set anew */
    int64_t last_step; /* ns, by how much the device's clock was put forward then, below 0: back */
} gw_clock_offset;

/* Times of any size are heeded; those beyond 4e18 ns (126 years) are brought to that. */
gw_clock_verdict gw_clock_offset_take(gw_clock_offset *clock, int64_t arrival, int64_t stamp);
/* The clock was seen to be set anew at this stamp, by other signs than how late it is (stamps of one sensor
 * that run backwards together). */
void gw_clock_offset_restart(gw_clock_offset *clock, int64_t arrival, int64_t stamp);
/* How much longer than the fastest of its window this stamp was on its way, ns, from 0. */
int64_t gw_clock_offset_delay(const gw_clock_offset *clock, int64_t arrival, int64_t stamp);

#endif
