#include "wall/panel_correction.h"

#include "base/srgb.h"

enum { LOCATION_GAINS, GROUP = 64 };

static double gain_of(const gw_panel *panel, int channel) {
    return panel->white[channel] * panel->brightness;
}

int gw_panel_is_corrected(const gw_panel *panel) {
    int asked = panel->gamma > 0;
    for (int i = 0; i < 3; i++)
        asked |= gain_of(panel, i) != 1;
    return asked;
}

double gw_panel_code(const gw_panel *panel, int channel, uint8_t code) {
    double light = fmin(gw_srgb_code_to_linear(code) * gain_of(panel, channel), 1);
    return 255 * (panel->gamma > 0 ? pow(light, 1 / panel->gamma) : gw_srgb_from_linear(light));
}

gw_code gw_panel_correction_create(gw_gl *device, const gw_panel *panel, const uint32_t size[2],
                                   gw_panel_correction *out, gw_error *error) {
    *out = (gw_panel_correction){0};
    if (!gw_panel_is_corrected(panel))
        return GW_OK;
    gw_code code = gw_present_image_create(size, &out->image, error);
    if (!code)
        code = gw_gl_program(device, "present/correct.comp", panel->gamma > 0 ? "#define GAMMA 1\n" : NULL,
                             &out->program, error);
    for (int i = 0; i < 3; i++)
        out->gains[i] = (float)gain_of(panel, i);
    out->gains[3] = panel->gamma > 0 ? (float)(1 / panel->gamma) : 0;
    if (code)
        gw_panel_correction_finish(out);
    return code;
}

void gw_panel_correction_finish(gw_panel_correction *correction) {
    gw_present_image_finish(&correction->image);
    correction->program = 0; /* the device's */
}

gw_code gw_panel_correction_apply(gw_gl *device, const gw_panel_correction *correction,
                                  const gw_present_image *picture, const gw_present_image **out,
                                  gw_error *error) {
    *out = picture;
    if (!correction->program)
        return GW_OK;
    const uint64_t pixels = (uint64_t)picture->size[0] * picture->size[1];
    *out = &correction->image;
    glProgramUniform4fv(correction->program, LOCATION_GAINS, 1, correction->gains);
    glBindImageTexture(0, picture->texture, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
    glBindImageTexture(1, correction->image.texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    return gw_gl_dispatch(device, correction->program, (pixels + GROUP - 1) / GROUP, error);
}
