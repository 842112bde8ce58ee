/* What a fuzzer and the unit test do with the bytes of a DTrack datagram: read it, check what came out, write
 * it and read that again. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_DTRACK_ENTRY_H
#define GW_TESTS_FUZZ_DTRACK_ENTRY_H

#include "tracking/dtrack_message.h"

#include <math.h>
#include <stdlib.h>

static inline void fuzz_dtrack_pose(const gw_dtrack_pose *pose) {
    const double *q = pose->orientation;
    if (!pose->tracked)
        return;
    if (!pose->listed || !(fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-9))
        abort();
    for (int i = 0; i < 3; i++)
        if (!(fabs(pose->position[i]) <= 1e9))
            abort();
}

static inline void fuzz_dtrack_frame(const gw_dtrack_frame *frame) {
    if (frame->body_count < 0 || frame->body_count > GW_DTRACK_BODIES || frame->flystick_count < 0 ||
        frame->flystick_count > GW_DTRACK_FLYSTICKS || frame->calibrated < -1)
        abort();
    for (int i = 0; i < GW_DTRACK_BODIES; i++)
        fuzz_dtrack_pose(&frame->bodies[i]);
    for (int i = 0; i < GW_DTRACK_FLYSTICKS; i++) {
        const gw_dtrack_flystick *f = &frame->flysticks[i];
        fuzz_dtrack_pose(&f->pose);
        if (f->button_count < 0 || f->button_count > GW_DTRACK_BUTTONS || f->axis_count < 0 ||
            f->axis_count > GW_DTRACK_AXES)
            abort();
    }
}

static inline void fuzz_dtrack(const uint8_t *data, size_t size) {
    static gw_dtrack_frame frame, again;
    static char text[1 << 16];
    gw_dtrack_read(data, size, &frame);
    fuzz_dtrack_frame(&frame);
    for (int i = 0; i < frame.flystick_count; i++) /* text holds axes below 1e12 */
        for (int k = 0; k < frame.flysticks[i].axis_count; k++)
            frame.flysticks[i].axes[k] = fmin(1, fmax(-1, frame.flysticks[i].axes[k]));
    const size_t written = gw_dtrack_write(&frame, text, sizeof text);
    if (written == 0 || !gw_dtrack_read((const uint8_t *)text, written, &again) || again.malformed > 0)
        abort();
    fuzz_dtrack_frame(&again);
    for (int i = 0; i < frame.body_count; i++)
        if (frame.bodies[i].tracked != again.bodies[i].tracked)
            abort();
    if (frame.has_day_time)
        (void)gw_dtrack_unix_time(frame.day_time, INT64_C(1700000000000000000));
}

#endif
