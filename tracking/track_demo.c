/* The demo track, fitted to a wall. */
#include "base/embedded.h"
#include "tracking/gaze_model.h"
#include "tracking/quaternion.h"
#include "tracking/track.h"

#include <math.h>

/* The wall in front of which the demo track was recorded, mm. */
static const double RECORDED_WIDTH = 2000.0, RECORDED_HEIGHT = 1125.0;

gw_code gw_track_demo(double width, double height, gw_track **out, gw_error *error) {
    *out = NULL;
    if (!(width > 0.0 && height > 0.0 && isfinite(width) && isfinite(height)))
        return gw_fail(error, GW_BAD_INPUT, "demo track: a wall of %g x %g mm has no area", width, height);
    const gw_embedded_file *file = gw_embedded_find("configs/tracks/demo.vrpn");
    if (file == NULL)
        return gw_fail(error, GW_MACHINE,
                       "demo track: configs/tracks/demo.vrpn is not in this program; build it again");
    gw_code code = gw_track_parse(file->data, file->size, "demo", NULL, out, error);
    if (code != GW_OK)
        return code;
    double scale[3] = {width / RECORDED_WIDTH, height / RECORDED_HEIGHT, 0.0};
    scale[2] = sqrt(scale[0] * scale[1]);
    for (size_t i = 0; i < (*out)->report_count; i++) {
        gw_pose_report *report = &(*out)->reports[i];
        for (int axis = 0; axis < 3; axis++)
            report->position[axis] *= scale[axis];
        if (report->sensor != GW_SENSOR_GAZE)
            continue;
        /* Eye and wall point are scaled alike, so the line between them is: the point stays the corresponding
         * one. */
        double direction[3], length = 0.0;
        gw_gaze_along(report->orientation, direction);
        for (int axis = 0; axis < 3; axis++) {
            direction[axis] *= scale[axis];
            length += direction[axis] * direction[axis];
        }
        for (int axis = 0; axis < 3; axis++)
            direction[axis] /= sqrt(length);
        gw_turn_onto(direction, report->orientation);
    }
    return GW_OK;
}
