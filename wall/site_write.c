/* A site as text: every tile by its corners, whatever made them. Reading it gives the same bits again. */
#include "wall/site_internal.h"

#include "render/vector3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gw_site_put_number(FILE *out, double value) {
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

void gw_site_put_numbers(FILE *out, const double *values, int count) {
    for (int i = 0; i < count; i++) {
        fputs(i ? ", " : "[", out);
        gw_site_put_number(out, values[i]);
    }
    fputs("]", out);
}

/* A second corner from which the reader works out exactly this step: (end - corner) / pixels == step. The
 * nearest doubles are tried, for multiplying rounds otherwise than dividing. */
static int exact_end(double corner, double step, uint32_t pixels, double *end) {
    double guess = corner + step * pixels;
    double unit = fmax(fabs(guess), fabs(step * pixels)) * 0x1p-53;
    for (int k = 0; k <= 16; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            *end = guess + sign * k * unit;
            if ((*end - corner) / pixels == step)
                return 1;
        }
    *end = guess;
    return 0;
}

static int exact_corners(const gw_plane *plane, const uint32_t pixels[2], double corners[3][3]) {
    int exact = 1;
    for (int i = 0; i < 3; i++) {
        corners[0][i] = plane->corner[i];
        exact &= exact_end(plane->corner[i], plane->step_x[i], pixels[0], &corners[1][i]);
        exact &= exact_end(plane->corner[i], plane->step_y[i], pixels[1], &corners[2][i]);
    }
    return exact;
}

/* How many pixels the tile's plane has: at least up to the last tile that is cut from it. */
static void whole_plane(const gw_layout *layout, const gw_tile *tile, uint32_t out[2]) {
    out[0] = out[1] = 0;
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *other = &layout->tiles[t];
        if (memcmp(&other->plane, &tile->plane, sizeof tile->plane) != 0)
            continue;
        out[0] = (uint32_t)fmax(out[0], other->rectangle.x + (double)other->rectangle.width);
        out[1] = (uint32_t)fmax(out[1], other->rectangle.y + (double)other->rectangle.height);
    }
}

static void put_panel(FILE *out, const gw_panel *panel) {
    const char *comma = "";
    fputs("    panel: {", out);
    const struct {
        const char *key, *text, *quote;
    } texts[] = {
        {"host", panel->host, ""}, {"display", panel->display, "\""}, {"monitor", panel->monitor, ""}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (texts[i].text[0]) {
            fprintf(out, "%s%s: %s%s%s", comma, texts[i].key, texts[i].quote, texts[i].text, texts[i].quote);
            comma = ", ";
        }
    if (panel->gpu >= 0) {
        fprintf(out, "%sgpu: %d", comma, panel->gpu);
        comma = ", ";
    }
    fprintf(out, "%swindow: [%d, %d], stereo: %s, gamma: ", comma, panel->window[0], panel->window[1],
            gw_stereo_names[panel->stereo]);
    if (panel->gamma > 0)
        gw_site_put_number(out, panel->gamma);
    else
        fputs("srgb", out);
    fputs(", white: ", out);
    gw_site_put_numbers(out, panel->white, 3);
    fputs(", brightness: ", out);
    gw_site_put_number(out, panel->brightness);
    fputs("}\n", out);
}

static void put_tile(FILE *out, const gw_site *site, uint32_t index) {
    const gw_tile *tile = &site->layout.tiles[index];
    const gw_rectangle *at = &tile->rectangle;
    double corners[3][3];
    uint32_t whole[2];
    whole_plane(&site->layout, tile, whole);
    /* A plane that no tile uses to its end: its own number of pixels is one of the next. */
    for (uint32_t wider = 0; !exact_corners(&tile->plane, whole, corners) && wider < 1024; wider++) {
        whole[0]++;
        whole[1]++;
    }
    fprintf(out, "  - name: %s\n    corners: [", tile->name);
    for (int i = 0; i < 3; i++) {
        fputs(i ? ", " : "", out);
        gw_site_put_numbers(out, corners[i], 3);
    }
    fprintf(out, "]\n    pixels: [%u, %u]\n    place: [%u, %u]\n    framed: [%u, %u]\n", at->width,
            at->height, tile->picture[0], tile->picture[1], tile->framed[0], tile->framed[1]);
    if (at->x || at->y || whole[0] != at->width || whole[1] != at->height)
        fprintf(out, "    part: {of: [%u, %u], at: [%d, %d]}\n", whole[0], whole[1], at->x, at->y);
    put_panel(out, &site->panels[index]);
}

static void put_rest(FILE *out, const gw_site *site) {
    fputs("version: 1\neye: ", out);
    gw_site_put_numbers(out, site->layout.eye, 3);
    fputs("\neye_distance: ", out);
    gw_site_put_number(out, site->eye_distance);
    fputs("\n", out);
    gw_site_put_trackers(out, site);
    fputs("navigation: {fly_speed: ", out);
    gw_site_put_number(out, site->fly_speed);
    if (site->address[0] || site->port)
        fputs("}\nnetwork: {", out);
    if (site->address[0])
        fprintf(out, "address: \"%s\"%s", site->address, site->port ? ", " : "");
    if (site->port)
        fprintf(out, "port: %u", site->port);
    const struct {
        const char *key;
        double value;
    } times[] = {{"load", site->times.load},
                 {"frame", site->times.frame},
                 {"death", site->times.death},
                 {"refresh", site->times.refresh}};
    fputs("}\ntimes: {", out);
    const char *comma = "";
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++)
        if (times[i].value > 0) {
            fprintf(out, "%s%s: ", comma, times[i].key);
            gw_site_put_number(out, times[i].value);
            comma = ", ";
        }
    fprintf(out, "%srestarts: %g", comma, site->times.restarts);
    fprintf(out, "}\nframed_size: [%u, %u]\n", site->layout.framed[0], site->layout.framed[1]);
}

gw_code gw_site_write(const gw_site *site, char **text, size_t *size, gw_error *error) {
    *text = NULL;
    FILE *out = open_memstream(text, size);
    if (!out)
        return gw_fail(error, GW_MACHINE, "memory is out while writing a site");
    put_rest(out, site);
    fputs("tiles:\n", out);
    for (uint32_t t = 0; t < site->layout.tile_count; t++)
        put_tile(out, site, t);
    return fclose(out) == 0 ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while writing a site");
}
