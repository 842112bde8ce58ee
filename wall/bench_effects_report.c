/* See bench_effects.h: what `bench effects` tells. */
#include "wall/bench_effects.h"

#include "wall/svg.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double mebibyte = 1048576.0;

/* What it takes, cheap or not: the work of rays, which no other program on the machine can change. */
static double work_share(const gw_effect_price *row) {
    const double with = (double)(row->with.node_loads + row->with.triangle_tests + row->with.voxels);
    const double without =
        (double)(row->without.node_loads + row->without.triangle_tests + row->without.voxels);
    return without > 0 ? with / without - 1 : 0;
}

static const char *verdict(const gw_effect_price *row) {
    if (!row->used && row->changed)
        return "FAULT";
    return row->cost < GW_CHEAP_EFFECT ? "cheap" : "";
}

static json_t *work_json(const gw_counters *c, uint64_t bytes, double ms) {
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f}", "rays", (json_int_t)c->rays,
                     "secondary_rays", (json_int_t)gw_secondary_rays(c), "steps", (json_int_t)c->steps,
                     "node_loads", (json_int_t)c->node_loads, "triangle_tests", (json_int_t)c->triangle_tests,
                     "voxels", (json_int_t)c->voxels, "bytes", (json_int_t)bytes, "ms", ms);
}

static void report_prices(const gw_effect_prices *prices) {
    json_t *rows = json_array();
    for (size_t i = 0; i < prices->count; i++) {
        const gw_effect_price *r = &prices->rows[i];
        json_array_append_new(
            rows, json_pack("{s:s, s:s, s:s, s:b, s:o, s:o, s:f, s:f, s:f, s:f, s:f, s:b, s:b}", "scene",
                            r->scene, "quality", r->quality, "effect", r->name, "used", r->used, "with",
                            work_json(&r->with, r->bytes_with, r->ms_with), "without",
                            work_json(&r->without, r->bytes_without, r->ms_without), "cost", r->cost, "work",
                            work_share(r), "spread_ms", r->spread, "flip", r->flip, "mean", r->mean,
                            "changed", r->changed, "cheap", r->cost < GW_CHEAP_EFFECT));
    }
    json_object_set_new(prices->bench->report, "bench",
                        json_pack("{s:s, s:i, s:s, s:[i,i], s:b, s:o}", "name", "effects", "rounds",
                                  (int)prices->rounds, "clock", prices->by_processor ? "processor" : "wall",
                                  "size", (int)prices->size[0], (int)prices->size[1], "counted_while_timed",
                                  prices->bench->quick, "prices", rows));
}

static gw_code write_rows(const gw_effect_prices *prices, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *csv = open_memstream(&text, &size);
    if (!csv)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("scene,quality,effect,used,rays,rays_without,secondary_rays,secondary_rays_without,steps,steps_"
          "without,node_loads,node_loads_without,triangle_tests,triangle_tests_without,bytes,bytes_without,"
          "ms,ms_without,spread_ms,cost,work,flip,mean,changed\n",
          csv);
    for (size_t i = 0; i < prices->count; i++) {
        const gw_effect_price *r = &prices->rows[i];
        fprintf(csv, "%s,%s,%s,%d,", r->scene, r->quality, r->name, r->used);
        const uint64_t pairs[][2] = {{r->with.rays, r->without.rays},
                                     {gw_secondary_rays(&r->with), gw_secondary_rays(&r->without)},
                                     {r->with.steps, r->without.steps},
                                     {r->with.node_loads, r->without.node_loads},
                                     {r->with.triangle_tests, r->without.triangle_tests},
                                     {r->bytes_with, r->bytes_without}};
        for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
            fprintf(csv, "%" PRIu64 ",%" PRIu64 ",", pairs[k][0], pairs[k][1]);
        fprintf(csv, "%.3f,%.3f,%.3f,%.4f,%.4f,%.5f,%.4f,%d\n", r->ms_with, r->ms_without, r->spread, r->cost,
                work_share(r), r->flip, r->mean, r->changed);
    }
    fclose(csv);
    gw_code code = gw_bench_write(prices->bench, "effects", text, size, error);
    free(text);
    return code;
}

/* A bar for each row: its share of the frame's time. */
static gw_code write_chart(const gw_effect_prices *prices, gw_error *error) {
    enum { LEFT = 330, WIDE = 420, RIGHT = 90, TOP = 50, HIGH = 18 };
    double most = GW_CHEAP_EFFECT;
    for (size_t i = 0; i < prices->count; i++)
        most = fmax(most, fabs(prices->rows[i].cost));
    char *text = NULL, line[256];
    size_t size = 0;
    FILE *svg = open_memstream(&text, &size);
    if (!svg)
        return gw_fail(error, GW_MACHINE, "memory is out while drawing a chart");
    const size_t height = TOP + prices->count * HIGH + 20;
    fprintf(svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%zu\" viewBox=\"0 0 %d %zu\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"white\"/>\n",
            LEFT + WIDE + RIGHT, height, LEFT + WIDE + RIGHT, height);
    gw_svg_text(svg, 20, 22, "font-size=\"15\"",
                "What effects cost: time of the frame with the effect over without, less 1");
    gw_svg_text(svg, 20, 38, "fill=\"#555\"",
                "blue: called for; grey: compiled in although nothing calls for it");
    for (size_t i = 0; i < prices->count; i++) {
        const gw_effect_price *r = &prices->rows[i];
        const char *name = strrchr(r->scene, '/');
        const double y = TOP + (double)i * HIGH, length = WIDE * fmax(r->cost, 0) / most;
        snprintf(line, sizeof line, "%.28s, %s: %s", name ? name + 1 : r->scene, r->quality, r->name);
        gw_svg_text(svg, LEFT - 8, y + 12, "text-anchor=\"end\" fill=\"#222\"", line);
        fprintf(svg, "<rect x=\"%d\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>\n", LEFT, y,
                fmax(length, 1), HIGH - 4, r->used ? "#0072b2" : "#999");
        snprintf(line, sizeof line, "%.1f %%", 100 * r->cost);
        gw_svg_text(svg, LEFT + length + 6, y + 12, "fill=\"#222\"", line);
    }
    fputs("</svg>\n", svg);
    fclose(svg);
    gw_code code = gw_bench_svg(prices->bench, "effects", text, size, error);
    free(text);
    return code;
}

gw_code gw_effects_write(const gw_effect_prices *prices, gw_error *error) {
    report_prices(prices);
    gw_code code = write_rows(prices, error);
    return code || !prices->bench->out ? code : write_chart(prices, error);
}

/* Percent by which a counter is larger with the effect. */
static double more(uint64_t with, uint64_t without) {
    return without ? 100.0 * ((double)with - (double)without) / (double)without : 0;
}

static void print_row(const gw_effect_price *r) {
    const double pixels = fmax((double)r->with.rays, 1);
    printf("  %-20s %-6s %6.2f %+7.1f %+7.1f %+7.1f %+8.1f %8.1f %6.1f %+7.1f  ", r->name,
           r->used ? "used" : "unused", (double)gw_secondary_rays(&r->with) / pixels,
           more(r->with.steps, r->without.steps), more(r->with.node_loads, r->without.node_loads),
           more(r->with.triangle_tests, r->without.triangle_tests),
           ((double)r->bytes_with - (double)r->bytes_without) / mebibyte, r->ms_with, r->spread,
           100 * r->cost);
    if (r->used)
        printf("%.4f %6.2f", r->flip, r->mean);
    else
        printf("%s", r->changed ? "other pixels" : "same pixels  ");
    printf("  %s\n", verdict(r));
}

void gw_effects_print(const gw_effect_prices *prices) {
    const char *scene = "", *quality = "";
    printf("The price list, %" PRIu32 "x%" PRIu32 " px, medians of %" PRIu32 " rounds, %s time%s.\n",
           prices->size[0], prices->size[1], prices->rounds, prices->by_processor ? "processor" : "wall",
           prices->bench->quick ? ", counting kernels" : "");
    for (size_t i = 0; i < prices->count; i++) {
        const gw_effect_price *r = &prices->rows[i];
        if (strcmp(scene, r->scene) || strcmp(quality, r->quality)) {
            printf("%s, %s: %.0f rays\n", r->scene, r->quality, (double)r->with.rays);
            printf("  %-20s %-6s %6s %7s %7s %7s %8s %8s %6s %7s  %s\n", "effect", "", "2nd/px", "steps",
                   "loads", "tests", "bytes", "ms", "+-", "time", "error without");
            printf("  %-20s %-6s %6s %7s %7s %7s %8s %8s %6s %7s  %s\n", "", "", "", "+%", "+%", "+%", "MiB",
                   "", "", "+%", "FLIP   mean");
        }
        scene = r->scene;
        quality = r->quality;
        print_row(r);
    }
    printf("cheap: below %.0f %% of the time; left out all the same where nothing calls for it.\n",
           100 * GW_CHEAP_EFFECT);
}
