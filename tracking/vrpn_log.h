/* VRPN log files byte by byte (reference implementation 07.38; records as docs/tracks.md lists them). A
 * cookie of 24 bytes, then records of six big-endian int32 {type, sender, seconds, microseconds, payload
 * length, 0} and the payload without padding. Negative types are system records: -1 sender description, -2
 * type description, others skipped. */
#ifndef GW_TRACKING_VRPN_LOG_H
#define GW_TRACKING_VRPN_LOG_H

#include "base/file.h"
#include "base/status.h"
#include "tracking/track.h"

/* Writes a track as a VRPN log (unit: mm per unit of the file, 1000 for metres), starting at Unix time
 * `start` seconds. */
gw_code gw_vrpn_log_write(const char *path, const gw_track *track, double unit, int64_t start,
                          gw_error *error);

/* Reads one record at *offset; advances it. Returns 1 for a record, 0 at the clean end, -1 when the rest is
 * cut or malformed (then *offset stays). */
typedef struct gw_vrpn_record {
    int32_t type, sender;
    int64_t time; /* ns since the Unix epoch */
    const uint8_t *payload;
    size_t payload_size; /* 0..64000 */
} gw_vrpn_record;
int gw_vrpn_log_next(const uint8_t *data, size_t size, size_t *offset, gw_vrpn_record *out);
/* Checks the cookie; returns the offset of the first record, 0 when this is no VRPN log of major version 4
 * to 7. */
size_t gw_vrpn_log_begin(const uint8_t *data, size_t size);

#endif
