/* What draws a plot: an SVG text, or pixels. plot.c says what stands where, once for both. */
#ifndef GW_WALL_PLOT_PEN_H
#define GW_WALL_PLOT_PEN_H

#include "base/image.h"

#include <stddef.h>
#include <stdio.h>

enum { GW_PLOT_WIDTH = 720, GW_PLOT_HEIGHT = 440 }; /* px */

typedef enum gw_plot_anchor { GW_PLOT_LEFT, GW_PLOT_MIDDLE, GW_PLOT_RIGHT, GW_PLOT_UPWARDS } gw_plot_anchor;

typedef struct gw_plot_place {
    double x, y;
} gw_plot_place;

typedef struct gw_plot_pen gw_plot_pen;
struct gw_plot_pen {
    FILE *svg;       /* of the SVG pen */
    gw_image *image; /* of the other */
    /* color: "#rrggbb" or "#rgb". The line passes through all places; width in px; dashed: 1 or 0. */
    void (*line)(const gw_plot_pen *pen, const gw_plot_place *places, size_t count, const char *color,
                 double width, int dashed);
    /* A disc, or a ring where width is above 0. */
    void (*dot)(const gw_plot_pen *pen, gw_plot_place at, double radius, double width, const char *color);
    /* at: of the base line; upwards: turned by a quarter, centred there. */
    void (*text)(const gw_plot_pen *pen, gw_plot_place at, gw_plot_anchor anchor, int size, const char *color,
                 const char *text);
};

gw_plot_pen gw_plot_pen_svg(FILE *svg);
/* The image has GW_PLOT_WIDTH x GW_PLOT_HEIGHT px. */
gw_plot_pen gw_plot_pen_image(gw_image *image);

#endif
