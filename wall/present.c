#include "wall/present.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/panel_correction.h"

#include <stdlib.h>

struct gw_present {
    gw_gl *device;
    gw_window *window;        /* the device's; NULL: headless */
    gw_present_image picture; /* as rendered */
    gw_panel_correction correction;
};

gw_code gw_present_open(gw_gl *device, const gw_panel *panel, uint32_t width, uint32_t height,
                        gw_present **out, gw_error *error) {
    gw_present *present = NULL;
    const uint32_t size[2] = {width, height};
    gw_code code = gw_allocate((void **)&present, 1, sizeof *present, "presentation", error);
    if (code)
        return code;
    present->device = device;
    present->window = gw_gl_window(device);
    if (present->window)
        code = gw_present_image_create(size, &present->picture, error);
    if (!code && present->window)
        code = gw_panel_correction_create(device, panel, size, &present->correction, error);
    if (code)
        gw_present_close(&present);
    *out = present;
    return code;
}

void gw_present_close(gw_present **present) {
    if (!*present)
        return;
    if ((*present)->window) {
        gw_present_image_finish(&(*present)->picture);
        gw_panel_correction_finish(&(*present)->correction);
    }
    free(*present);
    *present = NULL;
}

gw_code gw_present_take_panel(gw_present *present, const gw_panel *panel, gw_error *error) {
    if (!gw_present_is_seen(present))
        return GW_OK;
    gw_panel_correction_finish(&present->correction);
    return gw_panel_correction_create(present->device, panel, present->picture.size, &present->correction,
                                      error);
}

gw_code gw_present_stage(gw_present *present, const uint8_t *rgba, gw_error *error) {
    if (!gw_present_is_seen(present))
        return GW_OK;
    const uint32_t *size = present->picture.size;
    const gw_present_place whole = {.width = size[0], .height = size[1]};
    const gw_present_image *shown;
    gw_present_image_write(&present->picture, rgba);
    gw_code code =
        gw_panel_correction_apply(present->device, &present->correction, &present->picture, &shown, error);
    if (code)
        return code;
    gw_present_image_copy(shown, &whole, size);
    glFlush();
    return gw_gl_check("putting a frame on its panel", error);
}

int64_t gw_present_show(gw_present *present) {
    if (gw_present_is_seen(present)) {
        size_t events;
        gw_window_swap(present->window);
        /* Nobody steers at a tile, but a window that never looks counts as hung. */
        gw_window_poll(present->window, &events);
    }
    return gw_now_ns();
}

int gw_present_is_seen(const gw_present *present) {
    return present && present->window;
}
