/* The wall that a command line describes: a site file, or a split of a plane. */
#include "wall/sim_options.h"

#include "wall/stereo.h"

#include <string.h>

void gw_wall_options_init(gw_wall_options *options, uint32_t columns, uint32_t rows) {
    memset(options, 0, sizeof *options);
    options->tiles[0] = columns;
    options->tiles[1] = rows;
    options->size[0] = 960;
    options->size[1] = 540;
    options->wall_width = 2000;
    options->eye_distance = -1;
}

/* Sizes of the columns or rows of a split; checks them against the wall's size when that was given, too. */
static gw_code split_axis(const gw_wall_options *options, int axis, const uint32_t *given, size_t given_count,
                          uint32_t *parts, uint32_t *count, gw_error *error) {
    const char *name = axis ? "rows" : "columns";
    if (given_count == 0) {
        *count = options->tiles[axis];
        if (*count > GW_MAXIMUM_TILES || options->size[axis] < *count)
            return gw_fail(error, GW_BAD_INPUT,
                           "%u px cannot be split into %u %s; use fewer tiles or more pixels",
                           options->size[axis], *count, name);
        gw_split_evenly(options->size[axis], *count, parts);
        return GW_OK;
    }
    uint64_t sum = 0;
    for (size_t i = 0; i < given_count; i++) {
        parts[i] = given[i];
        sum += given[i];
    }
    *count = (uint32_t)given_count;
    if (options->tiles_given && options->tiles[axis] != given_count)
        return gw_fail(error, GW_BAD_INPUT, "--%s names %zu parts, --tiles %u; leave one of them out", name,
                       given_count, options->tiles[axis]);
    if (options->size_given && options->size[axis] != sum)
        return gw_fail(error, GW_BAD_INPUT, "--%s add up to %llu px, --size says %u; leave one of them out",
                       name, (unsigned long long)sum, options->size[axis]);
    return GW_OK;
}

static gw_code split_site(const gw_wall_options *options, gw_site *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_site_defaults(out);
    gw_grid grid = {
        .left = options->bezel, .right = options->bezel, .top = options->bezel, .bottom = options->bezel};
    gw_code code =
        split_axis(options, 0, options->widths, options->width_count, grid.widths, &grid.columns, error);
    if (!code)
        code =
            split_axis(options, 1, options->heights, options->height_count, grid.heights, &grid.rows, error);
    if (code)
        return code;
    uint32_t pixels = 0;
    for (uint32_t i = 0; i < grid.columns; i++)
        pixels += grid.widths[i];
    grid.pitch[0] = grid.pitch[1] = options->wall_width / pixels;
    grid.eye[2] = 0.9 * options->wall_width;
    return gw_layout_grid(&grid, &out->layout, error);
}

gw_code gw_wall_site(const gw_wall_options *options, gw_site *out, gw_error *error) {
    gw_site_notes notes;
    return gw_wall_site_noting(options, out, &notes, error);
}

gw_code gw_wall_site_noting(const gw_wall_options *options, gw_site *out, gw_site_notes *notes,
                            gw_error *error) {
    memset(notes, 0, sizeof *notes);
    if (options->given) {
        *out = *options->given;
        return gw_stereo_check(out, error);
    }
    if (options->site &&
        (options->tiles_given || options->size_given || options->width_count || options->height_count))
        return gw_fail(error, GW_BAD_INPUT,
                       "--site describes the whole wall; leave out --tiles, --size, --columns and --rows");
    gw_code code = options->site ? gw_site_load_noting(options->site, out, notes, error)
                                 : split_site(options, out, error);
    if (code)
        return code;
    for (uint32_t i = 0; options->stereo_given && i < out->layout.tile_count; i++)
        out->panels[i].stereo = options->stereo;
    if (options->eye_distance >= 0)
        out->eye_distance = options->eye_distance;
    return gw_stereo_check(out, error);
}

gw_code gw_wall_layout(const gw_wall_options *options, gw_layout *out, gw_error *error) {
    gw_site site;
    gw_code code = gw_wall_site(options, &site, error);
    if (!code)
        *out = site.layout;
    return code;
}
