#include "wall/picture_options.h"

#include "base/suggest.h"
#include "wall/options.h"

#include <errno.h>
#include <string.h>

enum { KEY_PATTERN = 0x5000, KEY_CODES, KEY_OVERLAY, KEY_VIDEO, KEY_RATE, KEY_REMAKE };

static const struct argp_option options_table[] = {
    {NULL, 0, NULL, 0, "Pictures (docs/pictures.md):", 6},
    {"pattern", KEY_PATTERN, "KIND", 0,
     "a test pattern instead of a scene: grid (millimetres that run on across bezels), colours, names", 6},
    {"frame-codes", KEY_CODES, NULL, 0,
     "a block of cells on every tile that codes the frame's number: 'gazewall codes' reads it back from a "
     "picture or a photograph",
     6},
    {"overlay", KEY_OVERLAY, NULL, 0,
     "over every tile: its name and machine, how long the parts of its last frames took, rays a second, age "
     "of the "
     "pose, what was missed, and the frame code",
     6},
    {"video", KEY_VIDEO, "FILE", 0, "the frames as a video: .mp4, .m4v, .mov or .mkv (H.264, by ffmpeg)", 6},
    {"fps", KEY_RATE, "N", 0, "1 to 240 frames a second of the video; default: 1 / --step, else 30", 6},
    {"remake", KEY_REMAKE, "FILE.json", 0,
     "make the picture again that this file was written beside, bit for bit; takes wall, scene, settings and "
     "frame from it (--scene names the scene where it is now); on one machine, by sim, also what a wall drew",
     6},
    {0}};

static gw_code parse_pattern(const char *argument, gw_picture_options *out) {
    for (int i = GW_PATTERN_GRID; i < GW_PATTERN_COUNT; i++)
        if (!strcmp(argument, gw_pattern_names[i])) {
            out->pattern = (gw_pattern_kind)i;
            return GW_OK;
        }
    const char *near =
        gw_suggest(argument, gw_pattern_names + GW_PATTERN_GRID, GW_PATTERN_COUNT - GW_PATTERN_GRID);
    return gw_fail(out->error, GW_BAD_INPUT,
                   "--pattern '%.40s' is unknown%s%s; it must be grid, colours or names", argument,
                   near ? "; did you mean " : "", near ? near : "");
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    gw_picture_options *options = state->input;
    gw_code code = GW_OK;
    switch (key) {
    case KEY_PATTERN:
        code = parse_pattern(argument, options);
        break;
    case KEY_CODES:
        options->codes = 1;
        break;
    case KEY_OVERLAY:
        options->overlay = options->codes = 1;
        break;
    case KEY_VIDEO:
        code = gw_parse_name("--video", argument, &options->video, options->error);
        break;
    case KEY_RATE:
        code = gw_parse_number("--fps", argument, 1, 240, &options->rate, options->error);
        break;
    case KEY_REMAKE:
        code = gw_parse_name("--remake", argument, &options->remake, options->error);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

const struct argp gw_picture_argp = {.options = options_table, .parser = parse};
