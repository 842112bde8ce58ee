/* The difference of two sites, in words. */
#include "wall/site_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void gw_site_change(gw_site_changes *out, int restart, const char *format, ...) {
    out->restarts += restart != 0;
    if (out->count == GW_MAXIMUM_CHANGES) {
        out->left_out++;
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out->changes[out->count].text, sizeof out->changes[0].text, format, arguments);
    va_end(arguments);
    out->changes[out->count++].restart = restart;
}

static void number(gw_site_changes *out, int restart, const char *what, double before, double after) {
    if (before != after)
        gw_site_change(out, restart, "%s %g -> %g", what, before, after);
}

static void text(gw_site_changes *out, const char *what, const char *before, const char *after) {
    if (strcmp(before, after) != 0)
        gw_site_change(out, 1, "%s %.80s -> %.80s", what, before[0] ? before : "none",
                       after[0] ? after : "none");
}

static void vector(gw_site_changes *out, const char *what, const double before[3], const double after[3]) {
    if (memcmp(before, after, 3 * sizeof *before) != 0)
        gw_site_change(out, 0, "%s [%g, %g, %g] -> [%g, %g, %g]", what, before[0], before[1], before[2],
                       after[0], after[1], after[2]);
}

static void compare_panel(gw_site_changes *out, const char *name, const gw_panel *before,
                          const gw_panel *after) {
    char what[64];
#define WHAT(key) (snprintf(what, sizeof what, "tile '%s': " key, name), what)
    text(out, WHAT("host"), before->host, after->host);
    text(out, WHAT("display"), before->display, after->display);
    text(out, WHAT("monitor"), before->monitor, after->monitor);
    number(out, 1, WHAT("gpu"), before->gpu, after->gpu);
    if (before->window[0] != after->window[0] || before->window[1] != after->window[1])
        gw_site_change(out, 1, "%s [%d, %d] -> [%d, %d]", WHAT("window"), before->window[0],
                       before->window[1], after->window[0], after->window[1]);
    if (before->stereo != after->stereo)
        gw_site_change(out, 0, "%s %s -> %s", WHAT("stereo"), gw_stereo_names[before->stereo],
                       gw_stereo_names[after->stereo]);
    number(out, 0, WHAT("gamma"), before->gamma, after->gamma);
    vector(out, WHAT("white"), before->white, after->white);
    number(out, 0, WHAT("brightness"), before->brightness, after->brightness);
#undef WHAT
}

static void compare_tile(gw_site_changes *out, const gw_tile *before, const gw_tile *after) {
    const gw_rectangle *from = &before->rectangle, *to = &after->rectangle;
    if (from->width != to->width || from->height != to->height) {
        gw_site_change(out, 1, "tile '%s': pixels %ux%u -> %ux%u", before->name, from->width, from->height,
                       to->width, to->height);
    } else if (memcmp(&before->plane, &after->plane, sizeof before->plane) != 0 || from->x != to->x ||
               from->y != to->y) {
        double old[4][3], new[4][3], moved[4];
        gw_tile_corners(before, old);
        gw_tile_corners(after, new);
        for (int i = 0; i < 4; i++)
            moved[i] = sqrt(pow(new[i][0] - old[i][0], 2) + pow(new[i][1] - old[i][1], 2) +
                            pow(new[i][2] - old[i][2], 2));
        gw_site_change(out, 0, "tile '%s': corners moved by %.3g, %.3g, %.3g and %.3g mm", before->name,
                       moved[0], moved[1], moved[2], moved[3]);
    }
    if (memcmp(before->picture, after->picture, sizeof before->picture) != 0)
        gw_site_change(out, 0, "tile '%s': place [%u, %u] -> [%u, %u]", before->name, before->picture[0],
                       before->picture[1], after->picture[0], after->picture[1]);
    if (memcmp(before->framed, after->framed, sizeof before->framed) != 0)
        gw_site_change(out, 0, "tile '%s': framed [%u, %u] -> [%u, %u]", before->name, before->framed[0],
                       before->framed[1], after->framed[0], after->framed[1]);
}

static void compare_tiles(gw_site_changes *out, const gw_site *before, const gw_site *after) {
    const gw_layout *from = &before->layout, *to = &after->layout;
    if (from->tile_count != to->tile_count)
        gw_site_change(out, 1, "tiles %u -> %u", from->tile_count, to->tile_count);
    if (from->picture[0] != to->picture[0] || from->picture[1] != to->picture[1])
        gw_site_change(out, 1, "picture %ux%u -> %ux%u px", from->picture[0], from->picture[1],
                       to->picture[0], to->picture[1]);
    if (from->framed[0] != to->framed[0] || from->framed[1] != to->framed[1])
        gw_site_change(out, 0, "picture with bezels %ux%u -> %ux%u px", from->framed[0], from->framed[1],
                       to->framed[0], to->framed[1]);
    for (uint32_t t = 0; t < from->tile_count && t < to->tile_count; t++) {
        if (strcmp(from->tiles[t].name, to->tiles[t].name) != 0) {
            gw_site_change(out, 1, "tile %u: name %s -> %s", t, from->tiles[t].name, to->tiles[t].name);
            continue;
        }
        compare_tile(out, &from->tiles[t], &to->tiles[t]);
        compare_panel(out, from->tiles[t].name, &before->panels[t], &after->panels[t]);
    }
}

gw_code gw_site_compare(const gw_site *before, const gw_site *after, gw_site_changes *out, gw_error *error) {
    const gw_site_times *from = &before->times, *to = &after->times;
    memset(out, 0, sizeof *out);
    vector(out, "eye", before->layout.eye, after->layout.eye);
    number(out, 0, "eye_distance", before->eye_distance, after->eye_distance);
    number(out, 0, "fly_speed", before->fly_speed, after->fly_speed);
    gw_site_compare_trackers(out, before, after);
    text(out, "address", before->address, after->address);
    number(out, 1, "times: load", from->load, to->load);
    number(out, 1, "times: frame", from->frame, to->frame);
    number(out, 1, "times: death", from->death, to->death);
    number(out, 1, "times: refresh", from->refresh, to->refresh);
    number(out, 1, "times: restarts", from->restarts, to->restarts);
    number(out, 1, "network: port", before->port, after->port);
    compare_tiles(out, before, after);
    if (out->restarts == 0)
        return GW_OK;
    for (uint32_t i = 0; i < out->count; i++)
        if (out->changes[i].restart)
            return gw_fail(error, GW_BAD_INPUT, "%s: cannot be changed while frames are drawn; start again",
                           out->changes[i].text);
    return gw_fail(error, GW_BAD_INPUT, "%u changes cannot be made while frames are drawn; start again",
                   out->restarts);
}
