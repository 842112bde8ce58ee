/* What a recording is worth: for each sensor its rate, gaps, jitter, jumps, the clock of its device. Any
 * thread. */
#ifndef GW_TRACKING_RECORDING_STATISTICS_H
#define GW_TRACKING_RECORDING_STATISTICS_H

#include "tracking/recording.h"

enum { GW_RECORDING_CHANNELS = 512 }; /* sensors, buttons and axes that are told apart; more are counted */

/* One sensor, button or axis of one device. Times are arrivals in ns, lengths in the recording's unit. */
typedef struct gw_recording_channel {
    uint32_t sender;
    gw_tracking_event_kind kind;
    int32_t sensor;
    uint64_t events;
    uint64_t untracked; /* of them: the device did not see the sensor */
    int64_t first, last;
    double rate; /* events per second between first and last */
    int64_t interval_median, interval_95, interval_longest, longest_at;
    uint64_t gaps;  /* intervals longer than three medians and 50 ms */
    int64_t absent; /* of all gaps together, what exceeds the median */
    int64_t jitter; /* 95 of 100 intervals that are no gap differ from the median by at most this */
    /* By the device's clock, where it has one. */
    uint64_t duplicates;  /* time and numbers of the one before */
    uint64_t reordered;   /* less than 1 s older than the newest */
    uint64_t clock_steps; /* arrival and device time moved apart by more than 0.5 s from one to the next */
    int has_clock, has_drift;
    double clock_offset; /* s, arrival - device time: the smallest, as that waited least */
    double clock_drift;  /* s per s: slope of arrival - device time over arrival, by least squares */
    double clock_spread; /* s: 95 of 100 arrive at most this later than the earliest did, drift taken out */
    /* Poses, and gazes as angles. */
    double low[3], high[3];
    double speed_largest; /* units per s, gazes: degrees per s */
    int64_t speed_largest_at;
    uint64_t jumps;               /* steps that are faster than the limit */
    uint64_t presses;             /* of a button */
    double value_low, value_high; /* of an axis */
} gw_recording_channel;

typedef struct gw_recording_statistics {
    uint32_t channel_count;
    gw_recording_channel *channels; /* by sender, kind, sensor */
    uint64_t left_out;              /* events of channels beyond GW_RECORDING_CHANNELS */
} gw_recording_statistics;

/* speed_limit: units per s (faster is a jump, no person moves so); gaze_limit: degrees per s. */
gw_code gw_recording_measure(const gw_recording *recording, double speed_limit, double gaze_limit,
                             gw_recording_statistics *out, gw_error *error);
void gw_recording_statistics_finish(gw_recording_statistics *statistics);

/* Speed from the pose or gaze `before` to `now` (another event of the channel), units or degrees per s; 0
 * when no time passed between them. The device's times count if both have them. */
double gw_recorded_speed(const gw_tracking_event *before, const gw_tracking_event *now);

#endif
