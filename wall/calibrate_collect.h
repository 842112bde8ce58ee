/* Marks that a file does not know yet: sampled from a recording, or from a device while somebody holds the
 * sensor there. One thread. */
#ifndef GW_WALL_CALIBRATE_COLLECT_H
#define GW_WALL_CALIBRATE_COLLECT_H

#include "tracking/recording.h"
#include "wall/calibrate_file.h"

/* The mean of the sensor's positions in each timed mark's time. GW_BAD_INPUT for a mark that has no time, or
 * no position in it. */
gw_code gw_marks_take_recording(gw_marks *marks, const gw_recording *recording, gw_error *error);

#endif
