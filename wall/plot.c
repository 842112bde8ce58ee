#include "wall/plot.h"

#include "wall/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 720, HEIGHT = 440, LEFT = 80, RIGHT = 180, TOP = 40, BOTTOM = 60 };

/* Colours that also differ for the colour-blind (Okabe and Ito). */
static const char *const colors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                     "#e69f00", "#56b4e9", "#000000"};
enum { COLOR_COUNT = sizeof colors / sizeof *colors };

/* Exponents of ten between which an axis runs. */
typedef struct axis {
    double low, high;
} axis;

typedef struct canvas {
    FILE *svg;
    axis x, y;
} canvas;

static int has_place(const gw_plot_series *series, size_t i) {
    return series->x[i] > 0 && series->y[i] > 0 && isfinite(series->x[i]) && isfinite(series->y[i]);
}

static void widen(axis *a, double value) {
    double exponent = log10(value);
    a->low = fmin(a->low, exponent);
    a->high = fmax(a->high, exponent);
}

/* To whole decades, at least one of them. */
static axis round_axis(axis a) {
    if (a.low > a.high)
        return (axis){0, 1};
    a.low = floor(a.low + 1e-9);
    a.high = ceil(a.high - 1e-9);
    return (axis){a.low, a.high > a.low ? a.high : a.low + 1};
}

static double across(const canvas *c, double exponent) {
    return LEFT + (exponent - c->x.low) / (c->x.high - c->x.low) * (WIDTH - LEFT - RIGHT);
}

static double down(const canvas *c, double exponent) {
    return HEIGHT - BOTTOM - (exponent - c->y.low) / (c->y.high - c->y.low) * (HEIGHT - TOP - BOTTOM);
}

/* 0.001, 1, 10, 100, 1k, 10M. */
static void decade_text(int exponent, char *out, size_t size) {
    static const char *const suffixes[] = {"", "k", "M", "G", "T"};
    if (exponent >= 0 && exponent < 15)
        snprintf(out, size, "%.0f%s", pow(10, exponent % 3), suffixes[exponent / 3]);
    else if (exponent < 0 && exponent >= -4)
        snprintf(out, size, "%.*f", -exponent, pow(10, exponent));
    else
        snprintf(out, size, "1e%d", exponent);
}

static void put_line(FILE *svg, double x0, double y0, double x1, double y1, const char *color) {
    fprintf(svg, "<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"%s\"/>\n", x0, y0, x1, y1, color);
}

/* Lines at the decades, labels below and on the left; faint lines at 2 to 9 times. */
static void put_grid(const canvas *c) {
    char text[32];
    for (int e = (int)c->x.low; e <= (int)c->x.high; e++) {
        for (int k = 1; k < 10 && (k == 1 || e < (int)c->x.high); k++)
            put_line(c->svg, across(c, e + log10(k)), TOP, across(c, e + log10(k)), HEIGHT - BOTTOM,
                     k == 1 ? "#bbb" : "#eee");
        decade_text(e, text, sizeof text);
        gw_svg_text(c->svg, across(c, e), HEIGHT - BOTTOM + 18, "text-anchor=\"middle\"", text);
    }
    for (int e = (int)c->y.low; e <= (int)c->y.high; e++) {
        for (int k = 1; k < 10 && (k == 1 || e < (int)c->y.high); k++)
            put_line(c->svg, LEFT, down(c, e + log10(k)), WIDTH - RIGHT, down(c, e + log10(k)),
                     k == 1 ? "#bbb" : "#eee");
        decade_text(e, text, sizeof text);
        gw_svg_text(c->svg, LEFT - 8, down(c, e) + 4, "text-anchor=\"end\"", text);
    }
}

static void put_series(const canvas *c, const gw_plot_series *series, size_t index) {
    const char *color = series->dashed ? "#777" : colors[index % COLOR_COUNT];
    const char *style = series->dashed ? "stroke-dasharray=\"5 4\"" : "stroke-width=\"2\"";
    char command = 'M';
    fputs("<path d=\"", c->svg);
    for (size_t i = 0; i < series->count; i++)
        if (has_place(series, i)) {
            fprintf(c->svg, "%c%.1f %.1f", command, across(c, log10(series->x[i])),
                    down(c, log10(series->y[i])));
            command = 'L';
        }
    fprintf(c->svg, "\" stroke=\"%s\" %s/>\n", color, style);
    for (size_t i = 0; i < series->count && !series->dashed; i++)
        if (has_place(series, i))
            fprintf(c->svg, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>\n",
                    across(c, log10(series->x[i])), down(c, log10(series->y[i])), color);
    double y = TOP + 12 + 20.0 * (double)index;
    fprintf(c->svg, "<path d=\"M%d %.1fh24\" stroke=\"%s\" %s/>\n", WIDTH - RIGHT + 12, y - 4, color, style);
    gw_svg_text(c->svg, WIDTH - RIGHT + 42, y, "fill=\"#222\"", series->name);
}

static void put_labels(const gw_plot *plot, FILE *svg) {
    char turned[128];
    const double middle_x = (LEFT + WIDTH - RIGHT) / 2.0, middle_y = (TOP + HEIGHT - BOTTOM) / 2.0;
    gw_svg_text(svg, middle_x, TOP - 16, "text-anchor=\"middle\" font-size=\"15\"", plot->title);
    gw_svg_text(svg, middle_x, HEIGHT - 18, "text-anchor=\"middle\"", plot->x_label);
    snprintf(turned, sizeof turned, "text-anchor=\"middle\" transform=\"rotate(-90 20 %.1f)\"", middle_y);
    gw_svg_text(svg, 20, middle_y, turned, plot->y_label);
}

gw_code gw_plot_svg(const gw_plot *plot, char **out, size_t *size, gw_error *error) {
    canvas c = {.x = {INFINITY, -INFINITY}, .y = {INFINITY, -INFINITY}};
    for (size_t s = 0; s < plot->series_count; s++)
        for (size_t i = 0; i < plot->series[s].count; i++)
            if (has_place(&plot->series[s], i)) {
                widen(&c.x, plot->series[s].x[i]);
                widen(&c.y, plot->series[s].y[i]);
            }
    c.x = round_axis(c.x);
    c.y = round_axis(c.y);
    *out = NULL;
    c.svg = open_memstream(out, size);
    if (!c.svg)
        return gw_fail(error, GW_MACHINE, "memory is out while drawing a plot");
    fprintf(c.svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"white\"/>\n"
            "<g fill=\"#222\">\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    put_grid(&c);
    put_labels(plot, c.svg);
    fputs("</g>\n<g fill=\"none\">\n", c.svg);
    for (size_t s = 0; s < plot->series_count; s++)
        put_series(&c, &plot->series[s], s);
    fputs("</g>\n</svg>\n", c.svg);
    return fclose(c.svg) == 0 ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while drawing a plot");
}
