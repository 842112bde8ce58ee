/* How the trackers of a site are set up: which sources there are, where each stands in the room, and which of
 * their sensors are whose head and gaze. From the key `trackers` of a site file (docs/sites.md), or made from
 * the one source that `tracker:` or --track names. A plain value without pointers (it is part of gw_site and
 * travels as bytes). Any thread. */
#ifndef GW_TRACKING_SETUP_H
#define GW_TRACKING_SETUP_H

#include "tracking/room.h"
#include "tracking/track.h"

#include <stdint.h>

enum { GW_TRACKER_SOURCES = 4, GW_SOURCE_SPEC = 256 };

/* How a viewer's gaze is known. */
typedef enum gw_gaze_kind {
    GW_GAZE_KIND_NONE,   /* not at all: the viewer's eye counts, its gaze does not */
    GW_GAZE_KIND_HEAD,   /* where the head points, from the eye (sensor and eye offset) on */
    GW_GAZE_KIND_SENSOR, /* a sensor whose orientation turns (0, 0, -1) onto the gaze */
    GW_GAZE_KIND_EVENTS, /* gaze events, in the head's or the device's frame */
    GW_GAZE_KIND_ANY,    /* sensor or events, whichever reports: what a source without setup does */
    GW_GAZE_KINDS
} gw_gaze_kind;

typedef struct gw_tracker_source {
    char spec[GW_SOURCE_SPEC]; /* as gw_source_open takes it */
    char bind[64];             /* numeric address of the interface; "": all */
    gw_room room;
} gw_tracker_source;

typedef struct gw_tracker_viewer {
    int32_t source;      /* of the head sensor: index of a source */
    int32_t head_sensor; /* -1: none, the viewer stays at the neutral eye */
    int32_t gaze_source; /* of gaze sensor and gaze events: index of a source */
    int32_t gaze_sensor; /* -1: none (GW_GAZE_KIND_SENSOR, _ANY) */
    int32_t gaze_viewer; /* the number that gaze events give this viewer; -1: none (_EVENTS, _ANY) */
    uint32_t gaze;       /* gw_gaze_kind */
    /* Of a sensor that is mounted askew: turns the sensor's axes onto the head's (x right, y up, looking
     * along -z), told in the sensor's axes; the identity for one that is mounted straight. */
    double head_turn[4];
    double eye_offset[3]; /* mm, in the head's axes: from the head sensor to the middle between the eyes */
    double gaze_error;    /* degrees, what 95 of 100 gazes are off by at most; below 0: not said, then the
                             default of the kind (gw_gaze_default_error) */
} gw_tracker_viewer;

/* Numbers of analogs and buttons of one source; -1: none. */
typedef struct gw_tracker_navigation {
    int32_t source;
    int32_t forward, turn; /* analogs, -1 to 1: fly ahead; look to the right */
    int32_t reset;         /* button: back to where the run began */
} gw_tracker_navigation;

typedef struct gw_tracker_setup {
    uint32_t source_count, viewer_count;
    gw_tracker_source sources[GW_TRACKER_SOURCES];
    gw_tracker_viewer viewers[GW_TRACK_VIEWERS];
    gw_tracker_navigation navigation;
} gw_tracker_setup;

/* No source and no viewer. */
void gw_tracker_setup_none(gw_tracker_setup *out);
/* One source in wall axes and the unit of its protocol (DTrack: mm, else m); four viewers, whose heads are
 * sensors 0, 2, 4, 6, whose gazes are sensors 1, 3, 5, 7 or the gaze events of viewers 0 to 3. */
void gw_tracker_setup_default(const char *spec, gw_tracker_setup *out);
/* A viewer as the default has it, on source 0. */
void gw_tracker_viewer_default(int32_t viewer, gw_tracker_viewer *out);
/* mm per unit of what the protocol of a spec reports. */
double gw_tracker_source_unit(const char *spec);

/* The eye and the head's orientation from the head sensor's pose in wall space. */
void gw_tracker_eye(const gw_tracker_viewer *viewer, const double position_mm[3], const double orientation[4],
                    double out_eye[3], double out_head[4]);

/* Degrees that 95 of 100 gazes are off by, where the setup does not say (tracking/gaze_model.h has the
 * sources): of the head's direction taken for the gaze, and of eye trackers. */
double gw_gaze_default_error(gw_gaze_kind kind);
double gw_tracker_gaze_error(const gw_tracker_viewer *viewer);

#endif
