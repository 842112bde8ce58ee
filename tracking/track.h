/* Tracks: recordings that are played by the plain convention of docs/tracks.md, which says whose head and
 * gaze a sensor is where no site does; and the demo track. Any thread. */
#ifndef GW_TRACKING_TRACK_H
#define GW_TRACKING_TRACK_H

#include "base/status.h"
#include "tracking/recording.h"

#include <stdint.h>

/* Sensors of viewer v: 2 v is the head, 2 v + 1 the gaze. */
enum {
    GW_SENSOR_HEAD = 0,
    GW_SENSOR_GAZE = 1,
    GW_TRACK_VIEWERS = 4,
    GW_TRACK_SENSORS = 2 * GW_TRACK_VIEWERS
};

/* The first device that reports the head or gaze of a viewer. GW_BAD_INPUT, and what there is instead, when
 * none does. */
gw_code gw_track_sender(const gw_recording *recording, uint32_t *out, gw_error *error);

/* A recording by its path; or one that is in this program by its name alone, unless a file has that name:
 * demo, walking and the others of configs/tracks (docs/tracks.md). */
gw_code gw_track_load(const char *path, gw_recording **out, gw_error *error);
int gw_track_is_shipped(const char *name);
/* The nearest name of those to a misspelt one; 0: none is near. */
enum { GW_TRACK_NAME = 32 };
int gw_track_suggest(const char *name, char out[GW_TRACK_NAME]);

/* The embedded demo track, in millimetres: a viewer in front of a wall of width x height mm centred on
 * (0,0,0); the gaze crosses tile borders. It is read from configs/tracks/demo.vrpn, embedded, then fitted to
 * the wall: it was recorded in front of one of 2000 x 1125 mm, so positions are scaled by width/2000 and
 * height/1125 (depth by their geometric mean), and a gaze that met the recorded wall at a point meets this
 * one at the corresponding point. */
gw_code gw_track_demo(double width, double height, gw_recording **out, gw_error *error);

#endif
