#include "wall/calibrate_collect.h"

#include <stdio.h>
#include <string.h>

/* "sensors 0, 2" of a recording's poses. */
static void list_sensors(const gw_recording *recording, char *text, size_t size) {
    uint64_t seen = 0;
    for (size_t i = 0; i < recording->count; i++) {
        const gw_tracking_event *event = &recording->events[i].event;
        if (event->kind == GW_EVENT_POSE && event->sensor >= 0 && event->sensor < 64)
            seen |= UINT64_C(1) << event->sensor;
    }
    size_t length = (size_t)snprintf(text, size, seen ? "sensors" : "no poses of sensors");
    for (int sensor = 0; sensor < 64 && length + 8 < size; sensor++)
        if (seen >> sensor & 1)
            length += (size_t)snprintf(text + length, size - length, " %d", sensor);
}

static void sample(const gw_recording *recording, int32_t sensor, const double times[2], double (*samples)[3],
                   gw_mark *out) {
    uint32_t count = 0;
    for (size_t i = 0; i < recording->count && count < GW_MARK_SAMPLES; i++) {
        const gw_tracking_event *event = &recording->events[i].event;
        const double at = (double)event->arrival * 1e-9;
        if (event->kind == GW_EVENT_POSE && event->sensor == sensor && event->quality >= 0 &&
            at >= times[0] && at <= times[1])
            memcpy(samples[count++], event->of.pose.position, sizeof samples[0]);
    }
    gw_mark_of(samples, count, out);
}

gw_code gw_marks_take_recording(gw_marks *marks, const gw_recording *recording, gw_error *error) {
    static double samples[GW_MARK_SAMPLES][3];
    char sensors[256];
    for (uint32_t i = 0; i < marks->count; i++) {
        if (marks->known[i])
            continue;
        const double *times = marks->times[i];
        if (!marks->timed[i])
            return gw_fail(error, GW_BAD_INPUT,
                           "mark '%s' has neither a 'device' position nor a 'time' in the recording %s",
                           marks->points[i].name, recording->name);
        sample(recording, marks->sensor, times, samples, &marks->samples[i]);
        if (marks->samples[i].count == 0) {
            list_sensors(recording, sensors, sizeof sensors);
            return gw_fail(error, GW_BAD_INPUT,
                           "mark '%s': %s has no position of sensor %d from %g to %g s; it has %s in %.3f s",
                           marks->points[i].name, recording->name, marks->sensor, times[0], times[1], sensors,
                           (double)recording->duration * 1e-9);
        }
        memcpy(marks->points[i].device, marks->samples[i].mean, sizeof marks->points[i].device);
        marks->known[i] = 1;
    }
    return GW_OK;
}
