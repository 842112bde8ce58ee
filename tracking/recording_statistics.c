#include "tracking/recording_statistics.h"

#include "base/memory.h"
#include "base/portable_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t STEP = 500000000; /* ns that two clocks never move apart from one event to the next */
static const int64_t REORDER = 1000000000;
static const int64_t GAP = 50000000;

/* The events of one channel, as indices of the recording's. */
typedef struct list {
    const gw_recorded_event *events;
    const size_t *indices;
    size_t count;
} list;

static const gw_tracking_event *event_of(const list *l, size_t i) {
    return &l->events[l->indices[i]].event;
}

static int compare_channels(const gw_recorded_event *a, const gw_recorded_event *b) {
    if (a->sender != b->sender)
        return a->sender < b->sender ? -1 : 1;
    if (a->event.kind != b->event.kind)
        return a->event.kind < b->event.kind ? -1 : 1;
    return (a->event.sensor > b->event.sensor) - (a->event.sensor < b->event.sensor);
}

/* By channel, then by order of arrival. */
static int compare_indices(const void *a, const void *b, void *events) {
    const size_t i = *(const size_t *)a, j = *(const size_t *)b;
    const gw_recorded_event *all = events;
    const int order = compare_channels(&all[i], &all[j]);
    return order != 0 ? order : (i > j) - (i < j);
}

static int compare_times(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static int64_t quantile(int64_t *sorted, size_t count, double part) {
    return count > 0 ? sorted[(size_t)(part * (double)(count - 1) + 0.5)] : 0;
}

static int is_gap(int64_t interval, int64_t median) {
    return interval > GAP && interval / 3 > median;
}

static void measure_intervals(const list *l, int64_t *spare, gw_recording_channel *c) {
    const size_t count = l->count - 1;
    c->first = event_of(l, 0)->arrival;
    c->last = event_of(l, count)->arrival;
    c->rate = c->last > c->first ? (double)count / ((double)(c->last - c->first) * 1e-9) : 0.0;
    for (size_t i = 0; i < count; i++) {
        spare[i] = event_of(l, i + 1)->arrival - event_of(l, i)->arrival;
        if (spare[i] > c->interval_longest) {
            c->interval_longest = spare[i];
            c->longest_at = event_of(l, i)->arrival;
        }
    }
    qsort(spare, count, sizeof *spare, compare_times);
    c->interval_median = count > 0 ? spare[(count - 1) / 2] : 0;
    c->interval_95 = quantile(spare, count, 0.95);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const int64_t off = spare[i] - c->interval_median;
        if (is_gap(spare[i], c->interval_median)) {
            c->gaps++;
            c->absent += off;
        } else {
            spare[kept++] = off < 0 ? -off : off;
        }
    }
    qsort(spare, kept, sizeof *spare, compare_times);
    c->jitter = quantile(spare, kept, 0.95);
}

static int same_numbers(const gw_tracking_event *a, const gw_tracking_event *b) {
    if (a->kind == GW_EVENT_POSE)
        return memcmp(&a->of.pose, &b->of.pose, sizeof a->of.pose) == 0;
    if (a->kind == GW_EVENT_GAZE)
        return memcmp(a->of.gaze.direction, b->of.gaze.direction, sizeof a->of.gaze.direction) == 0 &&
               memcmp(a->of.gaze.origin, b->of.gaze.origin, sizeof a->of.gaze.origin) == 0;
    return 0;
}

/* Offset, drift and spread of the device's clock against arrivals; times relative to the first event. */
static void measure_clock(const gw_recording *recording, const list *l, int64_t *spare,
                          gw_recording_channel *c) {
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
    size_t count = 0;
    int64_t base = 0, offset = 0, newest = 0, smallest = 0;
    for (size_t i = 0; i < l->count; i++) {
        const gw_tracking_event *event = event_of(l, i);
        if (event->device_time == GW_NO_TIME)
            continue;
        const int64_t away = recording->start + event->arrival - event->device_time;
        if (count == 0) {
            base = smallest = away;
            newest = event->device_time;
        } else {
            const int64_t behind = newest - event->device_time;
            c->clock_steps += away - offset > STEP || offset - away > STEP;
            c->reordered += behind > 0 && behind < REORDER;
            c->duplicates += i > 0 && event->device_time == event_of(l, i - 1)->device_time &&
                             same_numbers(event, event_of(l, i - 1));
            newest = behind > 0 && behind < REORDER ? newest : event->device_time;
        }
        offset = away;
        smallest = away < smallest ? away : smallest;
        const double x = (double)(event->arrival - c->first) * 1e-9, y = (double)(away - base) * 1e-9;
        sum_x += x;
        sum_y += y;
        sum_xx += x * x;
        sum_xy += x * y;
        count++;
    }
    c->has_clock = count > 0;
    if (count == 0)
        return;
    c->clock_offset = (double)smallest * 1e-9;
    const double n = (double)count, spread = n * sum_xx - sum_x * sum_x;
    if (c->clock_steps > 0 || count < 10 || !(spread > 0))
        return; /* a slope over a step would mean nothing */
    c->has_drift = 1;
    c->clock_drift = (n * sum_xy - sum_x * sum_y) / spread;
    size_t kept = 0;
    for (size_t i = 0; i < l->count; i++) {
        const gw_tracking_event *event = event_of(l, i);
        if (event->device_time == GW_NO_TIME)
            continue;
        const int64_t away = recording->start + event->arrival - event->device_time - base;
        spare[kept++] = away - (int64_t)(c->clock_drift * (double)(event->arrival - c->first));
    }
    qsort(spare, kept, sizeof *spare, compare_times);
    c->clock_spread = (double)(quantile(spare, kept, 0.95) - spare[0]) * 1e-9;
}

/* Degrees between two unit vectors; exact near zero, where the arc cosine is not. */
static double degrees_between(const double a[3], const double b[3]) {
    double cross = 0.0, dot = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double part = a[j] * b[k] - a[k] * b[j];
        cross += part * part;
        dot += a[i] * b[i];
    }
    return gw_atan2(sqrt(cross), dot) * (180.0 / GW_PI);
}

double gw_recorded_speed(const gw_tracking_event *before, const gw_tracking_event *now) {
    const int device = before->device_time != GW_NO_TIME && now->device_time != GW_NO_TIME;
    const double seconds =
        1e-9 * (double)(device ? now->device_time - before->device_time : now->arrival - before->arrival);
    double way = 0.0;
    if (!(seconds > 0.0))
        return 0.0;
    if (now->kind == GW_EVENT_GAZE)
        return degrees_between(before->of.gaze.direction, now->of.gaze.direction) / seconds;
    for (int i = 0; i < 3; i++) {
        const double step = now->of.pose.position[i] - before->of.pose.position[i];
        way += step * step;
    }
    return sqrt(way) / seconds;
}

static void measure_motion(const list *l, double limit, gw_recording_channel *c) {
    const gw_tracking_event *before = NULL;
    for (size_t i = 0; i < l->count; i++) {
        const gw_tracking_event *event = event_of(l, i);
        if (event->quality < 0.0) {
            c->untracked++;
            continue;
        }
        for (int axis = 0; axis < 3 && event->kind == GW_EVENT_POSE; axis++) {
            const double at = event->of.pose.position[axis];
            c->low[axis] = before == NULL || at < c->low[axis] ? at : c->low[axis];
            c->high[axis] = before == NULL || at > c->high[axis] ? at : c->high[axis];
        }
        const double speed = before != NULL ? gw_recorded_speed(before, event) : 0.0;
        c->jumps += speed > limit;
        if (speed > c->speed_largest) {
            c->speed_largest = speed;
            c->speed_largest_at = event->arrival;
        }
        before = event;
    }
}

static void measure_values(const list *l, gw_recording_channel *c) {
    for (size_t i = 0; i < l->count; i++) {
        const gw_tracking_event *event = event_of(l, i);
        if (event->kind == GW_EVENT_BUTTON) {
            c->presses += event->of.button.pressed && (i == 0 || !event_of(l, i - 1)->of.button.pressed);
        } else if (event->kind == GW_EVENT_ANALOG) {
            const double value = event->of.analog.value;
            c->value_low = i == 0 || value < c->value_low ? value : c->value_low;
            c->value_high = i == 0 || value > c->value_high ? value : c->value_high;
        }
    }
}

static void measure(const gw_recording *recording, const list *l, double speed_limit, double gaze_limit,
                    int64_t *spare, gw_recording_channel *c) {
    const gw_recorded_event *first = &l->events[l->indices[0]];
    *c = (gw_recording_channel){.sender = first->sender,
                                .kind = first->event.kind,
                                .sensor = first->event.sensor,
                                .events = l->count};
    measure_intervals(l, spare, c);
    measure_clock(recording, l, spare, c);
    if (c->kind == GW_EVENT_POSE || c->kind == GW_EVENT_GAZE)
        measure_motion(l, c->kind == GW_EVENT_POSE ? speed_limit : gaze_limit, c);
    else
        measure_values(l, c);
}

gw_code gw_recording_measure(const gw_recording *recording, double speed_limit, double gaze_limit,
                             gw_recording_statistics *out, gw_error *error) {
    void *memory[3] = {NULL, NULL, NULL};
    *out = (gw_recording_statistics){0};
    gw_code code = gw_allocate(&memory[0], recording->count, sizeof(size_t), "order of events", error);
    if (code == GW_OK)
        code = gw_allocate(&memory[1], recording->count, sizeof(int64_t), "times of events", error);
    if (code == GW_OK)
        code = gw_allocate(&memory[2], GW_RECORDING_CHANNELS, sizeof *out->channels, "sensors", error);
    if (code != GW_OK) {
        for (int i = 0; i < 3; i++)
            free(memory[i]);
        return code;
    }
    size_t *indices = memory[0];
    out->channels = memory[2];
    for (size_t i = 0; i < recording->count; i++)
        indices[i] = i;
    if (recording->count > 0)
        qsort_r(indices, recording->count, sizeof *indices, compare_indices, recording->events);
    for (size_t from = 0, to; from < recording->count; from = to) {
        for (to = from + 1; to < recording->count; to++)
            if (compare_channels(&recording->events[indices[from]], &recording->events[indices[to]]) != 0)
                break;
        const list l = {.events = recording->events, .indices = indices + from, .count = to - from};
        if (out->channel_count < GW_RECORDING_CHANNELS)
            measure(recording, &l, speed_limit, gaze_limit, memory[1], &out->channels[out->channel_count++]);
        else
            out->left_out += l.count;
    }
    free(memory[0]);
    free(memory[1]);
    return GW_OK;
}

void gw_recording_statistics_finish(gw_recording_statistics *statistics) {
    free(statistics->channels);
    *statistics = (gw_recording_statistics){0};
}
