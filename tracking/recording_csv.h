/* Rows of recordings as CSV. Internal to tracking/recording*.c; the reader is gw_recording_read_csv. */
#ifndef GW_TRACKING_RECORDING_CSV_H
#define GW_TRACKING_RECORDING_CSV_H

#include "tracking/event.h"
#include "tracking/recording_format.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_CSV_ROW = 1024 }; /* bytes that hold any row */

/* Both write a line with its line feed and return its length; the thread must be in the C locale. time: ns
 * since 1970 of the arrival. */
size_t gw_csv_put_head(char row[GW_CSV_ROW]);
size_t gw_csv_put_event(char row[GW_CSV_ROW], const char *sender, int64_t time,
                        const gw_tracking_event *event);

#endif
