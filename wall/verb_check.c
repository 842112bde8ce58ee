/* `gazewall check SITE`: is the site as its builder means it? Verdict, table of tiles, warnings, drawing.
 * Main thread. */
#include "base/file.h"
#include "render/vector3.h"
#include "wall/console.h"
#include "wall/options.h"
#include "wall/site.h"
#include "wall/verbs.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct check_options {
    gw_error *error;
    const char *site, *draw;
    int corners, strict, quiet;
} check_options;

enum { KEY_DRAW = 0x2000, KEY_CORNERS, KEY_STRICT, KEY_QUIET };

static const struct argp_option option_table[] = {
    {"draw", KEY_DRAW, "FILE.svg", 0, "Draw the wall: front, top and bird's-eye view, with a scale in mm", 0},
    {"corners", KEY_CORNERS, NULL, 0,
     "Print, instead of the table, the site with each tile by its measured corners: a site file itself, "
     "which "
     "gives the same pixels",
     0},
    {"strict", KEY_STRICT, NULL, 0, "Warnings count as errors: exit code 2", 0},
    {"quiet", KEY_QUIET, NULL, 0, "Print errors and warnings only", 0},
    {0},
};

static gw_code parse_draw(const char *value, check_options *options) {
    const char *suffix = strrchr(value, '.');
    if (suffix && !strchr(suffix, '/') && strcasecmp(suffix, ".svg") != 0)
        return gw_fail(options->error, GW_BAD_INPUT, "--draw '%s': the drawing is SVG; name it FILE.svg",
                       value);
    return gw_parse_name("--draw", value, &options->draw, options->error);
}

static error_t parse_option(int key, char *value, struct argp_state *state) {
    check_options *options = state->input;
    switch (key) {
    case KEY_DRAW:
        return parse_draw(value, options) ? EINVAL : 0;
    case KEY_CORNERS:
        options->corners = 1;
        return 0;
    case KEY_STRICT:
        options->strict = 1;
        return 0;
    case KEY_QUIET:
        options->quiet = 1;
        return 0;
    case ARGP_KEY_ARG:
        if (!options->site) {
            options->site = value;
            return 0;
        }
        gw_fail(options->error, GW_BAD_INPUT, "one site at a time: '%s' is a second one after '%s'", value,
                options->site);
        return EINVAL;
    case ARGP_KEY_END:
        if (options->site)
            return 0;
        gw_fail(options->error, GW_BAD_INPUT, "name a site: a file, or one inside the program as 3x2-bezels");
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp check_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "SITE",
    .doc =
        "Whether a site file describes a wall that can be: reads it, prints what it understood, and draws it."
        "\vExit codes: 0 the site can be used, with warnings or without; 2 it cannot, and the error names "
        "file, line and key (with --strict also: there are warnings); 5 the drawing could not be written.\n\n"
        "docs/sites.md lists all keys, docs/measure-your-wall.md leads to a file with a tape measure.\n\n"
        "gazewall check wall.yaml --draw wall.svg",
};

/* Pixels per degree, across, where the eye looks at the tile's middle. */
static double pixels_per_degree(const gw_layout *layout, const gw_tile *tile) {
    double corners[4][3], left[3], right[3], turned[3];
    gw_tile_corners(tile, corners);
    for (int i = 0; i < 3; i++) {
        double middle = 0.5 * (corners[1][i] + corners[2][i]) - layout->eye[i];
        left[i] = middle - 0.5 * tile->plane.step_x[i];
        right[i] = middle + 0.5 * tile->plane.step_x[i];
    }
    gw_cross(left, right, turned);
    return 1 / (atan2(gw_length(turned), gw_dot(left, right)) * 57.29577951308232);
}

static void print_table(const gw_site *site) {
    const gw_layout *layout = &site->layout;
    int names = 4, hosts = 4;
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        int name = (int)strlen(layout->tiles[t].name), host = (int)strlen(site->panels[t].host);
        names = name > names ? name : names;
        hosts = host > hosts ? host : hosts;
    }
    printf("\n%-*s  %-*s  %-17s  %-11s  %8s  %9s  %s\n", names, "tile", hosts, "host", "mm", "pixels",
           "mm/pixel", "px/degree", "stereo");
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        const char *host = site->panels[t].host;
        char size[40], pixels[32];
        double pitch = gw_length(tile->plane.step_x);
        snprintf(size, sizeof size, "%.1f x %.1f", pitch * tile->rectangle.width,
                 gw_length(tile->plane.step_y) * tile->rectangle.height);
        snprintf(pixels, sizeof pixels, "%ux%u", tile->rectangle.width, tile->rectangle.height);
        printf("%-*s  %-*s  %-17s  %-11s  %8.4g  %9.1f  %s\n", names, tile->name, hosts, host[0] ? host : "-",
               size, pixels, pitch, pixels_per_degree(layout, tile), gw_stereo_names[site->panels[t].stereo]);
    }
}

/* To tenths of a millimetre, and nothing to the left of zero that is not there. */
static double tenths(double millimetres) {
    return rint(millimetres * 10) / 10 + 0.0;
}

static void print_verdict(const char *path, const gw_site *site, const gw_site_notes *notes) {
    const gw_layout *layout = &site->layout;
    uint64_t pixels = 0;
    uint32_t warnings = notes->count + notes->left_out;
    for (uint32_t t = 0; t < layout->tile_count; t++)
        pixels += (uint64_t)layout->tiles[t].rectangle.width * layout->tiles[t].rectangle.height;
    if (warnings)
        printf("%s can be used; %u warning%s\n", path, warnings, warnings == 1 ? "" : "s");
    else
        printf("%s is good\n", path);
    printf("%u tile%s, %.1f megapixels; picture %ux%u px, with bezels %ux%u px\n"
           "%.0f x %.0f mm from the front, middle at [%g, %g, %g], eye at [%g, %g, %g]\n",
           layout->tile_count, layout->tile_count == 1 ? "" : "s", (double)pixels * 1e-6, layout->picture[0],
           layout->picture[1], layout->framed[0], layout->framed[1], layout->size[0], layout->size[1],
           tenths(layout->centre[0]), tenths(layout->centre[1]), tenths(layout->centre[2]), layout->eye[0],
           layout->eye[1], layout->eye[2]);
}

static void print_trackers(const gw_tracker_setup *setup) {
    for (uint32_t s = 0; s < setup->source_count; s++) {
        const gw_tracker_source *source = &setup->sources[s];
        const char *unit = gw_room_unit_name(source->room.unit);
        char axes[GW_AXIS_TEXT], number[32];
        uint32_t viewers = 0;
        for (uint32_t v = 0; v < setup->viewer_count; v++)
            viewers += setup->viewers[v].source == (int32_t)s;
        gw_axis_map_write(&source->room.axes, axes);
        snprintf(number, sizeof number, "%g mm", source->room.unit);
        printf("tracker %u: %s, unit %s, axes %s%s, origin at [%g, %g, %g], ", s + 1, source->spec,
               unit ? unit : number, axes, gw_axis_map_hand(&source->room.axes) < 0 ? " (left-handed)" : "",
               source->room.shift[0], source->room.shift[1], source->room.shift[2]);
        if (viewers)
            printf("heads of up to %u viewer%s\n", viewers, viewers == 1 ? "" : "s");
        else
            printf("nobody's head\n");
    }
}

static gw_code print_corners(const gw_site *site, gw_error *error) {
    char *text;
    size_t size;
    gw_code code = gw_site_write(site, &text, &size, error);
    if (!code)
        fwrite(text, 1, size, stdout);
    free(text);
    return code;
}

static gw_code draw(const gw_site *site, const check_options *options, gw_error *error) {
    char *svg;
    size_t size;
    gw_code code = gw_site_draw(site, gw_path_name(options->site), &svg, &size, error);
    if (!code)
        code = gw_file_write(options->draw, svg, size, error);
    free(svg);
    return code;
}

int gw_verb_check(int argc, char **argv) {
    static gw_site site;
    static gw_site_notes notes;
    gw_error error = {0};
    check_options options = {.error = &error};
    int helped = 0;
    gw_code code = gw_arguments_parse(&check_argp, argc, argv, &options, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code)
        code = gw_site_load_noting(options.site, &site, &notes, &error);
    if (code)
        return gw_console_fail("check", &error);
    gw_console console;
    gw_console_init(&console, "check", GW_LOG_WARNING, 0);
    gw_site_warn(options.site, &notes, &console.log);
    gw_console_finish(&console);
    if (options.draw)
        code = draw(&site, &options, &error);
    if (!code && options.corners) {
        code = print_corners(&site, &error);
    } else if (!code && !options.quiet) {
        print_verdict(options.site, &site, &notes);
        print_trackers(&site.trackers);
        print_table(&site);
    }
    if (code)
        return gw_console_fail("check", &error);
    if (options.strict && notes.count) {
        gw_fail(&error, GW_BAD_INPUT, "%s: %u warnings, and --strict was asked for", options.site,
                notes.count + notes.left_out);
        return gw_console_fail("check", &error);
    }
    return GW_OK;
}
