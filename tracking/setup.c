/* Defaults of a tracker's setup, and the transform from sensor to eye. */
#include "tracking/setup.h"

#include "tracking/quaternion.h"

#include <stdio.h>
#include <string.h>

void gw_tracker_setup_none(gw_tracker_setup *out) {
    memset(out, 0, sizeof *out);
    out->navigation = (gw_tracker_navigation){0, -1, -1, -1};
}

double gw_tracker_source_unit(const char *spec) {
    return strncmp(spec, "dtrack:", 7) == 0 ? 1 : 1000;
}

void gw_tracker_viewer_default(int32_t viewer, gw_tracker_viewer *out) {
    memset(out, 0, sizeof *out);
    out->head_sensor = 2 * viewer + GW_SENSOR_HEAD;
    out->gaze_sensor = 2 * viewer + GW_SENSOR_GAZE;
    out->gaze_viewer = viewer;
    out->gaze = GW_GAZE_KIND_ANY;
    out->head_turn[3] = 1;
    out->gaze_error = -1;
}

void gw_tracker_setup_default(const char *spec, gw_tracker_setup *out) {
    gw_tracker_setup_none(out);
    out->source_count = 1;
    snprintf(out->sources[0].spec, sizeof out->sources[0].spec, "%s", spec);
    gw_room_default(gw_tracker_source_unit(spec), &out->sources[0].room);
    out->viewer_count = GW_TRACK_VIEWERS;
    for (int32_t v = 0; v < GW_TRACK_VIEWERS; v++)
        gw_tracker_viewer_default(v, &out->viewers[v]);
}

void gw_tracker_eye(const gw_tracker_viewer *viewer, const double position_mm[3], const double orientation[4],
                    double out_eye[3], double out_head[4]) {
    double offset[3];
    gw_turn_after(orientation, viewer->head_turn, out_head);
    gw_turn_vector(out_head, viewer->eye_offset, offset);
    for (int i = 0; i < 3; i++)
        out_eye[i] = position_mm[i] + offset[i];
}

double gw_gaze_default_error(gw_gaze_kind kind) {
    return kind == GW_GAZE_KIND_HEAD ? 27 : 3;
}

double gw_tracker_gaze_error(const gw_tracker_viewer *viewer) {
    return viewer->gaze_error >= 0 ? viewer->gaze_error : gw_gaze_default_error((gw_gaze_kind)viewer->gaze);
}
