#include "wall/overlay.h"

#include "wall/overlay_text.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

const char *const gw_lane_names[GW_LANES] = {
    [GW_LANE_WAIT] = "wait", [GW_LANE_TRACE] = "trace",     [GW_LANE_BLEND] = "blend",
    [GW_LANE_GATE] = "gate", [GW_LANE_PRESENT] = "present",
};

/* Told apart by people who do not see red and green as two, too (Okabe and Ito's palette). */
static const uint8_t lane_colors[GW_LANES][4] = {
    {120, 126, 138, 255}, {86, 180, 233, 255}, {240, 228, 66, 255}, {230, 159, 0, 255}, {0, 158, 115, 255}};
static const uint8_t ground[4] = {8, 12, 18, 190}, ink[4] = {235, 238, 242, 255},
                     faint[4] = {150, 158, 168, 255}, alarm_ink[4] = {255, 96, 72, 255};

void gw_lanes_note(gw_lanes *lanes, const float ms[GW_LANES]) {
    for (int i = 0; i < GW_LANES; i++)
        lanes->ms[lanes->count % GW_OVERLAY_FRAMES][i] = ms[i];
    lanes->count++;
}

static double total_of(const float ms[GW_LANES]) {
    double sum = 0;
    for (int i = 0; i < GW_LANES; i++)
        sum += fmax(0, (double)ms[i]);
    return sum;
}

/* 1, 2 or 5 times a power of ten, at least x: what the bars' full height stands for. */
static double round_up(double x) {
    double scale = pow(10, floor(log10(fmax(x, 0.1))));
    return x <= scale ? scale : x <= 2 * scale ? 2 * scale : x <= 5 * scale ? 5 * scale : 10 * scale;
}

/* Frames that are shown: the run's first, in which kernels are compiled, only while there is no other. */
static uint32_t kept_of(const gw_lanes *lanes) {
    const uint32_t useful = lanes->count > 1 ? lanes->count - 1 : lanes->count;
    return useful < GW_OVERLAY_FRAMES ? useful : GW_OVERLAY_FRAMES;
}

/* `age` frames ago, 0 the newest. */
static const float *frame_of(const gw_lanes *lanes, uint32_t age) {
    return lanes->ms[(lanes->count - 1 - age) % GW_OVERLAY_FRAMES];
}

/* Full height of all bars, ms. */
static double scale_of(const gw_lanes *lanes) {
    double most = 0;
    for (uint32_t age = 0; age < kept_of(lanes); age++)
        most = fmax(most, total_of(frame_of(lanes, age)));
    return round_up(most);
}

/* One bar per frame, its lanes on top of each other, the newest at the right. */
static void draw_bars(gw_image *image, const gw_lanes *lanes, int64_t x, int64_t y, int64_t width,
                      int64_t height) {
    const double full = scale_of(lanes);
    const int64_t bar = width / GW_OVERLAY_FRAMES > 1 ? width / GW_OVERLAY_FRAMES : 1;
    for (uint32_t age = 0; age < kept_of(lanes); age++) {
        const float *ms = frame_of(lanes, age);
        double below = 0;
        for (int lane = 0; lane < GW_LANES; lane++) {
            const double above = below + fmax(0, (double)ms[lane]);
            const int64_t low = lrint(below / full * (double)height),
                          high = lrint(above / full * (double)height);
            gw_box_draw(image, x + width - (int64_t)(age + 1) * bar, y + height - high,
                        bar > 2 ? bar - 1 : bar, high - low, lane_colors[lane]);
            below = above;
        }
    }
    gw_box_draw(image, x, y, width, 1, faint);
    gw_box_draw(image, x, y + height, width, 1, faint);
}

/* Mean of each lane over what is kept, with its colour. */
static void draw_legend(gw_image *image, const gw_lanes *lanes, int64_t x, int64_t y, uint32_t scale) {
    const uint32_t kept = kept_of(lanes);
    char text[64];
    for (int lane = 0; lane < GW_LANES; lane++) {
        double sum = 0;
        for (uint32_t age = 0; age < kept; age++)
            sum += (double)frame_of(lanes, age)[lane];
        const int64_t row = y + lane * (int64_t)(GW_TEXT_LINE * scale);
        gw_box_draw(image, x, row, 6 * (int64_t)scale, 7 * (int64_t)scale, lane_colors[lane]);
        snprintf(text, sizeof text, "%-7s %7.2f", gw_lane_names[lane], kept ? sum / kept : 0.0);
        gw_text_draw(image, x + 9 * (int64_t)scale, row, scale, ink, text);
    }
    snprintf(text, sizeof text, "ms, bars to %g", scale_of(lanes));
    gw_text_draw(image, x, y + GW_LANES * (int64_t)(GW_TEXT_LINE * scale), scale, faint, text);
}

static void write_age(char text[32], double age) {
    if (age < 0)
        snprintf(text, 32, "nobody tracked");
    else
        snprintf(text, 32, "pose %.0f ms old", age * 1e3);
}

/* The sum, and what adds to it. */
static void write_latency(char text[128], char stages[128], const gw_latency *latency) {
    const double total = gw_latency_total(latency);
    snprintf(text, 128, latency->tracked ? "motion to photons %.0f ms, %.0f of them predicted" : "", total,
             (double)latency->predicted);
    size_t used = 0;
    stages[0] = '\0';
    for (int i = 0; i < GW_LATENCY_STAGES && latency->tracked && used < 128; i++)
        used +=
            (size_t)snprintf(stages + used, 128 - used, "%s%s %.0f", i ? " " : "",
                             i == GW_LATENCY_SCAN_OUT ? "out" : gw_latency_names[i], (double)latency->ms[i]);
}

void gw_overlay_draw(gw_image *tile, const gw_lanes *lanes, const gw_overlay_text *t) {
    enum { COLUMNS = 50, LEGEND_COLUMNS = 19, LINES = 11 };
    /* A third of the tile's height and half of its width, in whole dots. */
    const uint32_t by_height = tile->height / (3 * GW_TEXT_LINE * LINES),
                   by_width = tile->width / (2 * GW_TEXT_ADVANCE * COLUMNS);
    uint32_t scale = by_height < by_width ? by_height : by_width;
    scale = scale ? scale : 1;
    const int64_t dot = scale, line = GW_TEXT_LINE * dot, advance = GW_TEXT_ADVANCE * dot, gap = 4 * dot;
    const int64_t width = COLUMNS * advance + 2 * gap, height = LINES * line + 2 * gap;
    char text[128], stages[128], age[32];
    gw_box_draw(tile, 0, 0, width, height, ground);
    snprintf(text, sizeof text, "%s  rank %" PRIu32 "%s%s  frame %" PRIu32, t->tile, t->rank,
             t->host[0] ? "  " : "", t->host, t->frame);
    gw_text_draw(tile, gap, gap, scale, ink, text);
    write_age(age, t->pose_age);
    if (t->rays_per_second > 0)
        snprintf(text, sizeof text, "%.2f million rays/s  %s", t->rays_per_second * 1e-6, age);
    else
        snprintf(text, sizeof text, "%s", age);
    gw_text_draw(tile, gap, gap + line, scale, ink, text);
    snprintf(text, sizeof text, "late %" PRIu32 "  skipped %" PRIu32 "  lost %" PRIu32, t->late, t->skipped,
             t->lost);
    gw_text_draw(tile, gap, gap + 2 * line, scale, t->late + t->skipped + t->lost ? alarm_ink : faint, text);
    write_latency(text, stages, &t->latency);
    gw_text_draw(tile, gap, gap + 3 * line, scale, ink, text);
    gw_text_draw(tile, gap, gap + 4 * line, scale, faint, stages);
    draw_legend(tile, lanes, gap, gap + 5 * line, scale);
    const int64_t left = gap + LEGEND_COLUMNS * advance;
    draw_bars(tile, lanes, left, gap + 5 * line + 2 * dot, width - gap - left, 6 * line - 4 * dot);
}
