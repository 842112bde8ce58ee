#include "tracking/vrpn_log.h"

#include "base/memory.h"
#include "tracking/big_endian.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    COOKIE_SIZE = 24,
    HEADER_SIZE = 24,
    POSE_SIZE = 64,
    PAYLOAD_LIMIT = 64000, /* VRPN's own limit of a message body */
    MAJOR_OLDEST = 4,
    MAJOR_NEWEST = 7
};

#define POSE_TYPE "vrpn_Tracker Pos_Quat"

size_t gw_vrpn_log_begin(const uint8_t *data, size_t size) {
    static const char prefix[] = "vrpn: ver. ";
    const size_t digits = sizeof prefix - 1;
    if (size < COOKIE_SIZE || memcmp(data, prefix, digits) != 0)
        return 0;
    const uint8_t *version =
        data + digits; /* "07.38": the peers compare up to the last dot, the major version */
    if (version[0] < '0' || version[0] > '9' || version[1] < '0' || version[1] > '9' || version[2] != '.')
        return 0;
    int major = (version[0] - '0') * 10 + (version[1] - '0');
    return major >= MAJOR_OLDEST && major <= MAJOR_NEWEST ? COOKIE_SIZE : 0;
}

int gw_vrpn_log_next(const uint8_t *data, size_t size, size_t *offset, gw_vrpn_record *out) {
    size_t left = size - *offset;
    if (left == 0)
        return 0;
    if (left < HEADER_SIZE)
        return -1;
    const uint8_t *header = data + *offset;
    int32_t payload_size = gw_get_int32(header + 16);
    if (payload_size < 0 || payload_size > PAYLOAD_LIMIT || (size_t)payload_size > left - HEADER_SIZE)
        return -1;
    out->type = gw_get_int32(header);
    out->sender = gw_get_int32(header + 4);
    /* Seconds and microseconds are 32 bits each, so the sum cannot overflow, whatever they say. */
    out->time = (int64_t)gw_get_int32(header + 8) * 1000000000 + (int64_t)gw_get_int32(header + 12) * 1000;
    out->payload = header + HEADER_SIZE;
    out->payload_size = (size_t)payload_size;
    *offset += HEADER_SIZE + (size_t)payload_size;
    return 1;
}

/* The writer: one buffer of exactly known size, filled from front to back. */

static size_t description_size(const char *name) {
    return HEADER_SIZE + 4 + strlen(name) + 1;
}

static uint8_t *put_header(uint8_t *bytes, int32_t type, int32_t sender, int64_t microseconds,
                           size_t payload) {
    bytes = gw_put_int32(bytes, type);
    bytes = gw_put_int32(bytes, sender);
    bytes = gw_put_int32(bytes, (int32_t)(microseconds / 1000000));
    bytes = gw_put_int32(bytes, (int32_t)(microseconds % 1000000));
    bytes = gw_put_int32(bytes, (int32_t)payload);
    return gw_put_int32(bytes, 0);
}

static uint8_t *put_description(uint8_t *bytes, int32_t kind, int32_t id, int64_t microseconds,
                                const char *name) {
    size_t length = strlen(name) + 1;
    bytes = put_header(bytes, kind, id, microseconds, 4 + length);
    bytes = gw_put_int32(bytes, (int32_t)length);
    memcpy(bytes, name, length);
    return bytes + length;
}

static uint8_t *put_pose(uint8_t *bytes, int64_t microseconds, const gw_pose_report *report, double unit) {
    bytes = put_header(bytes, 0, 0, microseconds, POSE_SIZE);
    bytes = gw_put_int32(bytes, report->sensor);
    bytes = gw_put_int32(bytes, 0);
    for (int i = 0; i < 3; i++)
        bytes = gw_put_double(bytes, report->position[i] / unit);
    for (int i = 0; i < 4; i++)
        bytes = gw_put_double(bytes, report->orientation[i]);
    return bytes;
}

static gw_code check_times(const char *path, const gw_track *track, int64_t start, gw_error *error) {
    const int64_t limit = INT32_MAX; /* seconds are a signed 32-bit field */
    int64_t before = 0;
    for (size_t i = 0; i < track->report_count; i++) {
        int64_t time = track->reports[i].time;
        if (time < before || start < 0 || start > limit || time / 1000000000 > limit - start - 1)
            return gw_fail(error, GW_BAD_INPUT,
                           "%s: report %zu of the track is at %lld ns after Unix second %lld, but times must "
                           "rise from 0 "
                           "and end before second 2147483647",
                           path, i, (long long)time, (long long)start);
        before = time;
    }
    return GW_OK;
}

gw_code gw_vrpn_log_write(const char *path, const gw_track *track, double unit, int64_t start,
                          gw_error *error) {
    if (!(unit > 0.0 && isfinite(unit)))
        return gw_fail(error, GW_BAD_INPUT, "%s: the unit of the file must be more than 0 mm, not %g", path,
                       unit);
    gw_code code = check_times(path, track, start, error);
    if (code != GW_OK)
        return code;
    const char *sender = track->sender[0] != '\0' ? track->sender : "Tracker0";
    size_t size = COOKIE_SIZE + description_size(sender) + description_size(POSE_TYPE);
    if (track->report_count > (SIZE_MAX - size) / (HEADER_SIZE + POSE_SIZE))
        return gw_fail(error, GW_MACHINE, "%s: a track of %zu reports does not fit in memory", path,
                       track->report_count);
    size += track->report_count * (HEADER_SIZE + POSE_SIZE);

    void *memory = NULL;
    code = gw_allocate(&memory, size, 1, "VRPN log", error);
    if (code != GW_OK)
        return code;
    uint8_t *bytes = memory;
    memcpy(bytes, "vrpn: ver. 07.38  0", 19); /* the remaining five bytes of the cookie are zero */
    bytes += COOKIE_SIZE;
    bytes = put_description(bytes, -1, 0, start * 1000000, sender);
    bytes = put_description(bytes, -2, 0, start * 1000000, POSE_TYPE);
    for (size_t i = 0; i < track->report_count; i++) {
        int64_t microseconds = start * 1000000 + (track->reports[i].time + 500) / 1000;
        bytes = put_pose(bytes, microseconds, &track->reports[i], unit);
    }
    code = gw_file_write(path, memory, size, error);
    free(memory);
    return code;
}
