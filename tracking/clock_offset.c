#include "tracking/clock_offset.h"

static const int64_t LATEST = INT64_C(4000000000000000000); /* so that differences of two stay in range */

/* What is needed to call something a step: so much of a window before it, and so many late stamps over so
 * long. */
static const int64_t SETTLED = INT64_C(500000000), LASTING = INT64_C(500000000);
enum { SETTLED_COUNT = 4, LASTING_COUNT = 3 };

static int64_t bounded(int64_t time) {
    return time > LATEST ? LATEST : time < -LATEST ? -LATEST : time;
}

/* a - b, brought into the range of times. */
static int64_t minus(int64_t a, int64_t b) {
    if (b < 0 ? a > INT64_MAX + b : a < INT64_MIN + b)
        return b < 0 ? INT64_MAX : INT64_MIN;
    return a - b;
}

static void begin(gw_clock_offset *clock, int64_t arrival, int64_t difference) {
    for (int i = 0; i < GW_CLOCK_BUCKETS; i++)
        clock->least[i] = INT64_MAX;
    clock->started = 1;
    clock->begun = arrival;
    clock->bucket = arrival / GW_CLOCK_BUCKET;
    clock->least[(uint64_t)clock->bucket % GW_CLOCK_BUCKETS] = difference;
    clock->offset = difference;
    clock->count = 1;
    clock->late_count = 0;
}

static void step(gw_clock_offset *clock, int64_t arrival, int64_t difference) {
    clock->steps++;
    clock->last_step = minus(clock->offset, difference);
    begin(clock, arrival, difference);
}

void gw_clock_offset_restart(gw_clock_offset *clock, int64_t arrival, int64_t stamp) {
    step(clock, bounded(arrival), bounded(arrival) - bounded(stamp));
}

/* Makes the bucket of this arrival the newest; what falls out of the window is forgotten. */
static void slide(gw_clock_offset *clock, int64_t arrival) {
    const int64_t bucket = arrival / GW_CLOCK_BUCKET;
    if (bucket <= clock->bucket)
        return;
    const int64_t new_buckets = bucket - clock->bucket;
    for (int64_t i = 1; i <= new_buckets && i <= GW_CLOCK_BUCKETS; i++)
        clock->least[(uint64_t)(clock->bucket + i) % GW_CLOCK_BUCKETS] = INT64_MAX;
    clock->bucket = bucket;
}

/* 1 when late stamps have lasted long enough to be a clock that was set back. */
static int lasts(gw_clock_offset *clock, int64_t arrival, int64_t difference) {
    if (difference <= clock->offset + GW_CLOCK_STEP) {
        clock->late_count = 0;
        return 0;
    }
    if (clock->late_count++ == 0) {
        clock->late_since = arrival;
        clock->late_least = difference;
    }
    if (difference < clock->late_least)
        clock->late_least = difference;
    return clock->late_count >= LASTING_COUNT && arrival - clock->late_since >= LASTING;
}

gw_clock_verdict gw_clock_offset_take(gw_clock_offset *clock, int64_t arrival, int64_t stamp) {
    arrival = bounded(arrival);
    const int64_t difference = arrival - bounded(stamp);
    if (!clock->started) {
        begin(clock, arrival, difference);
        return GW_CLOCK_STEADY;
    }
    const int settled = clock->count >= SETTLED_COUNT && arrival - clock->begun >= SETTLED;
    if (settled && difference < clock->offset - GW_CLOCK_STEP) {
        step(clock, arrival, difference);
        return GW_CLOCK_STEPPED;
    }
    if (lasts(clock, arrival, difference)) {
        step(clock, arrival, clock->late_least);
        return GW_CLOCK_STEPPED;
    }
    slide(clock, arrival);
    int64_t *newest = &clock->least[(uint64_t)clock->bucket % GW_CLOCK_BUCKETS];
    if (difference < *newest)
        *newest = difference;
    /* A late stamp that has the window for itself does not speak for the clock. */
    int64_t least = INT64_MAX;
    for (int i = 0; i < GW_CLOCK_BUCKETS; i++)
        least = clock->least[i] < least ? clock->least[i] : least;
    if (least <= clock->offset + GW_CLOCK_STEP)
        clock->offset = least;
    clock->count += clock->count < UINT32_MAX;
    return GW_CLOCK_STEADY;
}

int64_t gw_clock_offset_delay(const gw_clock_offset *clock, int64_t arrival, int64_t stamp) {
    const int64_t delay = minus(bounded(arrival) - bounded(stamp), clock->offset);
    return delay > 0 ? delay : 0;
}
