/* Plots as SVG text or pixels: curves over logarithmic axes, with a legend. Any thread. */
#ifndef GW_WALL_PLOT_H
#define GW_WALL_PLOT_H

#include "base/image.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_plot_series {
    const char *name;
    const double *x, *y; /* [count]; points that are not positive have no place and are left out */
    size_t count;
    int dashed;                /* for comparison: drawn thin and dashed, without markers */
    int loose;                 /* points without a line between them */
    const char *const *labels; /* [count], beside the points, or NULL */
    const uint8_t *ringed;     /* [count], 1: a ring about the point, or NULL */
} gw_plot_series;

typedef struct gw_plot {
    const char *title, *x_label, *y_label; /* with units */
    const gw_plot_series *series;
    size_t series_count;
    int tight; /* axes end a little beyond the points, not at the next powers of ten */
} gw_plot;

/* The text, for free(). */
gw_code gw_plot_svg(const gw_plot *plot, char **out, size_t *size, gw_error *error);
/* The same as pixels; release it with gw_image_finish(). */
gw_code gw_plot_image(const gw_plot *plot, gw_image *out, gw_error *error);

#endif
