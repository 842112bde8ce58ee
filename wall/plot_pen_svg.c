#include "wall/plot_pen.h"

#include "wall/svg.h"

static void line(const gw_plot_pen *pen, const gw_plot_place *places, size_t count, const char *color,
                 double width, int dashed) {
    fputs("<path d=\"", pen->svg);
    for (size_t i = 0; i < count; i++)
        fprintf(pen->svg, "%c%.1f %.1f", i ? 'L' : 'M', places[i].x, places[i].y);
    fprintf(pen->svg, "\" fill=\"none\" stroke=\"%s\"", color);
    if (width > 1)
        fprintf(pen->svg, " stroke-width=\"%g\"", width);
    fprintf(pen->svg, "%s/>\n", dashed ? " stroke-dasharray=\"5 4\"" : "");
}

static void dot(const gw_plot_pen *pen, gw_plot_place at, double radius, double width, const char *color) {
    fprintf(pen->svg, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%g\" ", at.x, at.y, radius);
    if (width > 0)
        fprintf(pen->svg, "fill=\"none\" stroke=\"%s\" stroke-width=\"%g\"/>\n", color, width);
    else
        fprintf(pen->svg, "fill=\"%s\"/>\n", color);
}

static void put_text(const gw_plot_pen *pen, gw_plot_place at, gw_plot_anchor anchor, int size,
                     const char *color, const char *text) {
    char attributes[160];
    int used = snprintf(attributes, sizeof attributes, "fill=\"%s\"%s", color,
                        anchor == GW_PLOT_LEFT    ? ""
                        : anchor == GW_PLOT_RIGHT ? " text-anchor=\"end\""
                                                  : " text-anchor=\"middle\"");
    if (size != 12)
        used += snprintf(attributes + used, sizeof attributes - (size_t)used, " font-size=\"%d\"", size);
    if (anchor == GW_PLOT_UPWARDS)
        snprintf(attributes + used, sizeof attributes - (size_t)used, " transform=\"rotate(-90 %.1f %.1f)\"",
                 at.x, at.y);
    gw_svg_text(pen->svg, at.x, at.y, attributes, text);
}

gw_plot_pen gw_plot_pen_svg(FILE *svg) {
    return (gw_plot_pen){.svg = svg, .line = line, .dot = dot, .text = put_text};
}
