/* What only the whole site shows, beside its shape in space: panels driven twice or not as said, times and
 * eyes that cannot be meant. And the list of warnings. */
#include "wall/site_internal.h"

#include "wall/stereo.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void gw_site_note(gw_site_source *source, const gw_yaml_node *node, const char *format, ...) {
    gw_site_notes *notes = source->notes;
    if (notes->count == GW_MAXIMUM_NOTES) {
        notes->left_out++;
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(notes->notes[notes->count].text, sizeof notes->notes[0].text, format, arguments);
    va_end(arguments);
    notes->notes[notes->count++].line = gw_yaml_node_line(node);
}

void gw_site_warn(const char *path, const gw_site_notes *notes, const gw_log *log) {
    for (uint32_t i = 0; i < notes->count; i++)
        gw_log_write(log, GW_LOG_WARNING, "%s:%d: %s", path, notes->notes[i].line, notes->notes[i].text);
    if (notes->left_out)
        gw_log_write(log, GW_LOG_WARNING, "%s: %u more like these", path, notes->left_out);
}

static int same_display(const gw_panel *a, const gw_panel *b) {
    return a->display[0] && !strcmp(a->host, b->host) && !strcmp(a->display, b->display);
}

/* Windows of two tiles on one display without monitor names. */
static int windows_overlap(const gw_site *site, uint32_t a, uint32_t b) {
    const int32_t *at_a = site->panels[a].window, *at_b = site->panels[b].window;
    const gw_rectangle *size_a = &site->layout.tiles[a].rectangle, *size_b = &site->layout.tiles[b].rectangle;
    return at_a[0] < at_b[0] + (int32_t)size_b->width && at_b[0] < at_a[0] + (int32_t)size_a->width &&
           at_a[1] < at_b[1] + (int32_t)size_b->height && at_b[1] < at_a[1] + (int32_t)size_a->height;
}

static gw_code check_pairs(gw_site_source *source, const gw_site *site, gw_error *error) {
    const gw_tile *tiles = site->layout.tiles;
    uint32_t hidden = 0, hidden_pair[2] = {0, 0};
    for (uint32_t b = 0; b < site->layout.tile_count; b++)
        for (uint32_t a = 0; a < b; a++) {
            const gw_panel *first = &site->panels[a], *second = &site->panels[b];
            if (!same_display(first, second))
                continue;
            int line = gw_yaml_node_line(source->panels[a]);
            if (second->monitor[0] && !strcmp(first->monitor, second->monitor))
                return gw_yaml_fail(source->panels[b], error,
                                    "tiles '%s' and '%s' (line %d) are both a full screen on monitor %s of "
                                    "display %s%s%s; a monitor shows one tile",
                                    tiles[b].name, tiles[a].name, line, second->monitor, second->display,
                                    second->host[0] ? " of host " : "", second->host);
            if (!first->monitor[0] && !second->monitor[0] && windows_overlap(site, a, b) && hidden++ == 0)
                memcpy(hidden_pair, (const uint32_t[2]){a, b}, sizeof hidden_pair);
        }
    if (hidden)
        gw_site_note(
            source, source->panels[hidden_pair[1]],
            "the windows of tiles '%s' and '%s' hide each other on display %s%s; give each a 'window' "
            "or a 'monitor'",
            tiles[hidden_pair[0]].name, tiles[hidden_pair[1]].name, site->panels[hidden_pair[1]].display,
            hidden > 1 ? ", as more do" : "");
    return GW_OK;
}

/* Whether the tile for the other eye hangs where this one does: their middles are nearer than a tenth of its
 * width. */
static int has_partner(const gw_site *site, uint32_t tile) {
    uint32_t wanted = site->panels[tile].stereo == GW_STEREO_LEFT ? GW_STEREO_RIGHT : GW_STEREO_LEFT;
    double own[4][3], other[4][3];
    gw_tile_corners(&site->layout.tiles[tile], own);
    for (uint32_t t = 0; t < site->layout.tile_count; t++) {
        if (site->panels[t].stereo != wanted)
            continue;
        double away = 0, width = 0;
        gw_tile_corners(&site->layout.tiles[t], other);
        for (int i = 0; i < 3; i++) {
            away += pow(0.5 * (own[1][i] + own[2][i] - other[1][i] - other[2][i]), 2);
            width += pow(own[1][i] - own[0][i], 2);
        }
        if (away < 0.01 * width)
            return 1;
    }
    return 0;
}

static gw_code check_stereo(gw_site_source *source, const gw_site *site, uint32_t t, gw_error *error) {
    const gw_tile *tile = &site->layout.tiles[t];
    const gw_panel *panel = &site->panels[t];
    gw_error inner = {0};
    if (gw_stereo_check_tile(site, t, &inner))
        return gw_yaml_fail(source->panels[t], error, "key 'stereo': %s", inner.text);
    if ((panel->stereo == GW_STEREO_LEFT || panel->stereo == GW_STEREO_RIGHT) && !has_partner(site, t))
        gw_site_note(source, source->panels[t],
                     "tile '%s' is for the %s eye, but no tile for the other hangs in its place", tile->name,
                     gw_stereo_names[panel->stereo]);
    return GW_OK;
}

static void check_drive(gw_site_source *source, const gw_site *site, uint32_t t) {
    const gw_panel *panel = &site->panels[t];
    const char *name = site->layout.tiles[t].name;
    if (panel->monitor[0] && !panel->display[0])
        gw_site_note(source, source->panels[t],
                     "tile '%s' has a monitor, but no display: it is drawn without a window; add "
                     "'display'",
                     name);
    if (panel->gpu >= 0 && panel->display[0])
        gw_site_note(source, source->panels[t],
                     "tile '%s' has a gpu and a display; a display has its own GPU: leave out one of them",
                     name);
}

static void check_times(gw_site_source *source, const gw_site *site) {
    const gw_yaml_node *times = gw_yaml_find(source->root, "times"),
                       *distance = gw_yaml_find(source->root, "eye_distance");
    const gw_site_times *said = &site->times;
    if (times && said->frame > 0 && said->frame < 1 / said->refresh)
        gw_site_note(source, times,
                     "key 'times': 'frame' is %g s, less than one period of %g Hz: every tile will be late",
                     said->frame, said->refresh);
    if (distance && site->eye_distance > 0 && site->eye_distance < 40)
        gw_site_note(
            source, distance,
            "key 'eye_distance': %g mm are less than any grown-up's 50; expected mm, or 0 for no depth",
            site->eye_distance);
    for (uint32_t t = 0; distance && site->eye_distance == 0 && t < site->layout.tile_count; t++)
        if (site->panels[t].stereo != GW_STEREO_MONO) {
            gw_site_note(source, distance, "key 'eye_distance': 0 mm: stereo will have no depth");
            break;
        }
}

static void check_hosts(gw_site_source *source, const gw_site *site) {
    uint32_t hosted = 0, first = 0;
    for (uint32_t t = 0; t < site->layout.tile_count; t++) {
        if (site->panels[t].host[0])
            hosted++;
        else if (hosted == t)
            first = t;
    }
    if (hosted > 0 && hosted < site->layout.tile_count)
        gw_site_note(source, source->panels[first],
                     "tile '%s'%s has no host and runs where Gazewall is started, while %u others have one",
                     site->layout.tiles[first].name,
                     hosted + 1 < site->layout.tile_count ? ", as some more," : "", hosted);
}

gw_code gw_site_check(gw_site_source *source, const gw_site *site, gw_error *error) {
    gw_code code = gw_site_check_space(source, site, error);
    if (!code)
        code = check_pairs(source, site, error);
    for (uint32_t t = 0; t < site->layout.tile_count && !code; t++) {
        check_drive(source, site, t);
        code = check_stereo(source, site, t, error);
    }
    if (code)
        return code;
    check_hosts(source, site);
    check_times(source, site);
    return GW_OK;
}
