/* `gazewall codes`: reads the frame codes of a wall's tiles from a picture of it. */
#include "wall/verbs.h"

#include "base/file.h"
#include "base/image.h"
#include "wall/console.h"
#include "wall/frame_code.h"
#include "wall/options.h"
#include "wall/sim_options.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { MAXIMUM_PICTURE_BYTES = 1 << 30 };

typedef struct codes_options {
    gw_error *error;
    gw_wall_options wall;
    const char *picture;
    int bezels;
} codes_options;

enum { KEY_SITE = 0x6000, KEY_TILES, KEY_SIZE, KEY_BEZELS };

static const struct argp_option options_table[] = {
    {"site", KEY_SITE, "FILE", 0, "the wall's site file", 1},
    {"tiles", KEY_TILES, "CxR", 0, "or columns x rows of tiles, as for sim; default 2x2", 1},
    {"size", KEY_SIZE, "WxH", 0, "px of that wall, default 960x540", 1},
    {"bezels", KEY_BEZELS, NULL, 0,
     "the picture shows the wall as it hangs, with bezels and gaps, cropped to its outer border: a "
     "photograph, at any "
     "size; without this option a picture that has just the size of wall-bezels.png is taken for one, too",
     1},
    {0}};

static error_t parse_codes(int key, char *argument, struct argp_state *state) {
    codes_options *o = state->input;
    gw_code code = GW_OK;
    switch (key) {
    case KEY_SITE:
        o->wall.site = argument;
        break;
    case KEY_TILES:
        o->wall.tiles_given = 1;
        code = gw_parse_pair("--tiles", argument, GW_MAXIMUM_TILES, o->wall.tiles, o->error);
        break;
    case KEY_SIZE:
        o->wall.size_given = 1;
        code = gw_parse_pair("--size", argument, GW_MAXIMUM_WALL_SIDE, o->wall.size, o->error);
        break;
    case KEY_BEZELS:
        o->bezels = 1;
        break;
    case ARGP_KEY_ARG:
        code = o->picture ? gw_fail(o->error, GW_BAD_INPUT, "'%s' is one picture too many", argument) : GW_OK;
        o->picture = argument;
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

static const struct argp codes_argp = {.options = options_table,
                                       .parser = parse_codes,
                                       .args_doc = "PICTURE",
                                       .doc =
                                           "Reads the frame codes that 'gazewall sim --frame-codes' drew, "
                                           "tile by tile, from a picture of the wall or a "
                                           "photograph cropped and straightened to it (PNG or JPEG), and "
                                           "tells whether all tiles show one frame. Exit "
                                           "code 1: they do not, or some cannot be read.\v"
                                           "Examples:\n"
                                           "  gazewall codes --tiles 3x2 --size 960x540 pictures/wall.png\n"
                                           "  gazewall codes --site wall.yaml --bezels photograph.jpg\n"};

/* GW_TILES_LOST unless all tiles show one frame. */
static gw_code read_tiles(const gw_layout *layout, const gw_image *picture, int bezels, gw_error *error) {
    const uint32_t *size = bezels ? layout->framed : layout->picture;
    uint32_t frames[GW_MAXIMUM_TILES], read = 0, alike = 0;
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        const gw_tile *tile = &layout->tiles[i];
        const uint32_t *at = bezels ? tile->framed : tile->picture;
        const double across = (double)picture->width / size[0], down = (double)picture->height / size[1];
        const double rectangle[4] = {at[0] * across, at[1] * down, tile->rectangle.width * across,
                                     tile->rectangle.height * down};
        uint32_t frame;
        switch (
            gw_frame_code_read(picture, rectangle, tile->rectangle.width, tile->rectangle.height, &frame)) {
        case GW_CODE_READ:
            printf("%-16s frame %" PRIu32 " (modulo %d)\n", tile->name, frame, GW_CODE_PERIOD);
            frames[read++] = frame;
            alike += frame == frames[0];
            break;
        case GW_CODE_CHANGED:
            printf("%-16s changed while the picture was taken\n", tile->name);
            break;
        case GW_CODE_NONE:
            printf("%-16s no code to be read\n", tile->name);
            break;
        }
    }
    if (read < layout->tile_count)
        return gw_fail(error, GW_TILES_LOST, "%" PRIu32 " of %" PRIu32 " tiles could be read", read,
                       layout->tile_count);
    if (alike < read)
        return gw_fail(error, GW_TILES_LOST, "a mixed frame: the tiles do not show the same one");
    printf("all %" PRIu32 " tiles show the same frame\n", read);
    return GW_OK;
}

int gw_verb_codes(int argc, char **argv) {
    static codes_options options;
    static gw_layout layout;
    gw_error error = {0};
    gw_bytes bytes = {0};
    gw_image picture = {0};
    int helped = 0;
    options.error = &error;
    gw_wall_options_init(&options.wall, 2, 2);
    gw_code code = gw_arguments_parse(&codes_argp, argc, argv, &options, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code && !options.picture)
        code =
            gw_fail(&error, GW_BAD_INPUT, "which picture? gazewall codes --tiles CxR --size WxH PICTURE.png");
    if (!code)
        code = gw_wall_layout(&options.wall, &layout, &error);
    if (!code)
        code = gw_file_read(options.picture, MAXIMUM_PICTURE_BYTES, &bytes, &error);
    if (!code)
        code = gw_image_decode(bytes.data, bytes.size, options.picture,
                               (uint64_t)GW_MAXIMUM_WALL_SIDE * GW_MAXIMUM_WALL_SIDE, &picture, &error);
    gw_bytes_finish(&bytes);
    if (!code) {
        const int framed = picture.width == layout.framed[0] && picture.height == layout.framed[1] &&
                           !(picture.width == layout.picture[0] && picture.height == layout.picture[1]);
        code = read_tiles(&layout, &picture, options.bezels || framed, &error);
    }
    gw_image_finish(&picture);
    return code ? gw_console_fail("codes", &error) : GW_OK;
}
