/* `gazewall compare`: how far one picture is from another, or a recorded run from the exact one, by every
 * metric (docs/metrics.md). */
#include "wall/verbs.h"

#include "base/file.h"
#include "base/image.h"
#include "base/portable_math.h"
#include "build/octree.h"
#include "render/flip.h"
#include "wall/compare.h"
#include "wall/frames.h"
#include "wall/interrupt.h"
#include "wall/report.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_SIZE = 0x6000,
    KEY_WALL_WIDTH,
    KEY_STATES,
    KEY_FRAMES,
    KEY_OUT,
    KEY_CSV,
    KEY_DENSITY,
    KEY_GAZE,
    KEY_LUMINANCE
};

static const struct argp_option options_table[] = {
    {NULL, 0, NULL, 0, "Two pictures:", 1},
    {"density", KEY_DENSITY, "N", 0,
     "1 to 1000 px a degree that they are seen at; default 67.02, a 4K screen of 0.7 m from 0.7 m", 1},
    {"gaze", KEY_GAZE, "X,Y", 0, "px: a viewer looks there, and sees the rest as the eye does", 1},
    {NULL, 0, NULL, 0, "A run, frame by frame against the exact one:", 2},
    {"states", KEY_STATES, "FILE", 0, "its recorded frame states (sim --save-states)", 2},
    {"frames", KEY_FRAMES, "N", 0, "only the first N of them", 2},
    {"size", KEY_SIZE, "WxH", 0, "px of the wall, default 960x540", 2},
    {"wall-width", KEY_WALL_WIDTH, "MM", 0, "10 to 1e6 mm, default 2000", 2},
    {"out", KEY_OUT, "FOLDER", 0,
     "write the pairs of frames there, with viewing geometry and gaze, as FovVideoVDP reads them", 2},
    {"luminance", KEY_LUMINANCE, "N", 0, "cd/m^2 of the wall's white, for that; 1 to 1e5, default 300", 2},
    {NULL, 0, NULL, 0, "Results:", 3},
    {"csv", KEY_CSV, "FILE", 0, "a row for each frame: what was drawn, what it took, every metric", 3},
    {0}};

static gw_code add_picture(gw_compare *c, const char *name, gw_error *error) {
    const int which = c->pictures[0] != NULL;
    if (which && c->pictures[1])
        return gw_fail(error, GW_BAD_INPUT, "'%s' is one picture too many; compare takes two", name);
    c->pictures[which] = name;
    return GW_OK;
}

static error_t parse_compare(int key, char *argument, struct argp_state *state) {
    gw_compare *c = state->input;
    gw_error *error = c->draw.error;
    gw_code code = GW_OK;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &c->draw;
        break;
    case KEY_SIZE:
        c->wall.size_given = 1;
        code = gw_parse_pair("--size", argument, 8192, c->wall.size, error);
        break;
    case KEY_WALL_WIDTH:
        c->wall.wall_width_given = 1;
        code = gw_parse_number("--wall-width", argument, 10, 1e6, &c->wall.wall_width, error);
        break;
    case KEY_STATES:
        code = gw_parse_name("--states", argument, &c->states, error);
        break;
    case KEY_FRAMES:
        code = gw_parse_integer("--frames", argument, 1, GW_MAXIMUM_STATES, &c->frames, error);
        break;
    case KEY_OUT:
        code = gw_parse_name("--out", argument, &c->out, error);
        break;
    case KEY_CSV:
        code = gw_parse_name("--csv", argument, &c->csv, error);
        break;
    case KEY_DENSITY:
        code = gw_parse_number("--density", argument, 1, 1000, &c->pixels_per_degree, error);
        break;
    case KEY_GAZE:
        c->gazed = 1;
        code = gw_parse_numbers("--gaze", argument, 2, c->gaze, error);
        break;
    case KEY_LUMINANCE:
        code = gw_parse_number("--luminance", argument, 1, 1e5, &c->luminance, error);
        break;
    case ARGP_KEY_ARG:
        code = add_picture(c, argument, error);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

static const struct argp_child children[] = {{&gw_draw_argp, 0, NULL, 0}, {0}};
static const struct argp compare_argp = {
    .options = options_table,
    .parser = parse_compare,
    .args_doc = "REFERENCE.png TEST.png",
    .children = children,
    .doc = "How far a picture is from its reference, or every frame of a recorded run from the frame without "
           "approximations: PSNR, SSIM, FLIP, the bias with its sign, as seen by who looks there; of a run "
           "also hits, "
           "depth, normals, silhouettes, flicker and pops. docs/metrics.md defines them.\v"
           "Examples:\n"
           "  gazewall compare exact.png mine.png --density 40 --gaze 480,270\n"
           "  gazewall sim --frames 60 --save-states run.states\n"
           "  gazewall compare --states run.states --size 480x270 --csv frames.csv --out pairs\n"};

static gw_code check(const gw_compare *c, gw_error *error) {
    if (c->states && c->pictures[0])
        return gw_fail(error, GW_BAD_INPUT, "--states compares a run, and '%s' is a picture; leave out one",
                       c->pictures[0]);
    if (!c->states && !c->pictures[1])
        return gw_fail(error, GW_BAD_INPUT,
                       "say what to compare: gazewall compare REFERENCE.png TEST.png, or --states FILE");
    const char *lost = c->states                  ? (c->pixels_per_degree > 0 ? "--density"
                                                     : c->gazed               ? "--gaze"
                                                                              : NULL)
                       : c->out                   ? "--out"
                       : c->frames                ? "--frames"
                       : c->wall.size_given       ? "--size"
                       : c->wall.wall_width_given ? "--wall-width"
                       : c->luminance > 0         ? "--luminance"
                       : c->draw.scene            ? "--scene"
                                                  : NULL;
    if (lost)
        return gw_fail(error, GW_BAD_INPUT, "comparing %s has no use for %s; leave it out",
                       c->states ? "a run" : "two pictures", lost);
    return c->states ? gw_draw_options_decide_frames(&c->draw, error) : GW_OK;
}

/* --- two pictures ----------------------------------------------------------------------------------------
 */

static gw_code read_picture(const char *path, gw_image *out, gw_error *error) {
    const size_t most_bytes = (size_t)1 << 30;
    const uint64_t most_pixels = (uint64_t)1 << 28;
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, most_bytes, &bytes, error);
    if (!code)
        code = gw_image_decode(bytes.data, bytes.size, path, most_pixels, out, error);
    gw_bytes_finish(&bytes);
    return code;
}

/* A flat screen of 1 mm a pixel, and a viewer before its middle at the distance that gives the density. */
static gw_code block_of_gaze(const gw_compare *c, const gw_image *picture, double density,
                             gw_frame_block *out, gw_error *error) {
    const gw_similarity placement = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1};
    const gw_plane plane = {.corner = {-0.5 * picture->width, 0.5 * picture->height, 0},
                            .step_x = {1, 0, 0},
                            .step_y = {0, -1, 0}};
    const double eye[3] = {0, 0, density / tan(GW_PI / 180)};
    const double target[3] = {plane.corner[0] + c->gaze[0], plane.corner[1] - c->gaze[1], 0};
    const gw_scene scene = {0};
    const gw_octree octree = {0};
    gw_frame_state state;
    gw_frame_begin(&state, 0, &c->draw.settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&state, eye, target, &c->draw.settings);
    return gw_frame_block_fill(&scene, &octree, &placement, &plane, &state, out, NULL, error);
}

static gw_code check_gaze(const gw_compare *c, const gw_image *picture, gw_error *error) {
    if (c->gazed && !(c->gaze[0] >= 0 && c->gaze[1] >= 0 && c->gaze[0] <= picture->width &&
                      c->gaze[1] <= picture->height))
        return gw_fail(error, GW_BAD_INPUT, "--gaze %g,%g is not on the picture of %u x %u pixels",
                       c->gaze[0], c->gaze[1], picture->width, picture->height);
    return GW_OK;
}

static gw_code compare_pictures(gw_compare *c, FILE *rows, gw_metrics *out, gw_error *error) {
    gw_image pictures[2] = {{0}, {0}};
    gw_frame_block block;
    gw_metric_view view = {.pixels_per_degree =
                               c->pixels_per_degree > 0 ? c->pixels_per_degree : GW_FLIP_PIXELS_PER_DEGREE};
    gw_code code = GW_OK;
    for (int i = 0; i < 2 && !code; i++)
        code = read_picture(c->pictures[i], &pictures[i], error);
    if (!code)
        code = check_gaze(c, &pictures[0], error);
    if (!code && c->gazed) {
        code = block_of_gaze(c, &pictures[0], view.pixels_per_degree, &block, error);
        view.block = &block;
    }
    const gw_metric_frame reference = {pictures[0].width, pictures[0].height, .picture = &pictures[0]},
                          test = {pictures[1].width, pictures[1].height, .picture = &pictures[1]};
    if (!code)
        code = gw_metrics_compare(&reference, &test, &view, out, error);
    if (!code) {
        gw_compare_write_names(rows);
        gw_compare_write_values(rows, out);
    }
    for (int i = 0; i < 2; i++)
        gw_image_finish(&pictures[i]);
    return code && c->pictures[1] ? gw_context(error, "%s and %s", c->pictures[0], c->pictures[1]) : code;
}

/* --- results ---------------------------------------------------------------------------------------------
 */

void gw_compare_write_names(FILE *file) {
    for (int i = 0; i < GW_METRIC_COUNT; i++)
        fprintf(file, "%s%s", i ? "," : "", gw_metric_table[i].name);
    fputc('\n', file);
}

void gw_compare_write_values(FILE *file, const gw_metrics *metrics) {
    for (int i = 0; i < GW_METRIC_COUNT; i++) {
        if (i)
            fputc(',', file);
        if (!isnan(metrics->values[i]))
            fprintf(file, "%.7g", metrics->values[i]);
    }
    fputc('\n', file);
}

/* JSON knows no infinity: the PSNR of equal pictures is null there, as what was not measured. */
static json_t *metrics_json(const gw_metrics *metrics) {
    json_t *all = json_object();
    for (int i = 0; i < GW_METRIC_COUNT; i++)
        json_object_set_new(all, gw_metric_table[i].name,
                            isfinite(metrics->values[i]) ? json_real(metrics->values[i]) : json_null());
    return all;
}

static void print(const gw_metrics *metrics) {
    for (int i = 0; i < GW_METRIC_COUNT; i++)
        if (!isnan(metrics->values[i]))
            printf("  %-20s %12.6g %-7s %s\n", gw_metric_table[i].name, metrics->values[i],
                   gw_metric_table[i].unit, gw_metric_table[i].what);
}

static gw_code run_compare(gw_compare *c, gw_error *error) {
    gw_metrics metrics;
    char *text = NULL;
    size_t size = 0;
    FILE *rows = open_memstream(&text, &size);
    if (!rows)
        return gw_fail(error, GW_MACHINE, "memory is out while comparing");
    gw_code code =
        c->states ? gw_compare_states(c, rows, &metrics, error) : compare_pictures(c, rows, &metrics, error);
    fclose(rows);
    gw_interrupt_hold();
    if (!code && c->csv)
        code = gw_file_write(c->csv, text, size, error);
    if (!code && c->draw.report) {
        gw_report_settings(c->report, &c->draw.settings, &c->draw.profile);
        json_object_set_new(c->report, "metrics", metrics_json(&metrics));
        code = gw_report_write(c->report, c->draw.report, error);
    }
    gw_interrupt_release();
    gw_console_finish(&c->console);
    if (!code && !c->draw.quiet)
        print(&metrics);
    free(text);
    return code;
}

int gw_verb_compare(int argc, char **argv) {
    static gw_compare c;
    gw_error error = {0};
    int helped = 0;
    gw_draw_options_init(&c.draw, &error);
    gw_wall_options_init(&c.wall, 1, 1);
    gw_code code = gw_arguments_parse(&compare_argp, argc, argv, &c, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code)
        code = check(&c, &error);
    c.luminance = c.luminance > 0 ? c.luminance : 300;
    if (!code)
        code = gw_file_writable(c.csv, &error);
    if (!code)
        code = gw_file_writable(c.draw.report, &error);
    if (!code && c.out)
        code = gw_make_directories(c.out, &error);
    gw_console_init(&c.console, "compare", c.draw.level, c.draw.quiet);
    if (!code)
        code = gw_report_create(argc, argv, &c.report, &error);
    if (!code)
        code = run_compare(&c, &error);
    json_decref(c.report);
    gw_console_finish(&c.console);
    return code ? gw_console_fail("compare", &error) : GW_OK;
}
