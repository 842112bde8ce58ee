/* Pixels of a plot: lines as wide as a box of their width, at every pixel along them. */
#include "wall/plot_pen.h"

#include "wall/overlay_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void color_of(const char *text, uint8_t out[4]) {
    const unsigned long value = strtoul(text + 1, NULL, 16);
    const int narrow = strlen(text) == 4;
    for (int c = 0; c < 3; c++)
        out[c] = (uint8_t)(narrow ? 17 * (value >> (4 * (2 - c)) & 15) : value >> (8 * (2 - c)) & 255);
    out[3] = 255;
}

static void segment(gw_image *image, gw_plot_place a, gw_plot_place b, const uint8_t color[4], double width,
                    int dashed) {
    const double length = fmax(fabs(b.x - a.x), fabs(b.y - a.y));
    const int64_t side = width > 1 ? (int64_t)width : 1;
    for (int64_t i = 0; (double)i <= length; i++) {
        const double share = length > 0 ? (double)i / length : 0;
        if (!dashed || i % 9 < 5)
            gw_box_draw(image, llround(a.x + share * (b.x - a.x)), llround(a.y + share * (b.y - a.y)), side,
                        side, color);
    }
}

static void line(const gw_plot_pen *pen, const gw_plot_place *places, size_t count, const char *color,
                 double width, int dashed) {
    uint8_t rgba[4];
    color_of(color, rgba);
    for (size_t i = 1; i < count; i++)
        segment(pen->image, places[i - 1], places[i], rgba, width, dashed);
}

static void dot(const gw_plot_pen *pen, gw_plot_place at, double radius, double width, const char *color) {
    uint8_t rgba[4];
    color_of(color, rgba);
    const int64_t reach = (int64_t)ceil(radius + width);
    for (int64_t y = -reach; y <= reach; y++)
        for (int64_t x = -reach; x <= reach; x++) {
            const double away = sqrt((double)(x * x + y * y));
            if (width > 0 ? fabs(away - radius) <= fmax(width / 2, 0.6) : away <= radius + 0.3)
                gw_box_draw(pen->image, llround(at.x) + x, llround(at.y) + y, 1, 1, rgba);
        }
}

/* Turned by a quarter: drawn lying, then placed pixel by pixel. */
static void upwards(gw_image *image, gw_plot_place at, const uint8_t color[4], const char *text) {
    static const uint8_t white[4] = {255, 255, 255, 255};
    uint32_t width, height;
    gw_image lying;
    gw_text_measure(text, 1, &width, &height);
    if (!width || gw_image_create(width, height, &lying, NULL))
        return;
    gw_box_draw(&lying, 0, 0, width, height, white);
    gw_text_draw(&lying, 0, 0, 1, color, text);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            gw_box_draw(image, llround(at.x) - 7 + y, llround(at.y) + (int64_t)width / 2 - x, 1, 1,
                        lying.rgba + ((size_t)y * width + x) * 4);
    gw_image_finish(&lying);
}

static void put_text(const gw_plot_pen *pen, gw_plot_place at, gw_plot_anchor anchor, int size,
                     const char *color, const char *text) {
    uint8_t rgba[4];
    uint32_t width, height;
    (void)size; /* the letters have one size */
    color_of(color, rgba);
    if (anchor == GW_PLOT_UPWARDS) {
        upwards(pen->image, at, rgba, text);
        return;
    }
    gw_text_measure(text, 1, &width, &height);
    const int64_t left = anchor == GW_PLOT_LEFT ? 0 : anchor == GW_PLOT_RIGHT ? width : width / 2;
    gw_text_draw(pen->image, llround(at.x) - left, llround(at.y) - 7, 1, rgba, text);
}

gw_plot_pen gw_plot_pen_image(gw_image *image) {
    static const uint8_t white[4] = {255, 255, 255, 255};
    gw_box_draw(image, 0, 0, image->width, image->height, white);
    return (gw_plot_pen){.image = image, .line = line, .dot = dot, .text = put_text};
}
