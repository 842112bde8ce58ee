#include "wall/wall_view_panels.h"

#include "wall/layout_look.h"
#include "wall/overlay_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint8_t background[4] = {16, 18, 22, 255}, border[4] = {70, 76, 88, 255},
                     bright[4] = {236, 238, 242, 255}, dim[4] = {150, 156, 168, 255},
                     tile_color[4] = {120, 170, 255, 255}, eye_color[4] = {255, 255, 255, 255},
                     gaze_color[4] = {255, 196, 64, 255};

static void fill(gw_image *image, const uint8_t color[4]) {
    gw_box_draw(image, 0, 0, image->width, image->height, color);
}

static void frame(gw_image *image) {
    const int64_t width = image->width, height = image->height;
    fill(image, border);
    gw_box_draw(image, 1, 1, width - 2, height - 2, background);
}

uint32_t gw_status_height(uint32_t scale) {
    return (GW_TEXT_LINE + 6) * scale;
}

void gw_status_draw(gw_image *image, uint32_t scale, const char *text) {
    fill(image, background);
    gw_box_draw(image, 0, 0, image->width, 1, border);
    gw_text_draw(image, 4 * scale, 4 * scale, scale, bright, text);
}

void gw_help_draw(gw_image *image, uint32_t scale, const char *text) {
    frame(image);
    gw_text_draw(image, 8 * scale, 8 * scale, scale, bright, text);
}

/* --- bird's eye
 * ------------------------------------------------------------------------------------------------- */

/* Room seen from above: x to the right, z, towards the viewers, downwards. */
typedef struct chart {
    gw_image *image;
    uint32_t scale;
    double least[2], greatest[2]; /* mm, of x and z */
    double pitch;                 /* px per mm */
    double origin[2];             /* px, where least is */
} chart;

static void include(chart *c, double x, double z) {
    const double at[2] = {x, z};
    for (int k = 0; k < 2; k++) {
        c->least[k] = fmin(c->least[k], at[k]);
        c->greatest[k] = fmax(c->greatest[k], at[k]);
    }
}

/* Corner 0 to 3 of a tile, in an order that goes round it. */
static void corner_of(const gw_tile *tile, int corner, double out[2]) {
    const gw_rectangle *r = &tile->rectangle;
    const double x = r->x + (corner == 1 || corner == 2 ? (double)r->width : 0),
                 y = r->y + (corner >= 2 ? (double)r->height : 0);
    out[0] = tile->plane.corner[0] + x * tile->plane.step_x[0] + y * tile->plane.step_y[0];
    out[1] = tile->plane.corner[2] + x * tile->plane.step_x[2] + y * tile->plane.step_y[2];
}

static void fit(chart *c, const gw_layout *layout, const gw_frame_state *state) {
    c->least[0] = c->least[1] = INFINITY;
    c->greatest[0] = c->greatest[1] = -INFINITY;
    for (uint32_t i = 0; i < layout->tile_count; i++)
        for (int k = 0; k < 4; k++) {
            double at[2];
            corner_of(&layout->tiles[i], k, at);
            include(c, at[0], at[1]);
        }
    include(c, state->eye[0], state->eye[2]);
    include(c, layout->eye[0], layout->eye[2]);
    for (uint32_t i = 0; i < state->gaze_count; i++)
        include(c, (double)state->gazes[i].eye[0], (double)state->gazes[i].eye[2]);
    const double margin = 10.0 * c->scale, foot = (GW_TEXT_LINE + 6.0) * c->scale;
    const double room[2] = {c->image->width - 2 * margin, c->image->height - 2 * margin - foot};
    const double extent[2] = {fmax(c->greatest[0] - c->least[0], 1), fmax(c->greatest[1] - c->least[1], 1)};
    c->pitch = fmin(room[0] / extent[0], room[1] / extent[1]);
    for (int k = 0; k < 2; k++)
        c->origin[k] = margin + 0.5 * (room[k] - c->pitch * extent[k]);
}

static void place(const chart *c, double x, double z, double out[2]) {
    out[0] = c->origin[0] + c->pitch * (x - c->least[0]);
    out[1] = c->origin[1] + c->pitch * (z - c->least[1]);
}

static void draw_line(const chart *c, const double from[2], const double to[2], int64_t thick,
                      const uint8_t color[4]) {
    const double x = to[0] - from[0], y = to[1] - from[1];
    const int steps = (int)fmin(ceil(fmax(fabs(x), fabs(y))), 8192);
    for (int i = 0; i <= steps; i++) {
        const double share = steps ? (double)i / steps : 0;
        gw_box_draw(c->image, (int64_t)floor(from[0] + share * x) - thick / 2,
                    (int64_t)floor(from[1] + share * y) - thick / 2, thick, thick, color);
    }
}

static void draw_spot(const chart *c, const double at[2], int64_t side, const uint8_t color[4]) {
    gw_box_draw(c->image, (int64_t)floor(at[0]) - side / 2, (int64_t)floor(at[1]) - side / 2, side, side,
                color);
}

static void draw_tiles(const chart *c, const gw_layout *layout) {
    for (uint32_t i = 0; i < layout->tile_count; i++)
        for (int k = 0; k < 4; k++) {
            double a[2], b[2], from[2], to[2];
            corner_of(&layout->tiles[i], k, a);
            corner_of(&layout->tiles[i], (k + 1) % 4, b);
            place(c, a[0], a[1], from);
            place(c, b[0], b[1], to);
            draw_line(c, from, to, c->scale, tile_color);
            /* Where one tile ends and the next begins. */
            draw_spot(c, from, 3 * (int64_t)c->scale, tile_color);
        }
}

/* From a viewer's eye to the point of the wall that is looked at, or 1 m far where that is none. */
static void draw_gaze(const chart *c, const gw_layout *layout, const gw_gaze *gaze) {
    double eye[3], direction[3], from[2], to[2], framed[2];
    uint32_t tile;
    double reach = 1000;
    for (int k = 0; k < 3; k++) {
        eye[k] = (double)gaze->eye[k];
        direction[k] = (double)gaze->direction[k];
    }
    if (gw_layout_meet(layout, eye, direction, &tile, framed, &reach))
        reach = fmin(reach, 1e6);
    place(c, eye[0], eye[2], from);
    place(c, eye[0] + reach * direction[0], eye[2] + reach * direction[2], to);
    draw_line(c, from, to, c->scale, gaze_color);
    draw_spot(c, from, 5 * (int64_t)c->scale, gaze_color);
}

/* The longest of 0.1, 0.2, 0.5, 1, ... m that takes less than a third of the width. */
static void draw_measure(const chart *c) {
    double metres = 0.1;
    for (int i = 1; c->pitch * 1000 * metres * (i % 3 == 2 ? 2.5 : 2) < c->image->width / 3.0 && i < 20; i++)
        metres *= i % 3 == 2 ? 2.5 : 2;
    char text[32];
    snprintf(text, sizeof text, "%g m", metres);
    const double y = c->image->height - 9.0 * c->scale, x = c->image->width - 10.0 * c->scale;
    const double from[2] = {x - c->pitch * 1000 * metres, y}, to[2] = {x, y};
    uint32_t width, height;
    gw_text_measure(text, c->scale, &width, &height);
    draw_line(c, from, to, c->scale, dim);
    gw_text_draw(c->image, (int64_t)from[0] - (int64_t)width - 4 * c->scale, (int64_t)y - 4 * c->scale,
                 c->scale, dim, text);
}

void gw_birdseye_draw(gw_image *image, uint32_t scale, const gw_layout *layout, const gw_frame_state *state) {
    chart c = {.image = image, .scale = scale};
    double eye[2];
    frame(image);
    fit(&c, layout, state);
    draw_tiles(&c, layout);
    for (uint32_t i = 0; i < state->gaze_count; i++)
        draw_gaze(&c, layout, &state->gazes[i]);
    place(&c, state->eye[0], state->eye[2], eye);
    draw_spot(&c, eye, 3 * (int64_t)scale, eye_color);
    gw_text_draw(image, 6 * scale, image->height - 13 * scale, scale, dim, "from above");
    draw_measure(&c);
}
