#include "tracking/sensor_state.h"

#include <math.h>
#include <string.h>

const char *const gw_sensor_phase_names[GW_SENSOR_PHASES] = {"absent", "fresh", "held", "lost", "returned"};

static const int64_t UNKNOWN_PERIOD = 500000000; /* ns */

int64_t gw_sensor_hold(const gw_sensor_state *sensor, int64_t hold_time) {
    const int64_t hold = 3 * (sensor->period ? sensor->period : UNKNOWN_PERIOD);
    return hold > hold_time ? hold : hold_time;
}

static void note_period(gw_sensor_state *sensor, int64_t period) {
    const int64_t longest = 10 * INT64_C(1000000000);
    int64_t sorted[GW_SENSOR_PERIODS] = {0};
    sensor->periods[sensor->next_period] = period < longest ? period : longest;
    sensor->next_period = (sensor->next_period + 1) % GW_SENSOR_PERIODS;
    sensor->known_periods += sensor->known_periods < GW_SENSOR_PERIODS;
    const uint32_t kept = sensor->known_periods;
    for (uint32_t i = 0; i < kept; i++) {
        uint32_t at = i;
        for (; at > 0 && sorted[at - 1] > sensor->periods[i]; at--)
            sorted[at] = sorted[at - 1];
        sorted[at] = sensor->periods[i];
    }
    sensor->period = sorted[kept / 2];
}

int gw_sensor_take(gw_sensor_state *sensor, int64_t arrival, int64_t time, int64_t hold_time) {
    const int lost = sensor->heard && arrival > gw_sensor_lost_at(sensor, hold_time);
    if (sensor->since_return < UINT32_MAX)
        sensor->since_return++;
    if (sensor->heard)
        note_period(sensor, time - sensor->time);
    const int first = !sensor->heard;
    sensor->losses += lost ? 1 : 0;
    sensor->heard = 1;
    sensor->arrival = arrival;
    sensor->time = time;
    if (first || lost)
        gw_sensor_restart(sensor);
    return lost;
}

void gw_sensor_restart(gw_sensor_state *sensor) {
    sensor->returned = sensor->time;
    sensor->since_return = 0;
}

int64_t gw_sensor_lost_at(const gw_sensor_state *sensor, int64_t hold_time) {
    return sensor->arrival + gw_sensor_hold(sensor, hold_time);
}

gw_sensor_phase gw_sensor_phase_at(const gw_sensor_state *sensor, int64_t now, int64_t hold_time) {
    if (!sensor->heard)
        return GW_SENSOR_ABSENT;
    if (now > gw_sensor_lost_at(sensor, hold_time))
        return GW_SENSOR_LOST;
    /* Samples also come in bunches, so a quarter of the hold time is no silence at any rate. */
    const int64_t two_periods = 2 * gw_sensor_hold(sensor, 0) / 3;
    const int64_t fresh = two_periods > hold_time / 4 ? two_periods : hold_time / 4;
    return now - sensor->arrival <= fresh ? GW_SENSOR_FRESH : GW_SENSOR_HELD;
}

double gw_sensor_confidence(const gw_sensor_state *sensor, int64_t now, int64_t hold_time, int64_t fade) {
    if (!sensor->heard)
        return 0;
    const int64_t silent = now - gw_sensor_lost_at(sensor, hold_time);
    return silent <= 0 ? 1 : silent >= fade ? 0 : 1 - (double)silent / (double)fade;
}

int gw_glide_at(const gw_glide *glide, int64_t now, double speed, double out[3]) {
    const double *from = glide->from;
    const double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
    const double gone = speed * 1e-9 * (double)(now - glide->since);
    memset(out, 0, 3 * sizeof *out);
    if (!(gone < length))
        return 0;
    for (int i = 0; i < 3; i++)
        out[i] = gone > 0 ? from[i] * ((length - gone) / length) : from[i];
    return 1;
}
