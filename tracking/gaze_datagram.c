#include "tracking/gaze_datagram.h"

#include "tracking/big_endian.h"

#include <math.h>
#include <string.h>

/* Offsets of the fields; docs/gaze-datagram.md. */
enum {
    AT_MAGIC = 0,
    AT_VERSION = 4,
    AT_FLAGS = 5,
    AT_SIZE = 6,
    AT_SEQUENCE = 8,
    AT_VIEWER = 12,
    AT_TIME = 16,
    AT_LATENCY = 24,
    AT_CONFIDENCE = 28,
    AT_ORIGIN = 32,
    AT_DIRECTION = 44,
    AT_OPENNESS = 56,
    AT_PUPIL = 60
};

enum {
    FLAG_HEAD = 1,      /* numbers are in the head's frame, else in the device's */
    FLAG_ORIGIN = 2,    /* the origin is told */
    FLAG_DIRECTION = 4, /* the direction is told: eyes are found */
    FLAG_OPENNESS = 8,
    FLAG_PUPIL = 16,
    FLAG_TIME = 32 /* the device's time is told */
};

enum { VERSION = 1 };
static const uint8_t magic[4] = {'G', 'W', 'G', 'Z'};
static const double FARTHEST = 1e6;                         /* m */
static const int64_t LATEST = INT64_C(4000000000000000000); /* ns, in the year 2096: sums stay in range */

static double get_float(const uint8_t *bytes) {
    const int32_t bits = gw_get_int32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static void put_float(uint8_t *bytes, double value) {
    const float rounded = (float)value;
    int32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    gw_put_int32(bytes, bits);
}

static int64_t get_int64(const uint8_t *bytes) {
    const uint64_t bits = (uint64_t)(uint32_t)gw_get_int32(bytes) << 32 | (uint32_t)gw_get_int32(bytes + 4);
    int64_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put_int64(uint8_t *bytes, int64_t value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++)
        bytes[i] = (uint8_t)(bits >> (56 - 8 * i));
}

/* 0 when one of the numbers is no place. */
static int get_origin(const uint8_t *data, double origin[3]) {
    for (int i = 0; i < 3; i++) {
        origin[i] = get_float(data + AT_ORIGIN + 4 * i);
        if (!(fabs(origin[i]) <= FARTHEST))
            return 0;
    }
    return 1;
}

static int get_direction(const uint8_t *data, double direction[3]) {
    double length = 0;
    for (int i = 0; i < 3; i++) {
        direction[i] = get_float(data + AT_DIRECTION + 4 * i);
        length += direction[i] * direction[i];
    }
    length = sqrt(length);
    if (!(length > 1e-3 && length < 1e6)) /* senders need not be exact about 1 */
        return 0;
    for (int i = 0; i < 3; i++)
        direction[i] /= length;
    return 1;
}

static int get_share(const uint8_t *bytes, double *out) {
    *out = get_float(bytes);
    return *out >= 0 && *out <= 1;
}

static gw_gaze_reading get_numbers(const uint8_t *data, gw_tracking_event *out, gw_gaze_extra *extra) {
    const int flags = data[AT_FLAGS];
    out->of.gaze.frame = flags & FLAG_HEAD ? GW_GAZE_IN_HEAD : GW_GAZE_IN_DEVICE;
    out->of.gaze.has_origin = (flags & FLAG_ORIGIN) != 0;
    out->of.gaze.openness = 1;
    if (out->device_time != GW_NO_TIME && !(out->device_time >= 0 && out->device_time < LATEST))
        return GW_GAZE_NOT_FINITE;
    if (!get_share(data + AT_CONFIDENCE, &out->quality) ||
        (out->of.gaze.has_origin && !get_origin(data, out->of.gaze.origin)) ||
        (flags & FLAG_OPENNESS && !get_share(data + AT_OPENNESS, &out->of.gaze.openness)))
        return GW_GAZE_NOT_FINITE;
    if (flags & FLAG_PUPIL) {
        extra->pupil = get_float(data + AT_PUPIL);
        if (!(extra->pupil > 0 && extra->pupil < 100))
            return GW_GAZE_NOT_FINITE;
    }
    if (!(flags & FLAG_DIRECTION)) {
        out->quality = -1;
        out->of.gaze.direction[2] = -1;
    } else if (!get_direction(data, out->of.gaze.direction))
        return GW_GAZE_NOT_FINITE;
    return GW_GAZE_READ;
}

gw_gaze_reading gw_gaze_datagram_read(const uint8_t *data, size_t size, gw_tracking_event *out,
                                      gw_gaze_extra *extra) {
    memset(out, 0, sizeof *out);
    memset(extra, 0, sizeof *extra);
    if (size < AT_SEQUENCE || memcmp(data + AT_MAGIC, magic, sizeof magic) != 0)
        return GW_GAZE_MALFORMED;
    if (data[AT_VERSION] != VERSION)
        return GW_GAZE_VERSION;
    /* Later revisions may append fields. */
    const size_t told = (size_t)(data[AT_SIZE] << 8 | data[AT_SIZE + 1]);
    if (told != size || size < GW_GAZE_DATAGRAM)
        return GW_GAZE_MALFORMED;
    out->kind = GW_EVENT_GAZE;
    out->sensor = data[AT_VIEWER] << 8 | data[AT_VIEWER + 1];
    out->device_time = data[AT_FLAGS] & FLAG_TIME ? get_int64(data + AT_TIME) : GW_NO_TIME;
    out->latency = (int64_t)(uint32_t)gw_get_int32(data + AT_LATENCY) * 1000;
    extra->sequence = (uint32_t)gw_get_int32(data + AT_SEQUENCE);
    return get_numbers(data, out, extra);
}

void gw_gaze_datagram_write(const gw_tracking_event *event, const gw_gaze_extra *extra, double unit,
                            uint8_t data[GW_GAZE_DATAGRAM]) {
    const int seen = event->quality >= 0, timed = event->device_time != GW_NO_TIME;
    memset(data, 0, GW_GAZE_DATAGRAM);
    memcpy(data + AT_MAGIC, magic, sizeof magic);
    data[AT_VERSION] = VERSION;
    data[AT_FLAGS] = (uint8_t)((event->of.gaze.frame == GW_GAZE_IN_HEAD ? FLAG_HEAD : 0) |
                               (event->of.gaze.has_origin ? FLAG_ORIGIN : 0) | (seen ? FLAG_DIRECTION : 0) |
                               FLAG_OPENNESS | (extra->pupil > 0 ? FLAG_PUPIL : 0) | (timed ? FLAG_TIME : 0));
    data[AT_SIZE + 1] = GW_GAZE_DATAGRAM;
    gw_put_int32(data + AT_SEQUENCE, (int32_t)extra->sequence);
    data[AT_VIEWER] = (uint8_t)(event->sensor >> 8);
    data[AT_VIEWER + 1] = (uint8_t)event->sensor;
    put_int64(data + AT_TIME, timed ? event->device_time : 0);
    gw_put_int32(data + AT_LATENCY, (int32_t)(uint32_t)(event->latency / 1000));
    put_float(data + AT_CONFIDENCE, seen ? event->quality : 0);
    for (int i = 0; i < 3; i++) {
        if (event->of.gaze.has_origin)
            put_float(data + AT_ORIGIN + 4 * i, event->of.gaze.origin[i] * unit);
        if (seen)
            put_float(data + AT_DIRECTION + 4 * i, event->of.gaze.direction[i]);
    }
    put_float(data + AT_OPENNESS, event->of.gaze.openness);
    put_float(data + AT_PUPIL, extra->pupil);
}
