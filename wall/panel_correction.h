/* What a panel needs so that it looks like its neighbours: gamma, white point, brightness (wall/site.h),
 * applied to finished pixels, last of all. Outside the claim that pixels are the same bits everywhere: it
 * changes what the panel gets, never what is collected, written or hashed. Nothing is compiled or allocated
 * for a panel that asks for nothing. The thread of its device. */
#ifndef GW_WALL_PANEL_CORRECTION_H
#define GW_WALL_PANEL_CORRECTION_H

#include "base/gl.h"
#include "wall/present_image.h"
#include "wall/site.h"

typedef struct gw_panel_correction {
    GLuint program;         /* 0: none is asked for */
    float gains[4];         /* red, green, blue; 1 / gamma */
    gw_present_image image; /* the corrected picture; empty without correction */
} gw_panel_correction;

/* 1 if the panel asks for a correction at all. */
int gw_panel_is_corrected(const gw_panel *panel);
/* What correction makes of one sRGB code (0 to 255) of a channel (0 red to 2 blue), before it is rounded: the
 * reference of shaders/present/correct.comp. */
double gw_panel_code(const gw_panel *panel, int channel, uint8_t code);

gw_code gw_panel_correction_create(gw_gl *device, const gw_panel *panel, const uint32_t size[2],
                                   gw_panel_correction *out, gw_error *error);
void gw_panel_correction_finish(gw_panel_correction *correction); /* accepts an empty one */
/* *out becomes the picture to show: the corrected one, or the one that was given. */
gw_code gw_panel_correction_apply(gw_gl *device, const gw_panel_correction *correction,
                                  const gw_present_image *picture, const gw_present_image **out,
                                  gw_error *error);

#endif
