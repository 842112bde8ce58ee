/* What every frame that a test draws has to keep, wherever it is drawn: no ray is cut off, no pixel is no
 * number, the driver reports no error. Test programs are linked so that these two functions stand before the
 * library's own (ld --wrap, see the Makefile). */
#include "tests/support/check.h"

#include "base/gl.h"
#include "render/renderer.h"

#include <stdlib.h>

/* The linker's names. */
gw_code __real_gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                                 const gw_rectangle *rectangle, const gw_frame_state *state, uint8_t *rgba,
                                 gw_counters *counters, gw_error *error);
gw_code __wrap_gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                                 const gw_rectangle *rectangle, const gw_frame_state *state, uint8_t *rgba,
                                 gw_counters *counters, gw_error *error);
gw_code __real_gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error);
gw_code __wrap_gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error);

gw_code __wrap_gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                                 const gw_rectangle *rectangle, const gw_frame_state *state, uint8_t *rgba,
                                 gw_counters *counters, gw_error *error) {
    gw_counters frame = {0};
    gw_code code =
        __real_gw_renderer_frame(renderer, placement, plane, rectangle, state, rgba, &frame, error);
    if (counters)
        gw_counters_add(counters, &frame);
    if (frame.step_cap_hits || frame.nan_pixels)
        fail_msg("a frame with %llu rays that were cut off and %llu pixels that are no numbers",
                 (unsigned long long)frame.step_cap_hits, (unsigned long long)frame.nan_pixels);
    return code;
}

static void end_at_error(void *context, gw_log_level level, const char *text) {
    (void)context;
    if (level != GW_LOG_ERROR)
        return;
    print_error("%s\n", text);
    abort(); /* inside the driver's callback there is no way back */
}

/* Devices with a log of their own are those of tests of messages. */
gw_code __wrap_gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error) {
    static const gw_log strict = {.threshold = GW_LOG_ERROR, .line = end_at_error};
    gw_gl_options with = options ? *options : (gw_gl_options){0};
    if (!with.log) {
        with.debug = 1;
        with.log = &strict;
    }
    return __real_gw_gl_create(&with, out, error);
}
