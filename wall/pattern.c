#include "wall/pattern.h"

#include "base/srgb.h"
#include "wall/overlay_text.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

const char *const gw_pattern_names[GW_PATTERN_COUNT] = {
    [GW_PATTERN_NONE] = "none",
    [GW_PATTERN_GRID] = "grid",
    [GW_PATTERN_COLOURS] = "colours",
    [GW_PATTERN_NAMES] = "names",
};

enum { MINOR_MM = 10, MAJOR_MM = 100, LEAST_MINOR_PX = 5 };

static const uint8_t white[4] = {255, 255, 255, 255}, black[4] = {0, 0, 0, 255};

void gw_pattern_axes(const gw_tile *tile, int axes[2]) {
    const double *steps[2] = {tile->plane.step_x, tile->plane.step_y};
    for (int i = 0; i < 2; i++) {
        axes[i] = -1;
        for (int axis = 0; axis < 3; axis++)
            if (!(i == 1 && axis == axes[0]) &&
                (axes[i] < 0 || fabs(steps[i][axis]) > fabs(steps[i][axes[i]])))
                axes[i] = axis;
    }
}

/* A linear function of the tile's pixels: its value at pixel (x, y)'s centre, and how much it grows over one
 * pixel across itself. */
typedef struct ramp {
    double origin, across, down, growth;
} ramp;

static ramp ramp_of(const gw_tile *tile, const double normal[3]) {
    const gw_plane *p = &tile->plane;
    ramp r = {0};
    for (int i = 0; i < 3; i++) {
        r.across += normal[i] * p->step_x[i];
        r.down += normal[i] * p->step_y[i];
        r.origin += normal[i] * (p->corner[i] + (tile->rectangle.x + 0.5) * p->step_x[i] +
                                 (tile->rectangle.y + 0.5) * p->step_y[i]);
    }
    r.growth = hypot(r.across, r.down);
    return r;
}

/* How much of a pixel lies under the nearest of the lines at whole multiples of `spacing` (0: only at 0),
 * `width` px wide. */
static double coverage(const ramp *r, double x, double y, double spacing, double width) {
    if (!(r->growth > 0))
        return 0;
    const double value = r->origin + x * r->across + y * r->down;
    const double apart = spacing > 0 ? fabs(value - spacing * floor(value / spacing + 0.5)) : fabs(value);
    return fmin(1, fmax(0, 0.5 * width + 0.5 - apart / r->growth));
}

static void mix(double light[3], const double color[3], double share) {
    for (int i = 0; i < 3; i++)
        light[i] += (color[i] - light[i]) * share;
}

/* Everything that the grid needs of a tile. */
typedef struct grid {
    ramp axes[2];
    ramp across_wall; /* 0 on the line from the wall's lower left corner to its upper right one */
    double minor_share;
} grid;

static grid grid_of(const gw_layout *layout, const gw_tile *tile) {
    grid g;
    int axes[2];
    gw_pattern_axes(tile, axes);
    for (int i = 0; i < 2; i++) {
        double normal[3] = {0};
        normal[axes[i]] = 1;
        g.axes[i] = ramp_of(tile, normal);
    }
    const double length = hypot(layout->size[0], layout->size[1]);
    const double normal[3] = {-layout->size[1] / length, layout->size[0] / length, 0};
    g.across_wall = ramp_of(tile, normal);
    for (int i = 0; i < 3; i++)
        g.across_wall.origin -= normal[i] * layout->centre[i];
    /* Lines so close that they would only grey the tile are left out. */
    const double coarsest = fmax(g.axes[0].growth, g.axes[1].growth);
    g.minor_share = coarsest * LEAST_MINOR_PX <= MINOR_MM ? 0.35 : 0;
    return g;
}

static void grid_light(const grid *g, double x, double y, double light[3]) {
    static const double ground[3] = {0.012, 0.016, 0.022}, minor[3] = {0.12, 0.14, 0.16},
                        major[3] = {0.6, 0.65, 0.7}, origin[2][3] = {{1, 0.1, 0.06}, {0.1, 0.9, 0.1}},
                        diagonal[3] = {1, 0.75, 0};
    memcpy(light, ground, sizeof ground);
    for (int i = 0; i < 2; i++)
        mix(light, minor, g->minor_share * coverage(&g->axes[i], x, y, MINOR_MM, 1));
    for (int i = 0; i < 2; i++)
        mix(light, major, coverage(&g->axes[i], x, y, MAJOR_MM, 1.5));
    for (int i = 0; i < 2; i++)
        mix(light, origin[i], coverage(&g->axes[i], x, y, 0, 3));
    mix(light, diagonal, coverage(&g->across_wall, x, y, 0, 2));
}

/* A line's place along the tile's upper side (axis 0) or left side, and the millimetres that it stands for.
 */
static void label_lines(gw_image *image, const grid *g, uint32_t scale) {
    static const uint8_t color[4] = {190, 200, 210, 255};
    for (int axis = 0; axis < 2; axis++) {
        const ramp *r = &g->axes[axis];
        const double step = axis ? r->down : r->across;
        const uint32_t size = axis ? image->height : image->width;
        const double first = r->origin, last = r->origin + step * (size - 1);
        const long from = lrint(ceil(fmin(first, last) / MAJOR_MM)),
                   to = lrint(floor(fmax(first, last) / MAJOR_MM));
        /* At most 400 labels: a tile of 100 m has more lines than anybody reads. */
        for (long line = from; line <= to && line < from + 400 && fabs(step) > 0; line++) {
            const double at = ((double)line * MAJOR_MM - first) / step;
            char text[24];
            uint32_t width, height;
            snprintf(text, sizeof text, "%ld", line * MAJOR_MM);
            gw_text_measure(text, scale, &width, &height);
            /* A pitch of lines too close for its labels labels every fifth. */
            if (fabs(MAJOR_MM / step) < 1.5 * width && line % 5)
                continue;
            const int64_t gap = 2 * (int64_t)scale;
            if (axis == 0)
                gw_text_draw(image, lrint(at) + gap, 4 * (int64_t)scale, scale, color, text);
            else
                gw_text_draw(image, 4 * (int64_t)scale, lrint(at) - (int64_t)height + gap, scale, color,
                             text);
        }
    }
}

/* Two pixels from the border inwards on every side, and an angle in each corner: a panel that crops or
 * scales shows it. */
static void mark_border(gw_image *image) {
    static const uint8_t edge[4] = {0, 160, 255, 255};
    const int64_t w = image->width, h = image->height, arm = (w < h ? w : h) / 8;
    gw_box_draw(image, 0, 0, w, 1, edge);
    gw_box_draw(image, 0, h - 1, w, 1, edge);
    gw_box_draw(image, 0, 0, 1, h, edge);
    gw_box_draw(image, w - 1, 0, 1, h, edge);
    for (int corner = 0; corner < 4; corner++) {
        const int64_t x = corner & 1 ? w - 3 : 0, y = corner & 2 ? h - 3 : 0;
        gw_box_draw(image, corner & 1 ? w - arm : 0, y, arm, 3, white);
        gw_box_draw(image, x, corner & 2 ? h - arm : 0, 3, arm, white);
    }
}

/* Ramp of 17 greys in equal steps of the encoded value; above it stripes of black and white rows, which give
 * the light of the grey 188 beside them on a panel that shows sRGB. */
static void draw_greys(gw_image *image, int64_t x, int64_t y, int64_t width, int64_t height) {
    enum { GREYS = 17, HALF_LIGHT = 188 };
    for (int i = 0; i < GREYS; i++) {
        const uint8_t value = (uint8_t)(i * 255 / (GREYS - 1)), color[4] = {value, value, value, 255};
        const int64_t left = x + width * i / GREYS;
        gw_box_draw(image, left, y + height / 2, x + width * (i + 1) / GREYS - left, height - height / 2,
                    color);
    }
    const uint8_t half[4] = {HALF_LIGHT, HALF_LIGHT, HALF_LIGHT, 255};
    gw_box_draw(image, x, y, width, height / 2, half);
    for (int part = 0; part < 4; part++)
        for (int64_t row = 0; row < height / 2; row++)
            gw_box_draw(image, x + width * (2 * part + 1) / 8, y + row, width / 8, 1,
                        row % 2 ? black : white);
}

/* Up is where the tile's first row is. */
static void draw_arrow(gw_image *image, int64_t x, int64_t y, int64_t size) {
    static const uint8_t color[4] = {255, 210, 60, 255};
    for (int64_t row = 0; row < size; row++)
        gw_box_draw(image, x - row / 2, y + row, row / 2 * 2 + 1, 1, color);
    gw_box_draw(image, x - size / 6, y + size, size / 3, size, color);
}

/* Name, machine and measures, in the middle. */
static void write_names(gw_image *image, const gw_site *site, uint32_t tile) {
    const gw_tile *t = &site->layout.tiles[tile];
    const gw_panel *panel = &site->panels[tile];
    const double *steps[2] = {t->plane.step_x, t->plane.step_y};
    double mm[2];
    for (int i = 0; i < 2; i++)
        mm[i] = sqrt(steps[i][0] * steps[i][0] + steps[i][1] * steps[i][1] + steps[i][2] * steps[i][2]) *
                (i ? t->rectangle.height : t->rectangle.width);
    char text[256];
    snprintf(text, sizeof text,
             "rank %" PRIu32 " on %s%s%s\n%" PRIu32 " x %" PRIu32 " px, %.1f x %.1f mm\npicture %" PRIu32
             ",%" PRIu32,
             tile, panel->host[0] ? panel->host : "this machine", panel->display[0] ? " " : "",
             panel->display, t->rectangle.width, t->rectangle.height, mm[0], mm[1], t->picture[0],
             t->picture[1]);
    uint32_t name[2], lines[2];
    gw_text_measure(t->name, 1, &name[0], &name[1]);
    gw_text_measure(text, 1, &lines[0], &lines[1]);
    const uint32_t wide = image->width, high = image->height;
    uint32_t large = 2 * wide / (5 * name[0]), small = wide / (2 * lines[0]);
    large = large > high / (5 * name[1]) ? high / (5 * name[1]) : large;
    small = small > high / (6 * lines[1]) ? high / (6 * lines[1]) : small;
    large = large ? large : 1;
    small = small ? small : 1;
    const int64_t box[2] = {
        (int64_t)(name[0] * large > lines[0] * small ? name[0] * large : lines[0] * small),
        (int64_t)(name[1] * large + lines[1] * small)};
    const int64_t x = (wide - box[0]) / 2, y = (high - box[1]) / 2, border = 4 * (int64_t)small;
    gw_box_draw(image, x - border, y - border, box[0] + 2 * border, box[1] + 2 * border,
                (const uint8_t[4]){0, 0, 0, 200});
    gw_text_draw(image, (wide - (int64_t)(name[0] * large)) / 2, y, large, white, t->name);
    gw_text_draw(image, (wide - (int64_t)(lines[0] * small)) / 2, y + name[1] * large, small,
                 (const uint8_t[4]){200, 210, 220, 255}, text);
    draw_arrow(image, wide / 2, y - border - high / 10, high / 24 + 1);
}

static void draw_grid(gw_image *image, const gw_site *site, uint32_t tile) {
    const gw_tile *t = &site->layout.tiles[tile];
    const grid g = grid_of(&site->layout, t);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            uint8_t *pixel = image->rgba + ((size_t)y * image->width + x) * 4;
            double light[3];
            grid_light(&g, x, y, light);
            for (int i = 0; i < 3; i++)
                pixel[i] = gw_srgb_code_from_linear(light[i]);
            pixel[3] = 255;
        }
    const uint32_t shorter = image->width < image->height ? image->width : image->height;
    label_lines(image, &g, shorter / 500 + 1);
    draw_greys(image, image->width / 4, image->height - image->height / 8, image->width / 2,
               image->height / 12);
    write_names(image, site, tile);
    mark_border(image);
}

static void draw_colours(gw_image *image) {
    static const uint8_t bars[8][4] = {{255, 255, 255, 255}, {255, 255, 0, 255}, {0, 255, 255, 255},
                                       {0, 255, 0, 255},     {255, 0, 255, 255}, {255, 0, 0, 255},
                                       {0, 0, 255, 255},     {0, 0, 0, 255}};
    const int64_t w = image->width, h = image->height;
    for (int i = 0; i < 8; i++)
        gw_box_draw(image, w * i / 8, 0, w * (i + 1) / 8 - w * i / 8, h * 2 / 3, bars[i]);
    draw_greys(image, 0, h * 2 / 3, w, h - h * 2 / 3);
}

void gw_pattern_draw(gw_pattern_kind kind, const gw_site *site, uint32_t tile, uint8_t *pixels) {
    const gw_rectangle *r = &site->layout.tiles[tile].rectangle;
    gw_image image = {.width = r->width, .height = r->height, .rgba = pixels};
    if (kind == GW_PATTERN_COLOURS) {
        draw_colours(&image);
        return;
    }
    if (kind == GW_PATTERN_GRID) {
        draw_grid(&image, site, tile);
        return;
    }
    gw_box_draw(&image, 0, 0, r->width, r->height, (const uint8_t[4]){12, 20, 34, 255});
    write_names(&image, site, tile);
    mark_border(&image);
}
