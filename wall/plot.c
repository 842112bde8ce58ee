#include "wall/plot.h"

#include "base/memory.h"
#include "wall/plot_pen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = GW_PLOT_WIDTH, HEIGHT = GW_PLOT_HEIGHT, LEFT = 80, RIGHT = 180, TOP = 40, BOTTOM = 60 };

/* Colours that also differ for the colour-blind (Okabe and Ito). */
static const char *const colors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                     "#e69f00", "#56b4e9", "#000000"};
enum { COLOR_COUNT = sizeof colors / sizeof *colors };

/* Exponents of ten between which an axis runs. */
typedef struct axis {
    double low, high;
} axis;

typedef struct canvas {
    const gw_plot_pen *pen;
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

/* A little beyond the points, and wide enough that some tick has a label. */
static axis loosen_axis(axis a) {
    const double least = 0.12;
    if (a.low > a.high)
        return (axis){0, 1};
    const double more = fmax(0.06 * (a.high - a.low), (least - (a.high - a.low)) / 2);
    return (axis){a.low - more, a.high + more};
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

static void put_line(const canvas *c, double x0, double y0, double x1, double y1, const char *color) {
    const gw_plot_place ends[2] = {{x0, y0}, {x1, y1}};
    c->pen->line(c->pen, ends, 2, color, 1, 0);
}

static void put_text(const canvas *c, double x, double y, gw_plot_anchor anchor, const char *text) {
    c->pen->text(c->pen, (gw_plot_place){x, y}, anchor, 12, "#222", text);
}

static int is_within(axis a, double exponent) {
    return exponent >= a.low - 1e-9 && exponent <= a.high + 1e-9;
}

/* Which of 1 to 9 times a power of ten have a label: the fewer decades, the more. */
static int is_labelled(axis a, int k) {
    const double decades = a.high - a.low;
    return k == 1 || (decades < 0.999 && (k == 2 || k == 5)) || decades < 0.4;
}

static void tick_text(int exponent, int k, char *out, size_t size) {
    if (k == 1)
        decade_text(exponent, out, size);
    else
        snprintf(out, size, "%.*f", exponent < 0 ? -exponent : 0, k * pow(10, exponent));
}

/* Lines at the decades, labels below and on the left; faint lines at 2 to 9 times. */
static void put_grid(const canvas *c) {
    char text[32];
    for (int e = (int)floor(c->x.low); e <= (int)c->x.high; e++)
        for (int k = 1; k < 10; k++) {
            const double at = e + log10(k);
            if (!is_within(c->x, at))
                continue;
            put_line(c, across(c, at), TOP, across(c, at), HEIGHT - BOTTOM, k == 1 ? "#bbb" : "#eee");
            tick_text(e, k, text, sizeof text);
            if (is_labelled(c->x, k))
                put_text(c, across(c, at), HEIGHT - BOTTOM + 18, GW_PLOT_MIDDLE, text);
        }
    for (int e = (int)floor(c->y.low); e <= (int)c->y.high; e++)
        for (int k = 1; k < 10; k++) {
            const double at = e + log10(k);
            if (!is_within(c->y, at))
                continue;
            put_line(c, LEFT, down(c, at), WIDTH - RIGHT, down(c, at), k == 1 ? "#bbb" : "#eee");
            tick_text(e, k, text, sizeof text);
            if (is_labelled(c->y, k))
                put_text(c, LEFT - 8, down(c, at) + 4, GW_PLOT_RIGHT, text);
        }
}

static gw_plot_place place_of(const canvas *c, const gw_plot_series *series, size_t i) {
    return (gw_plot_place){across(c, log10(series->x[i])), down(c, log10(series->y[i]))};
}

static void put_points(const canvas *c, const gw_plot_series *series, const char *color) {
    for (size_t i = 0; i < series->count; i++) {
        if (!has_place(series, i))
            continue;
        const gw_plot_place at = place_of(c, series, i);
        c->pen->dot(c->pen, at, 3, 0, color);
        if (series->ringed && series->ringed[i])
            c->pen->dot(c->pen, at, 6, 1.5, "#000");
        if (series->labels)
            c->pen->text(c->pen, (gw_plot_place){at.x + 8, at.y - 5}, GW_PLOT_LEFT, 11, "#222",
                         series->labels[i]);
    }
}

static gw_code put_series(const canvas *c, const gw_plot_series *series, size_t index, gw_error *error) {
    const char *color = series->dashed ? "#777" : colors[index % COLOR_COUNT];
    const double width = series->dashed ? 1 : 2, y = TOP + 12 + 20.0 * (double)index;
    gw_plot_place *places = NULL;
    size_t count = 0;
    gw_code code = gw_allocate((void **)&places, series->count, sizeof *places, "a curve", error);
    if (code)
        return code;
    for (size_t i = 0; i < series->count; i++)
        if (has_place(series, i))
            places[count++] = place_of(c, series, i);
    if (!series->loose)
        c->pen->line(c->pen, places, count, color, width, series->dashed);
    free(places);
    if (!series->dashed)
        put_points(c, series, color);
    const gw_plot_place key[2] = {{WIDTH - RIGHT + 12, y - 4}, {WIDTH - RIGHT + 36, y - 4}};
    if (series->loose)
        c->pen->dot(c->pen, (gw_plot_place){WIDTH - RIGHT + 24, y - 4}, 3, 0, color);
    else
        c->pen->line(c->pen, key, 2, color, width, series->dashed);
    put_text(c, WIDTH - RIGHT + 42, y, GW_PLOT_LEFT, series->name);
    return GW_OK;
}

static void put_labels(const gw_plot *plot, const canvas *c) {
    const double middle_x = (LEFT + WIDTH - RIGHT) / 2.0, middle_y = (TOP + HEIGHT - BOTTOM) / 2.0;
    c->pen->text(c->pen, (gw_plot_place){middle_x, TOP - 16}, GW_PLOT_MIDDLE, 15, "#222", plot->title);
    put_text(c, middle_x, HEIGHT - 18, GW_PLOT_MIDDLE, plot->x_label);
    put_text(c, 20, middle_y, GW_PLOT_UPWARDS, plot->y_label);
}

static gw_code put_plot(const gw_plot *plot, const gw_plot_pen *pen, gw_error *error) {
    canvas c = {.pen = pen, .x = {INFINITY, -INFINITY}, .y = {INFINITY, -INFINITY}};
    gw_code code = GW_OK;
    for (size_t s = 0; s < plot->series_count; s++)
        for (size_t i = 0; i < plot->series[s].count; i++)
            if (has_place(&plot->series[s], i)) {
                widen(&c.x, plot->series[s].x[i]);
                widen(&c.y, plot->series[s].y[i]);
            }
    c.x = plot->tight ? loosen_axis(c.x) : round_axis(c.x);
    c.y = plot->tight ? loosen_axis(c.y) : round_axis(c.y);
    put_grid(&c);
    put_labels(plot, &c);
    for (size_t s = 0; s < plot->series_count && !code; s++)
        code = put_series(&c, &plot->series[s], s, error);
    return code;
}

gw_code gw_plot_svg(const gw_plot *plot, char **out, size_t *size, gw_error *error) {
    *out = NULL;
    FILE *svg = open_memstream(out, size);
    if (!svg)
        return gw_fail(error, GW_MACHINE, "memory is out while drawing a plot");
    const gw_plot_pen pen = gw_plot_pen_svg(svg);
    fprintf(svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"white\"/>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    gw_code code = put_plot(plot, &pen, error);
    fputs("</svg>\n", svg);
    return fclose(svg) == 0 || code ? code : gw_fail(error, GW_MACHINE, "memory is out while drawing a plot");
}

gw_code gw_plot_image(const gw_plot *plot, gw_image *out, gw_error *error) {
    gw_code code = gw_image_create(WIDTH, HEIGHT, out, error);
    if (code)
        return code;
    const gw_plot_pen pen = gw_plot_pen_image(out);
    return put_plot(plot, &pen, error);
}
