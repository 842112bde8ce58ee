/* The drawing of a site: front and top view one above the other on one scale, as engineers draw, and a
 * bird's-eye view beside them. Lengths on the paper are CSS pixels. */
#include "wall/site.h"

#include "render/vector3.h"
#include "wall/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAPER_WIDTH = 1240, LEFT_EDGE = 60, VIEW_WIDTH = 580, BIRD_EDGE = 690, BIRD_WIDTH = 510, TOP = 108 };
static const double tallest = 640; /* front and top view together */

/* Panels of one host have one colour: light tones that the colour-blind also tell apart (after Okabe, Ito).
 */
static const char *const colours[] = {"#bfe0f5", "#fbe0a8", "#bfe8d9", "#f3cfe2",
                                      "#f7cdb8", "#e8e4a0", "#d5d5e8"};
enum { COLOUR_COUNT = sizeof colours / sizeof *colours };

/* A view: paper = origin + scale * (axes . wall mm). */
typedef struct view {
    double axes[2][3];      /* what goes to the right, what goes down */
    double toward[3];       /* direction to whoever looks: what is further along it hides the rest */
    double low[2], high[2]; /* mm in those axes, of all that is shown */
    double scale, origin[2];
} view;

/* Where a tracking device stands and how its axes point. */
typedef struct device {
    double origin[3], tips[3][3];
} device;

typedef struct drawing {
    FILE *svg;
    const gw_site *site;
    double corners[GW_MAXIMUM_TILES][4]
                  [3]; /* round the tile: top left, top right, bottom right, bottom left */
    device devices[GW_TRACKER_SOURCES];
    double low[3], high[3];          /* mm, box of tiles, eye and devices */
    uint32_t host[GW_MAXIMUM_TILES]; /* number of the tile's host, by first appearance */
    uint32_t hosts;
} drawing;

static void widen(drawing *d, const double point[3]) {
    for (int i = 0; i < 3; i++) {
        d->low[i] = fmin(d->low[i], point[i]);
        d->high[i] = fmax(d->high[i], point[i]);
    }
}

/* After the tiles: a device's axes are as long as can be seen. */
static void gather_devices(drawing *d) {
    const gw_tracker_setup *setup = &d->site->trackers;
    const double length = fmax(60, 0.09 * fmax(d->high[0] - d->low[0], d->high[2] - d->low[2]));
    for (uint32_t s = 0; s < setup->source_count; s++) {
        device *at = &d->devices[s];
        memcpy(at->origin, setup->sources[s].room.shift, sizeof at->origin);
        widen(d, at->origin);
        for (int axis = 0; axis < 3; axis++) {
            const double along[3] = {axis == 0, axis == 1, axis == 2};
            gw_room_direction(&setup->sources[s].room, along, at->tips[axis]);
            for (int i = 0; i < 3; i++)
                at->tips[axis][i] = at->origin[i] + length * at->tips[axis][i];
            widen(d, at->tips[axis]);
        }
    }
}

static void gather(drawing *d) {
    const gw_layout *layout = &d->site->layout;
    for (int i = 0; i < 3; i++)
        d->low[i] = d->high[i] = layout->eye[i];
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        double corners[4][3];
        gw_tile_corners(&layout->tiles[t], corners);
        for (int corner = 0; corner < 4; corner++) {
            memcpy(d->corners[t][corner], corners[corner < 2 ? corner : 5 - corner], sizeof *corners);
            widen(d, corners[corner]);
        }
        uint32_t same = 0;
        while (same < t && strcmp(d->site->panels[same].host, d->site->panels[t].host) != 0)
            same++;
        d->host[t] = same < t ? d->host[same] : d->hosts++;
    }
    gather_devices(d);
}

static void view_extent(const drawing *d, view *v) {
    for (int axis = 0; axis < 2; axis++) {
        v->low[axis] = INFINITY;
        v->high[axis] = -INFINITY;
        for (int corner = 0; corner < 8; corner++) {
            const double point[3] = {corner & 1 ? d->high[0] : d->low[0], corner & 2 ? d->high[1] : d->low[1],
                                     corner & 4 ? d->high[2] : d->low[2]};
            v->low[axis] = fmin(v->low[axis], gw_dot(v->axes[axis], point));
            v->high[axis] = fmax(v->high[axis], gw_dot(v->axes[axis], point));
        }
    }
}

static void to_paper(const view *v, const double point[3], double out[2]) {
    for (int axis = 0; axis < 2; axis++)
        out[axis] = v->origin[axis] + v->scale * (gw_dot(v->axes[axis], point) - v->low[axis]);
}

static void put_line(const drawing *d, const view *v, const double from[3], const double to[3],
                     const char *style) {
    double a[2], b[2];
    to_paper(v, from, a);
    to_paper(v, to, b);
    fprintf(d->svg, "<path d=\"M%.2f %.2fL%.2f %.2f\" %s/>\n", a[0], a[1], b[0], b[1], style);
}

/* The tile's name in its middle, as large as fits; left out where it could not be read. */
static void put_name(const drawing *d, const view *v, uint32_t t) {
    const char *name = d->site->layout.tiles[t].name;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, area = 0, at[4][2];
    char attributes[96];
    for (int corner = 0; corner < 4; corner++) {
        to_paper(v, d->corners[t][corner], at[corner]);
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], at[corner][axis]);
            high[axis] = fmax(high[axis], at[corner][axis]);
        }
    }
    for (int corner = 0; corner < 4; corner++) {
        const double *p = at[corner], *q = at[(corner + 1) % 4];
        area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    }
    double filled = fabs(area) / fmax(1e-9, (high[0] - low[0]) * (high[1] - low[1]));
    double size = fmin(15, fmin((high[0] - low[0]) * filled / (0.66 * (double)strlen(name) + 0.6),
                                0.7 * filled * (high[1] - low[1])));
    if (size < 4)
        return;
    snprintf(attributes, sizeof attributes, "text-anchor=\"middle\" font-size=\"%.1f\"", size);
    double x = 0.5 * (low[0] + high[0]), y = 0.5 * (low[1] + high[1]) + 0.35 * size, eye[2];
    to_paper(v, d->site->layout.eye, eye);
    if (fabs(eye[0] - x) < 40 && fabs(eye[1] - y) < 0.5 * size + 8) /* beside the eye, not under it */
        y = fmin(high[1] - 0.3 * size, eye[1] + 8 + size);
    gw_svg_text(d->svg, x, y, attributes, name);
}

static double depth_of(const drawing *d, const view *v, uint32_t t) {
    double sum = 0;
    for (int corner = 0; corner < 4; corner++)
        sum += gw_dot(v->toward, d->corners[t][corner]);
    return sum;
}

/* From the furthest to the nearest. Backs of panels are grey. */
static void put_tiles(const drawing *d, const view *v) {
    uint32_t order[GW_MAXIMUM_TILES], count = d->site->layout.tile_count;
    for (uint32_t t = 0; t < count; t++) {
        uint32_t at = t;
        for (; at > 0 && depth_of(d, v, order[at - 1]) > depth_of(d, v, t); at--)
            order[at] = order[at - 1];
        order[at] = t;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = order[i];
        double across[3], up[3], front[3], at[2];
        for (int k = 0; k < 3; k++) {
            across[k] = d->corners[t][1][k] - d->corners[t][0][k];
            up[k] = d->corners[t][0][k] - d->corners[t][3][k];
        }
        gw_cross(across, up, front);
        double facing = gw_dot(front, v->toward) / fmax(1e-9, gw_length(front));
        const char *fill = facing < -1e-3 ? "#9a9a9a" : colours[d->host[t] % COLOUR_COUNT];
        fputs("<path d=\"", d->svg);
        for (int corner = 0; corner < 4; corner++) {
            to_paper(v, d->corners[t][corner], at);
            fprintf(d->svg, "%c%.2f %.2f", corner ? 'L' : 'M', at[0], at[1]);
        }
        /* Edge-on, a panel is a line. */
        fprintf(d->svg,
                "Z\" fill=\"%s\" stroke=\"#33485c\" stroke-width=\"%s\" stroke-linejoin=\"round\"/>\n", fill,
                fabs(facing) < 0.02 ? "3" : "1");
        if (facing > 0.02)
            put_name(d, v, t);
    }
}

static void put_eye(const drawing *d, const view *v) {
    double at[2];
    to_paper(v, d->site->layout.eye, at);
    fprintf(d->svg,
            "<path d=\"M%.1f %.1fq8 -9 16 0q-8 9 -16 0z\" fill=\"white\" stroke=\"#b3261e\" "
            "stroke-width=\"1.4\"/>\n<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.6\" fill=\"#b3261e\"/>\n",
            at[0] - 8, at[1], at[0], at[1]);
    gw_svg_text(d->svg, at[0] + 12, at[1] + 4, "fill=\"#b3261e\" font-size=\"12\"", "eye");
}

/* Origin and axes of each tracking device, as it names them. */
static void put_devices(const drawing *d, const view *v) {
    static const char *const strokes[] = {"stroke=\"#c0392b\" stroke-width=\"1.6\"",
                                          "stroke=\"#1e8449\" stroke-width=\"1.6\"",
                                          "stroke=\"#1f4fa3\" stroke-width=\"1.6\""};
    static const char *const names[] = {"x", "y", "z"};
    for (uint32_t s = 0; s < d->site->trackers.source_count; s++) {
        const device *at = &d->devices[s];
        double origin[2], tip[2];
        double side = 0; /* the name stands where no axis points */
        char text[48];
        to_paper(v, at->origin, origin);
        for (int axis = 0; axis < 3; axis++) {
            put_line(d, v, at->origin, at->tips[axis], strokes[axis]);
            to_paper(v, at->tips[axis], tip);
            const double x = tip[0] - origin[0], y = tip[1] - origin[1], length = sqrt(x * x + y * y);
            side -= x;
            if (length > 6) /* else it points at whoever looks */
                gw_svg_text(d->svg, tip[0] + 6 * x / length - 3, tip[1] + 6 * y / length + 3,
                            "font-size=\"10\"", names[axis]);
        }
        fprintf(d->svg, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"#222\"/>\n", origin[0], origin[1]);
        snprintf(text, sizeof text, "%.40s", d->site->trackers.sources[s].spec);
        gw_svg_text(d->svg, origin[0] + (side < 0 ? -7 : 7), origin[1] + 13,
                    side < 0 ? "text-anchor=\"end\" font-size=\"10\"" : "font-size=\"10\"", text);
    }
}

static void put_title(const drawing *d, const view *v, const char *title) {
    gw_svg_text(d->svg, LEFT_EDGE, v->origin[1] - 24, "font-size=\"13\" font-weight=\"bold\"", title);
}

/* A round length of about a quarter of the view: 1, 2 or 5 times a power of ten. */
static double round_length(double about) {
    double decade = pow(10, floor(log10(about)));
    double digit = about / decade;
    return decade * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

static void put_scale(const drawing *d, double x, double y, double scale, double width) {
    double length = round_length(0.35 * width / scale);
    char text[48];
    fprintf(
        d->svg,
        "<path d=\"M%.1f %.1fv8m0 -4h%.2fm0 -4v8\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.4\"/>\n", x,
        y - 4, length * scale);
    snprintf(text, sizeof text, "%g mm", length);
    gw_svg_text(d->svg, x + length * scale + 8, y + 4, "font-size=\"12\"", text);
}

/* Gaps between neighbours of the first row and the first column of the picture, written where they are. */
static void put_gaps(const drawing *d, const view *v, int axis) {
    const gw_layout *layout = &d->site->layout;
    double last = -INFINITY;
    for (uint32_t a = 0; a < layout->tile_count; a++)
        for (uint32_t b = 0; b < layout->tile_count; b++) {
            const gw_tile *first = &layout->tiles[a], *next = &layout->tiles[b];
            const uint32_t size[2] = {first->rectangle.width, first->rectangle.height};
            if (a == b || first->picture[1 - axis] != 0 || next->picture[1 - axis] != 0 ||
                first->picture[axis] + size[axis] != next->picture[axis])
                continue;
            /* From the right edge to the next one's left, or from the bottom to the next one's top. */
            const double *from = d->corners[a][axis ? 3 : 1], *to = d->corners[b][0];
            double between[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, at[2];
            char text[32], attributes[96];
            double gap = gw_length(between);
            to_paper(v, from, at);
            if (gap < 0.05 || fabs(at[axis] - last) < 30)
                continue;
            last = at[axis];
            snprintf(text, sizeof text, "%.4g", gap);
            snprintf(attributes, sizeof attributes, "text-anchor=\"%s\" font-size=\"10\" fill=\"#555\"",
                     axis ? "end" : "middle");
            gw_svg_text(d->svg, at[0] - (axis ? 6 : 0), at[1] + (axis ? 3 : -5), attributes, text);
        }
}

/* From the eye to the outermost tiles, and the angle that the wall fills. */
static void put_sight(const drawing *d, const view *v, double y) {
    const gw_layout *layout = &d->site->layout;
    const double *eye = layout->eye, *ends[2] = {NULL, NULL};
    double angles[2] = {INFINITY, -INFINITY};
    char text[64];
    for (uint32_t t = 0; t < layout->tile_count; t++)
        for (int corner = 0; corner < 4; corner++) {
            const double *point = d->corners[t][corner];
            double angle = atan2(point[0] - eye[0], eye[2] - point[2]);
            if (angle < angles[0]) {
                angles[0] = angle;
                ends[0] = point;
            }
            if (angle > angles[1]) {
                angles[1] = angle;
                ends[1] = point;
            }
        }
    for (int i = 0; i < 2; i++)
        put_line(d, v, eye, ends[i], "stroke=\"#b3261e\" stroke-width=\"0.8\" stroke-dasharray=\"5 4\"");
    snprintf(text, sizeof text, "%.0f degrees across, seen from above",
             (angles[1] - angles[0]) * 57.29577951308232);
    gw_svg_text(d->svg, LEFT_EDGE + VIEW_WIDTH, y, "text-anchor=\"end\" font-size=\"12\" fill=\"#b3261e\"",
                text);
}

/* The floor of the box of wall and viewer: its edge, and lines a round distance apart. */
static void put_floor(const drawing *d, const view *v) {
    const double *low = d->low, *high = d->high;
    double step = round_length(fmax(high[0] - low[0], high[2] - low[2]) / 3);
    for (double x = floor(low[0] / step) * step; x < high[0] + step; x += step) {
        double at = fmin(high[0], fmax(low[0], x));
        put_line(d, v, (const double[3]){at, low[1], low[2]}, (const double[3]){at, low[1], high[2]},
                 "stroke=\"#ddd\"");
    }
    for (double z = floor(low[2] / step) * step; z < high[2] + step; z += step) {
        double at = fmin(high[2], fmax(low[2], z));
        put_line(d, v, (const double[3]){low[0], low[1], at}, (const double[3]){high[0], low[1], at},
                 "stroke=\"#ddd\"");
    }
}

/* Seen from behind the viewer's right shoulder and above. */
static void put_bird(const drawing *d, double height) {
    const double turn = 0.6, fall = 0.5; /* radians */
    view v = {
        .axes = {{cos(turn), 0, -sin(turn)}, {sin(turn) * sin(fall), -cos(fall), cos(turn) * sin(fall)}},
        .toward = {sin(turn) * cos(fall), sin(fall), cos(turn) * cos(fall)}};
    view_extent(d, &v);
    v.scale = fmin(BIRD_WIDTH / fmax(1, v.high[0] - v.low[0]), (height - 30) / fmax(1, v.high[1] - v.low[1]));
    v.origin[0] = BIRD_EDGE + 0.5 * (BIRD_WIDTH - v.scale * (v.high[0] - v.low[0]));
    v.origin[1] = TOP + 0.5 * (height - v.scale * (v.high[1] - v.low[1]));
    gw_svg_text(d->svg, BIRD_EDGE, TOP - 24, "font-size=\"13\" font-weight=\"bold\"", "Bird's-eye view");
    put_floor(d, &v);
    put_tiles(d, &v);
    const double *eye = d->site->layout.eye, foot[3] = {eye[0], d->low[1], eye[2]};
    put_line(d, &v, eye, foot, "stroke=\"#b3261e\" stroke-width=\"0.8\" stroke-dasharray=\"2 3\"");
    put_devices(d, &v);
    put_eye(d, &v);
}

static void put_hosts(const drawing *d, double y) {
    double x = BIRD_EDGE;
    char text[96];
    for (uint32_t host = 0; host < d->hosts && d->hosts > 1 && x < PAPER_WIDTH - 60; host++) {
        const char *name = "";
        uint32_t tiles = 0;
        for (uint32_t t = 0; t < d->site->layout.tile_count; t++)
            if (d->host[t] == host) {
                tiles++;
                name = d->site->panels[t].host;
            }
        snprintf(text, sizeof text, "%.40s (%u)", name[0] ? name : "here", tiles);
        fprintf(d->svg,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"12\" fill=\"%s\" stroke=\"#33485c\"/>\n",
                x, y - 10, colours[host % COLOUR_COUNT]);
        gw_svg_text(d->svg, x + 17, y, "font-size=\"12\"", text);
        x += 34 + 7.0 * (double)strlen(text);
    }
}

static void put_heading(const drawing *d, const char *title) {
    const gw_layout *layout = &d->site->layout;
    char text[160];
    gw_svg_text(d->svg, LEFT_EDGE, 34, "font-size=\"19\" font-weight=\"bold\"", title);
    snprintf(text, sizeof text, "%u tile%s, %u x %u px, %.0f x %.0f mm from the front, eye at [%g, %g, %g]",
             layout->tile_count, layout->tile_count == 1 ? "" : "s", layout->picture[0], layout->picture[1],
             layout->size[0], layout->size[1], layout->eye[0], layout->eye[1], layout->eye[2]);
    gw_svg_text(d->svg, LEFT_EDGE, 55, "font-size=\"12\" fill=\"#555\"", text);
}

static void put_all(drawing *d, const char *title) {
    view front = {.axes = {{1, 0, 0}, {0, -1, 0}}, .toward = {0, 0, 1}};
    view top = {.axes = {{1, 0, 0}, {0, 0, 1}}, .toward = {0, 1, 0}};
    gather(d);
    view_extent(d, &front);
    view_extent(d, &top);
    double size[3] = {fmax(1, d->high[0] - d->low[0]), d->high[1] - d->low[1], d->high[2] - d->low[2]};
    front.scale = top.scale = fmin(VIEW_WIDTH / size[0], tallest / fmax(1, size[1] + size[2]));
    double left = LEFT_EDGE + 0.5 * (VIEW_WIDTH - front.scale * size[0]);
    front.origin[0] = top.origin[0] = left;
    front.origin[1] = TOP;
    top.origin[1] = TOP + front.scale * size[1] + 62;
    double end = fmax(TOP + 360, top.origin[1] + top.scale * size[2]), paper = end + 64;
    fprintf(d->svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" viewBox=\"0 0 %d %.0f\" "
            "font-family=\"sans-serif\" fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"white\"/>\n",
            PAPER_WIDTH, paper, PAPER_WIDTH, paper);
    put_heading(d, title);
    put_title(d, &front, "Front (x to the right, y up; gaps in mm)");
    put_tiles(d, &front);
    put_gaps(d, &front, 0);
    put_gaps(d, &front, 1);
    put_devices(d, &front);
    put_eye(d, &front);
    put_title(d, &top, "Top (x to the right, z down to the viewer)");
    put_sight(d, &top, top.origin[1] - 24);
    put_tiles(d, &top);
    put_devices(d, &top);
    put_eye(d, &top);
    put_bird(d, end - TOP);
    put_scale(d, LEFT_EDGE, paper - 26, front.scale, VIEW_WIDTH);
    put_hosts(d, paper - 22);
    fputs("</svg>\n", d->svg);
}

gw_code gw_site_draw(const gw_site *site, const char *title, char **svg, size_t *size, gw_error *error) {
    drawing *d = calloc(1, sizeof *d);
    *svg = NULL;
    if (d)
        d->svg = open_memstream(svg, size);
    if (!d || !d->svg) {
        free(d);
        return gw_fail(error, GW_MACHINE, "memory is out while drawing a site");
    }
    d->site = site;
    put_all(d, title);
    int lost = ferror(d->svg) != 0;
    lost |= fclose(d->svg) != 0;
    free(d);
    return lost ? gw_fail(error, GW_MACHINE, "memory is out while drawing a site") : GW_OK;
}
