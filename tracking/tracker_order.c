/* Which samples are new, and when they were taken. */
#include "tracking/tracker_internal.h"

#include <string.h>

static const int64_t LATEST = GW_LATEST; /* ns; no time of a device lies beyond */
/* A delay that is longer than this is no delay but a clock that is about to be found set anew. */
static const int64_t LONGEST_DELAY = 1000000000;
/* Nor does a device spend longer before its stamp, added_latency included. */
static const int64_t LONGEST_TOLD = INT64_C(10000000000);

static int same_numbers(const gw_sample_order *order, const double numbers[GW_SAMPLE_NUMBERS]) {
    return memcmp(order->numbers, numbers, sizeof order->numbers) == 0;
}

/* A stamp behind the newest one is a packet that came late, and so may be the next; but two that rise, from
 * far behind, are a clock that was set back. Waiting until the clock is where it was would lose the sensor
 * for as long as it was set back. */
static int clock_was_set_back(const gw_sample_order *order, int64_t stamp) {
    return order->behind_known && stamp > order->behind && order->stamp - stamp >= GW_CLOCK_STEP;
}

static int stamp_is_new(gw_tracker *tracker, gw_source_clock *clock, gw_sample_order *order, int64_t arrival,
                        int64_t stamp, const double numbers[GW_SAMPLE_NUMBERS]) {
    if (order->known && order->epoch == clock->epoch) {
        if (stamp == order->stamp && same_numbers(order, numbers)) {
            tracker->counters.duplicated++;
            return 0;
        }
        if (stamp < order->stamp && !clock_was_set_back(order, stamp)) {
            order->behind_known = 1;
            order->behind = stamp;
            tracker->counters.reordered++;
            return 0;
        }
        if (stamp < order->stamp) {
            gw_clock_offset_restart(&clock->offset, arrival, stamp);
            clock->epoch++;
            tracker->counters.clock_steps++;
        }
    }
    if (gw_clock_offset_take(&clock->offset, arrival, stamp) == GW_CLOCK_STEPPED) {
        clock->epoch++;
        tracker->counters.clock_steps++;
    }
    return 1;
}

int gw_sample_is_new(gw_tracker *tracker, gw_source_clock *clock, gw_sample_order *order,
                     const gw_tracking_event *event, const double numbers[GW_SAMPLE_NUMBERS],
                     const gw_sensor_state *sensor, int64_t *time) {
    const int64_t arrival = event->arrival, stamp = event->device_time;
    const int stamped = stamp > -LATEST && stamp < LATEST;
    int64_t delay = 0;
    if (stamped) {
        if (!stamp_is_new(tracker, clock, order, arrival, stamp, numbers))
            return 0;
        delay = gw_clock_offset_delay(&clock->offset, arrival, stamp);
        delay = delay > LONGEST_DELAY ? 0 : delay;
    } else if (order->known && arrival == order->arrival && same_numbers(order, numbers)) {
        tracker->counters.duplicated++;
        return 0;
    }
    order->known = 1;
    order->epoch = clock->epoch;
    order->stamp = stamp;
    order->arrival = arrival;
    order->behind_known = 0;
    memcpy(order->numbers, numbers, sizeof order->numbers);
    const int64_t told = event->latency > LONGEST_TOLD ? 0 : gw_not_below_0(event->latency);
    *time = arrival - delay - told;
    /* A better estimate of the offset may put a sample before the one that was taken earlier. */
    if (sensor->heard && *time <= sensor->time)
        *time = sensor->time + 1;
    return 1;
}
