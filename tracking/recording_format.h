/* What readers and writers of recordings share: names and sizes of the records of a VRPN log
 * (docs/tracks.md), columns of the CSV form. Internal to tracking/recording*.c. */
#ifndef GW_TRACKING_RECORDING_FORMAT_H
#define GW_TRACKING_RECORDING_FORMAT_H

#include "tracking/vrpn_message.h"

enum {
    GW_LOG_COOKIE = GW_VRPN_COOKIE,
    GW_LOG_HEADER = 24,
    GW_LOG_PAYLOAD = GW_VRPN_PAYLOAD,
    GW_LOG_IDS = GW_VRPN_IDS
};

/* What a described type is to us; 0: not described. */
typedef enum gw_log_type {
    GW_LOG_UNKNOWN,
    GW_LOG_OTHER,
    GW_LOG_POSE,
    GW_LOG_BUTTON,
    GW_LOG_BUTTONS,
    GW_LOG_ANALOGS,
    GW_LOG_TEXT,
    /* Our own; other readers pass over them. */
    GW_LOG_STAMP,
    GW_LOG_GAZE,
    GW_LOG_LINK,
    GW_LOG_UNTRACKED,
    GW_LOG_END,
    GW_LOG_TYPES
} gw_log_type;

enum {
    GW_POSE_SIZE = GW_VRPN_POSE,
    GW_BUTTON_SIZE = GW_VRPN_BUTTON,
    GW_TEXT_SIZE = GW_VRPN_TEXT,
    GW_STAMP_SIZE = 32,
    GW_GAZE_SIZE = 64,
    GW_LINK_SIZE = 4,
    GW_UNTRACKED_SIZE = 4,
    GW_ANALOG_LIMIT = GW_VRPN_CHANNELS,
    GW_BUTTON_LIMIT = 256
};

/* Flags of a gaze record. */
enum { GW_GAZE_FLAG_HEAD = 1, GW_GAZE_FLAG_ORIGIN = 2 };

/* By gw_log_type; NULL where there is no name. */
extern const char *const gw_log_type_names[GW_LOG_TYPES];

/* Columns of CSV in the order in which we write them. */
typedef enum gw_csv_column {
    GW_CSV_ARRIVAL,
    GW_CSV_SENDER,
    GW_CSV_KIND,
    GW_CSV_SENSOR,
    GW_CSV_DEVICE,
    GW_CSV_LATENCY,
    GW_CSV_QUALITY,
    GW_CSV_X,
    GW_CSV_Y,
    GW_CSV_Z,
    GW_CSV_QX,
    GW_CSV_QY,
    GW_CSV_QZ,
    GW_CSV_QW,
    GW_CSV_DX,
    GW_CSV_DY,
    GW_CSV_DZ,
    GW_CSV_OPENNESS,
    GW_CSV_FRAME,
    GW_CSV_VALUE,
    GW_CSV_COLUMNS
} gw_csv_column;

extern const char *const gw_csv_columns[GW_CSV_COLUMNS];
/* Words of the column "kind", by gw_tracking_event_kind. */
extern const char *const gw_csv_kinds[5];

#endif
