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

/* The embedded demo track, in millimetres: a viewer in front of a wall of width x height mm centred on
 * (0,0,0); the gaze crosses tile borders. It is read from configs/tracks/demo.vrpn, embedded, then fitted to
 * the wall: it was recorded in front of one of 2000 x 1125 mm, so positions are scaled by width/2000 and
 * height/1125 (depth by their geometric mean), and a gaze that met the recorded wall at a point meets this
 * one at the corresponding point. */
gw_code gw_track_demo(double width, double height, gw_recording **out, gw_error *error);
/* The file as it is, in metres. */
gw_code gw_track_demo_file(gw_recording **out, gw_error *error);

#endif
