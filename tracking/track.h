/* Tracks: the heads and gazes of a recording (tracking/recording.h) by the plain convention of
 * docs/tracks.md.
 *
 * Of one device: poses of up to four viewers, each with a head sensor and, if there is one, a gaze sensor
 * whose orientation is the gaze (its -z axis), or gaze events. Poses are in wall space: millimetres,
 * right-handed, the viewer looks along -z at the wall, y up. Read-only after loading; any thread may sample
 * it. */
#ifndef GW_TRACKING_TRACK_H
#define GW_TRACKING_TRACK_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/recording.h"

#include <stddef.h>
#include <stdint.h>

/* Sensors of viewer v: 2 v is the head, 2 v + 1 the gaze. */
enum {
    GW_SENSOR_HEAD = 0,
    GW_SENSOR_GAZE = 1,
    GW_TRACK_VIEWERS = 4,
    GW_TRACK_SENSORS = 2 * GW_TRACK_VIEWERS
};

/* One report of one sensor. Position in mm (wall space), orientation as unit quaternion x, y, z, w. */
typedef struct gw_pose_report {
    int64_t time; /* ns since the recording's first event */
    int32_t sensor;
    double position[3];
    double orientation[4];
} gw_pose_report;

/* What became of the recording's events and records; nothing is dropped in silence. */
typedef struct gw_track_counters {
    gw_recording_counters file; /* what the file held */
    uint64_t poses;             /* used: they are gw_track.reports */
    uint64_t other_kind;        /* buttons, analogs, links */
    uint64_t other_sender;      /* of a device that was not asked for */
    uint64_t other_sensor;      /* beyond those of the viewers */
    uint64_t untracked;         /* the device said that it did not see the sensor: silence */
    uint64_t too_far;           /* beyond 1000 km: another unit */
    uint64_t reordered;         /* by its device's clock older than the one before it, by less than 1 s */
} gw_track_counters;

typedef struct gw_track {
    char *name; /* the file, or "demo" */
    size_t report_count;
    gw_pose_report *reports;     /* by rising time, which is the arrival */
    int64_t duration;            /* ns, of the last report */
    char sender[GW_SENDER_NAME]; /* device whose sensors these are */
    char damage[320];            /* where the file stops making sense and why; "" when it is whole */
    gw_track_counters counters;
    /* For each sensor, the indices of its reports, rising. */
    size_t sensor_count[GW_TRACK_SENSORS];
    size_t *sensor_reports[GW_TRACK_SENSORS];
} gw_track;

typedef struct gw_track_options {
    double unit;        /* mm per unit of the file; VRPN's convention is metres: 1000 (0 means 1000) */
    const char *sender; /* NULL: the first that reports a usable head or gaze */
    const gw_log *log;
} gw_track_options;

/* GW_BAD_INPUT when no head and no gaze is in it. A damaged recording is used up to the damage, with a
 * warning. */
gw_code gw_track_of(const gw_recording *recording, const gw_track_options *options, gw_track **out,
                    gw_error *error);
/* Reads a recording and makes a track of it. */
gw_code gw_track_load(const char *path, const gw_track_options *options, gw_track **out, gw_error *error);
gw_code gw_track_parse(const void *data, size_t size, const char *name, const gw_track_options *options,
                       gw_track **out, gw_error *error);
/* The embedded demo track: a viewer in front of a wall of width x height mm centred on (0,0,0); the gaze
 * crosses tile borders. It is read from configs/tracks/demo.vrpn, embedded, by the same reader, then fitted
 * to the wall: it was recorded in front of one of 2000 x 1125 mm, so positions are scaled by width/2000 and
 * height/1125 (depth by their geometric mean), and a gaze that met the recorded wall at a point meets this
 * one at the corresponding point. */
gw_code gw_track_demo(double width, double height, gw_track **out, gw_error *error);
void gw_track_destroy(gw_track **track);

#endif
