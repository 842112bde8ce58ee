/* The drawing of a recording: position (or angles of a gaze) and speed of every sensor over time, with the
 * times when nothing came; and the gazes on the picture of the wall with its bezels. Lengths on the paper are
 * CSS pixels. */
#include "wall/replay.h"

#include "base/portable_math.h"
#include "tracking/quaternion.h"
#include "wall/layout_look.h"
#include "wall/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PAPER = 1080,
    LEFT = 80,
    RIGHT = 930, /* of the axes of time */
    TOP = 90,
    CURVES = 150, /* heights */
    SPEEDS = 70,
    PANEL = 300,
    SENSORS = 16, /* that are drawn */
    WALL_HEIGHT = 480
};

/* Colours that the colour-blind tell apart (Okabe and Ito). */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};
static const double DEGREES = 57.295779513082320877;

typedef struct drawing {
    FILE *svg;
    const gw_recording *recording;
    gw_replay_views *views;
    double begin, end; /* s */
} drawing;

/* One axis of values above the axis of time. */
typedef struct chart {
    double top, height, low, high;
} chart;

static double across(const drawing *d, double seconds) {
    return LEFT + (seconds - d->begin) / (d->end - d->begin) * (RIGHT - LEFT);
}

static double down(const chart *c, double value) {
    return c->top + c->height * (1.0 - (value - c->low) / (c->high - c->low));
}

static int is_of(const gw_recording_channel *channel, const gw_recorded_event *recorded) {
    return recorded->sender == channel->sender && recorded->event.kind == channel->kind &&
           recorded->event.sensor == channel->sensor && recorded->event.quality >= 0.0;
}

enum { SPEED = 3 };

/* A position's axis is drawn about its middle: a head that sways is seen to. */
static double middle_of(const gw_recording_channel *channel, int axis) {
    return channel->kind == GW_EVENT_POSE ? 0.5 * (channel->low[axis] + channel->high[axis]) : 0.0;
}

/* Axis 0 to 2 of a position in metres, 0 and 1 of a gaze in degrees (to the right, up); or the speed. */
static double value_of(const gw_recording_channel *channel, const gw_tracking_event *event,
                       const gw_tracking_event *before, int which) {
    if (which == SPEED)
        return before != NULL ? gw_recorded_speed(before, event) : 0.0;
    if (event->kind == GW_EVENT_POSE)
        return event->of.pose.position[which] - middle_of(channel, which);
    const double *g = event->of.gaze.direction;
    return DEGREES * (which == 0 ? gw_atan2(g[0], -g[2]) : gw_atan2(g[1], sqrt(g[0] * g[0] + g[2] * g[2])));
}

/* Nothing came for longer than three medians and 50 ms. */
static int is_gap(const gw_recording_channel *channel, const gw_tracking_event *before,
                  const gw_tracking_event *event) {
    const int64_t interval = event->arrival - before->arrival;
    return interval > 50000000 && interval / 3 > channel->interval_median;
}

static void widen(chart *c, const drawing *d, const gw_recording_channel *channel, int which) {
    const gw_tracking_event *before = NULL;
    for (size_t i = 0; i < d->recording->count; i++) {
        const gw_recorded_event *recorded = &d->recording->events[i];
        if (!is_of(channel, recorded))
            continue;
        const double value = value_of(channel, &recorded->event, before, which);
        c->low = fmin(c->low, value);
        c->high = fmax(c->high, value);
        before = &recorded->event;
    }
}

/* 1, 2 or 5 times a power of ten, so that about `parts` of them fit. */
static double round_step(double range, double parts) {
    const double about = range / parts, decade = pow(10, floor(log10(about))), digit = about / decade;
    return decade * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

static void put_path(const drawing *d, double x0, double y0, double x1, double y1, const char *style) {
    fprintf(d->svg, "<path d=\"M%.1f %.1fL%.1f %.1f\" %s/>\n", x0, y0, x1, y1, style);
}

/* Lines and numbers of the values; of the time too, if its numbers go below. */
static void put_axes(const drawing *d, const chart *c, const char *unit, int with_time) {
    char text[48];
    const double step = round_step(c->high - c->low, c->height / 40.0);
    for (double value = ceil(c->low / step) * step; value <= c->high + 1e-9 * step; value += step) {
        put_path(d, LEFT, down(c, value), RIGHT, down(c, value), "stroke=\"#e2e2e2\"");
        snprintf(text, sizeof text, "%.6g", fabs(value) < 1e-9 * step ? 0.0 : value);
        gw_svg_text(d->svg, LEFT - 8, down(c, value) + 4, "text-anchor=\"end\"", text);
    }
    const double tick = round_step(d->end - d->begin, 10.0);
    for (double at = ceil(d->begin / tick) * tick; at <= d->end; at += tick) {
        put_path(d, across(d, at), c->top, across(d, at), c->top + c->height, "stroke=\"#e2e2e2\"");
        snprintf(text, sizeof text, "%.6g s", at);
        if (with_time)
            gw_svg_text(d->svg, across(d, at), c->top + c->height + 16, "text-anchor=\"middle\"", text);
    }
    fprintf(d->svg,
            "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" stroke=\"#888\" fill=\"none\"/>\n", LEFT,
            c->top, RIGHT - LEFT, c->height);
    char turned[96];
    snprintf(turned, sizeof turned, "text-anchor=\"middle\" transform=\"rotate(-90 18 %.1f)\"",
             c->top + 0.5 * c->height);
    gw_svg_text(d->svg, 18, c->top + 0.5 * c->height, turned, unit);
}

/* What lies in one column of the paper is drawn as its range, so the path stays short however long the track.
 */
typedef struct curve {
    int column, started;
    double low, high;
    char command;
} curve;

static void put_column(const drawing *d, const chart *c, curve *k) {
    if (!k->started)
        return;
    fprintf(d->svg, "%c%d %.1f", k->command, k->column, down(c, k->low));
    if (k->high > k->low)
        fprintf(d->svg, "L%d %.1f", k->column, down(c, k->high));
    k->command = 'L';
    k->started = 0;
}

static void put_curve(const drawing *d, const chart *c, const gw_recording_channel *channel, int which,
                      const char *colour) {
    const gw_tracking_event *before = NULL;
    curve k = {.command = 'M'};
    fputs("<path d=\"", d->svg);
    for (size_t i = 0; i < d->recording->count; i++) {
        const gw_recorded_event *recorded = &d->recording->events[i];
        if (!is_of(channel, recorded))
            continue;
        const gw_tracking_event *event = &recorded->event;
        const double value = value_of(channel, event, before, which);
        const int column = (int)across(d, (double)event->arrival * 1e-9);
        const int gap = before != NULL && is_gap(channel, before, event);
        if (column != k.column || gap)
            put_column(d, c, &k);
        if (gap)
            k.command = 'M';
        k.low = k.started ? fmin(k.low, value) : value;
        k.high = k.started ? fmax(k.high, value) : value;
        k.column = column;
        k.started = 1;
        before = event;
    }
    put_column(d, c, &k);
    fprintf(d->svg, "\" stroke=\"%s\" fill=\"none\" stroke-linejoin=\"round\"/>\n", colour);
}

/* Grey where nothing came. */
static void put_gaps(const drawing *d, double top, double height, const gw_recording_channel *channel) {
    const gw_tracking_event *before = NULL;
    double drawn = -1.0;
    for (size_t i = 0; i < d->recording->count; i++) {
        const gw_recorded_event *recorded = &d->recording->events[i];
        if (!is_of(channel, recorded))
            continue;
        if (before != NULL && is_gap(channel, before, &recorded->event)) {
            const double x0 = across(d, (double)before->arrival * 1e-9);
            const double x1 = across(d, (double)recorded->event.arrival * 1e-9);
            if (x1 > drawn + 0.5)
                fprintf(d->svg,
                        "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#d9d9d9\"/>\n", x0,
                        top, fmax(1.0, x1 - x0), height);
            drawn = fmax(drawn, x1);
        }
        before = &recorded->event;
    }
}

static void put_legend(const drawing *d, double top, const char *const *names, int count) {
    for (int i = 0; i < count; i++) {
        const double y = top + 12 + 18 * i;
        fprintf(d->svg, "<path d=\"M%d %.1fh22\" stroke=\"%s\" stroke-width=\"2\"/>\n", RIGHT + 14, y - 4,
                colours[i]);
        gw_svg_text(d->svg, RIGHT + 42, y, "fill=\"#222\"", names[i]);
    }
    const double y = top + 12 + 18 * count;
    fprintf(d->svg, "<rect x=\"%d\" y=\"%.1f\" width=\"22\" height=\"10\" fill=\"#d9d9d9\"/>\n", RIGHT + 14,
            y - 9);
    gw_svg_text(d->svg, RIGHT + 42, y, "fill=\"#222\"", "nothing usable");
}

static chart new_chart(double top, double height) {
    return (chart){.top = top, .height = height, .low = INFINITY, .high = -INFINITY};
}

/* Room above and below the curves; some height even for one that stands still. */
static void settle(chart *c, double least) {
    if (c->low > c->high)
        c->low = c->high = 0.0;
    const double margin = fmax(0.06 * (c->high - c->low), 0.5 * least);
    c->low -= margin;
    c->high += margin;
}

static void put_sensor(const drawing *d, const gw_recording_channel *channel, double top) {
    static const char *const axes[] = {"x", "y", "z"}, *const angles[] = {"to the right", "up"};
    char texts[3][48];
    const char *names[3];
    const int pose = channel->kind == GW_EVENT_POSE, curves = pose ? 3 : 2;
    char title[256];
    snprintf(title, sizeof title, "%.100s: %s %d, %.1f Hz, %llu gaps, %llu jumps, %llu not tracked",
             d->recording->senders[channel->sender], pose ? "sensor" : "gaze of viewer", (int)channel->sensor,
             channel->rate, (unsigned long long)channel->gaps, (unsigned long long)channel->jumps,
             (unsigned long long)channel->untracked);
    gw_svg_text(d->svg, LEFT, top - 10, "font-size=\"13\" font-weight=\"bold\"", title);
    for (int axis = 0; axis < curves; axis++) {
        snprintf(texts[axis], sizeof texts[axis], "%s about %.3f", axes[axis], middle_of(channel, axis));
        names[axis] = pose ? texts[axis] : angles[axis];
    }
    chart values = new_chart(top, CURVES), speeds = new_chart(top + CURVES + 12, SPEEDS);
    for (int axis = 0; axis < curves; axis++)
        widen(&values, d, channel, axis);
    widen(&speeds, d, channel, SPEED);
    settle(&values, pose ? 0.02 : 0.5);
    settle(&speeds, pose ? 0.01 : 1.0);
    speeds.low = 0.0;
    put_gaps(d, top, CURVES + 12 + SPEEDS, channel);
    put_axes(d, &values, pose ? "m" : "degrees", 0);
    put_axes(d, &speeds, pose ? "m/s" : "degrees/s", 1);
    for (int axis = 0; axis < curves; axis++)
        put_curve(d, &values, channel, axis, colours[axis]);
    put_curve(d, &speeds, channel, SPEED, "#555");
    put_legend(d, top, names, curves);
}

/* --- the gazes on the wall */

typedef struct wall_view {
    const gw_layout *layout;
    double left, top, scale; /* paper = left + scale * framed pixel */
} wall_view;

static void put_tiles(const drawing *d, const wall_view *v) {
    for (uint32_t t = 0; t < v->layout->tile_count; t++) {
        const gw_tile *tile = &v->layout->tiles[t];
        const double x = v->left + v->scale * tile->framed[0], y = v->top + v->scale * tile->framed[1];
        fprintf(d->svg,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#eef4f9\" "
                "stroke=\"#33485c\"/>\n",
                x, y, v->scale * tile->rectangle.width, v->scale * tile->rectangle.height);
        if (v->layout->tile_count > 1)
            gw_svg_text(d->svg, x + 5, y + 13, "font-size=\"10\" fill=\"#789\"", tile->name);
    }
}

/* The path of one viewer's gaze as a run would take it, on the wall; how much of it met the wall comes back,
 * below 0: nobody's gaze is known. */
static double put_gaze(const drawing *d, const wall_view *v, uint32_t viewer, const char *colour) {
    const int64_t gap = 100000000; /* ns without a gaze, over which no line is drawn */
    double last[2] = {-1e9, -1e9};
    int64_t before = INT64_MIN;
    uint64_t met = 0, all = 0;
    char command = 'M';
    fputs("<path d=\"", d->svg);
    for (size_t i = 0; i < d->recording->count; i++) {
        const int64_t time = d->recording->events[i].event.arrival;
        const gw_viewer_view view = gw_replay_viewer(d->views, viewer, time);
        const int64_t arrival = time - view.gaze_wait;
        if (!view.has_gaze || arrival == before)
            continue;
        if (all++ == 0 || arrival - before > gap)
            command = 'M';
        before = arrival;
        double framed[2], distance;
        uint32_t tile;
        if (!gw_layout_meet(v->layout, view.gaze_origin, view.gaze_direction, &tile, framed, &distance)) {
            command = 'M';
            continue;
        }
        met++;
        const double x = v->left + v->scale * framed[0], y = v->top + v->scale * framed[1];
        if (command == 'L' && fabs(x - last[0]) < 0.7 && fabs(y - last[1]) < 0.7)
            continue; /* nothing would be seen of it */
        fprintf(d->svg, "%c%.1f %.1f", command, x, y);
        last[0] = x;
        last[1] = y;
        command = 'L';
    }
    fprintf(d->svg, "\" stroke=\"%s\" fill=\"none\" stroke-opacity=\"0.75\" stroke-linejoin=\"round\"/>\n",
            colour);
    return all > 0 ? (double)met / (double)all : -1;
}

/* CSS pixels per framed pixel. */
static double wall_scale(const gw_layout *layout) {
    return fmin((double)(RIGHT - LEFT) / layout->framed[0], (double)WALL_HEIGHT / layout->framed[1]);
}

static void put_wall(const drawing *d, const gw_site *site, double top) {
    const gw_layout *layout = &site->layout;
    const wall_view v = {.layout = layout, .left = LEFT, .top = top, .scale = wall_scale(layout)};
    gw_svg_text(d->svg, LEFT, top - 10, "font-size=\"13\" font-weight=\"bold\"", "Gazes on the wall");
    put_tiles(d, &v);
    int drawn = 0;
    for (uint32_t viewer = 0; viewer < d->views->setup.viewer_count; viewer++) {
        const char *colour = colours[drawn % 4];
        const double met = put_gaze(d, &v, viewer, colour), y = top + 12 + 18 * drawn;
        char text[96];
        if (met < 0)
            continue;
        drawn++;
        snprintf(text, sizeof text, "viewer %u, %.0f %%", (unsigned)viewer, 100.0 * met);
        fprintf(d->svg, "<path d=\"M%d %.1fh22\" stroke=\"%s\" stroke-width=\"2\"/>\n", RIGHT + 14, y - 4,
                colour);
        gw_svg_text(d->svg, RIGHT + 42, y, "fill=\"#222\"", text);
    }
    if (drawn == 0)
        gw_svg_text(d->svg, RIGHT + 14, top + 12, "fill=\"#222\"", "no gaze");
}

static void put_all(const drawing *d, const gw_recording_statistics *statistics, const gw_site *site) {
    uint32_t shown = 0;
    for (uint32_t i = 0; i < statistics->channel_count; i++)
        shown += statistics->channels[i].kind <= GW_EVENT_GAZE;
    const uint32_t left_out = shown > SENSORS ? shown - SENSORS : 0;
    shown -= left_out;
    const double wall = TOP + (double)PANEL * shown,
                 height = wall + wall_scale(&site->layout) * site->layout.framed[1] + 40;
    char title[320];
    fprintf(
        d->svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" viewBox=\"0 0 %d %.0f\" "
        "font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" "
        "fill=\"white\"/>\n",
        PAPER, height, PAPER, height);
    snprintf(title, sizeof title, "%.200s: %.3f s%s", d->recording->name, d->end - d->begin,
             d->recording->damage.found ? ", damaged behind that" : "");
    gw_svg_text(d->svg, LEFT, 36, "font-size=\"17\"", title);
    if (left_out > 0) {
        snprintf(title, sizeof title, "%u more sensors are not drawn", (unsigned)left_out);
        gw_svg_text(d->svg, LEFT, 56, "font-size=\"12\"", title);
    }
    uint32_t at = 0;
    for (uint32_t i = 0; i < statistics->channel_count && at < shown; i++)
        if (statistics->channels[i].kind <= GW_EVENT_GAZE)
            put_sensor(d, &statistics->channels[i], TOP + (double)PANEL * at++);
    put_wall(d, site, wall);
    fputs("</svg>\n", d->svg);
}

gw_code gw_replay_draw(const gw_recording *recording, const gw_recording_statistics *statistics,
                       gw_replay_views *views, const gw_site *site, char **svg, size_t *size,
                       gw_error *error) {
    drawing d = {.recording = recording, .views = views};
    *svg = NULL;
    d.begin = (double)recording->events[0].event.arrival * 1e-9;
    d.end = (double)recording->events[recording->count - 1].event.arrival * 1e-9;
    if (!(d.end > d.begin + 1e-3))
        d.end = d.begin + 1e-3;
    d.svg = open_memstream(svg, size);
    if (d.svg == NULL)
        return gw_fail(error, GW_MACHINE, "memory is out while drawing a recording");
    put_all(&d, statistics, site);
    int lost = ferror(d.svg) != 0;
    lost |= fclose(d.svg) != 0;
    return lost ? gw_fail(error, GW_MACHINE, "memory is out while drawing a recording") : GW_OK;
}
