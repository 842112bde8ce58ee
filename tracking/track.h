/* Tracks: recordings of trackers, and what they say at a moment.
 *
 * A track is a VRPN log file (docs/tracks.md): Pos_Quat reports of up to four viewers, each with a head
 * sensor and, if there is one, a gaze sensor whose orientation is the gaze (its -z axis). Poses are in wall
 * space: millimetres, right-handed, the viewer looks along -z at the wall, y up. Reading is hostile-safe:
 * every length is bounded, unknown records are counted and skipped. Read-only after loading; any thread may
 * sample it. */
#ifndef GW_TRACKING_TRACK_H
#define GW_TRACKING_TRACK_H

#include "base/log.h"
#include "base/status.h"

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
    int64_t time; /* ns since the track's first report */
    int32_t sensor;
    double position[3];
    double orientation[4];
} gw_pose_report;

/* What was read, and what was skipped by reason; nothing is dropped in silence:
 * records = poses + descriptions + other_type + ... + not_finite. */
typedef struct gw_track_counters {
    uint64_t records;        /* all records of the file */
    uint64_t poses;          /* used: they are gw_track.reports */
    uint64_t descriptions;   /* of senders and types, connection records, the end mark */
    uint64_t other_type;     /* described, but no pose: buttons, pings, velocities, ... */
    uint64_t unknown_type;   /* a type that was not described before, or an unknown system record */
    uint64_t other_sender;   /* a pose of a device that was not asked for */
    uint64_t unknown_sender; /* a pose of a sender that was not described before */
    uint64_t bad_payload;  /* a pose not of 64 bytes; a description without a proper name or with an id out of
                              range */
    uint64_t bad_sensor;   /* a pose of a sensor beyond those of the viewers */
    uint64_t not_finite;   /* not a pose: NaN, infinite, beyond 1000 km, or a zero quaternion */
    uint64_t out_of_order; /* used, but earlier than the one before it in the file */
} gw_track_counters;

typedef struct gw_track {
    char *name; /* the file, or "demo" */
    size_t report_count;
    gw_pose_report *reports; /* by rising time */
    int64_t duration;        /* ns, of the last report */
    char sender[96];         /* VRPN sender whose sensors these are */
    gw_track_counters counters;
    /* For each sensor, the indices of its reports, rising. */
    size_t sensor_count[GW_TRACK_SENSORS];
    size_t *sensor_reports[GW_TRACK_SENSORS];
} gw_track;

typedef struct gw_track_options {
    double unit;        /* mm per unit of the file; VRPN's convention is metres: 1000 (0 means 1000) */
    const char *sender; /* NULL: the first sender that reports poses */
    const gw_log *log;
} gw_track_options;

/* Reads a VRPN log. GW_BAD_INPUT names the file and the byte offset. */
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

/* Head and gaze of one viewer at a moment; ages say how old the reports behind them are. */
typedef struct gw_track_sample {
    int has_head, has_gaze;
    double eye[3];              /* mm */
    double head_right[3];       /* unit, wall space: from the left eye to the right one */
    double gaze_direction[3];   /* unit, wall space */
    int64_t head_age, gaze_age; /* ns between the moment and the sensor's last report at or before it; before
                                   its first one, between the moment and that */
    double confidence; /* 0..1, of the older of both ages: 1 up to 0.1 s, falling to 0 at 0.5 s without
                          reports */
} gw_track_sample;

/* Of viewer 0 to GW_TRACK_VIEWERS - 1. Interpolates (position linear, orientation slerp on the shorter way)
 * between the reports around time (ns, clamped to the track). A gaze sensor's orientation turns (0,0,-1) onto
 * the gaze. The eye is the head sensor's position. */
void gw_track_at(const gw_track *track, uint32_t viewer, int64_t time, gw_track_sample *out);

#endif
