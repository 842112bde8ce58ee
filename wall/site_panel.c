/* What drives each tile and what its panel is like: panel (for all), hosts (for groups of tiles), panels or
 * the tile's own panel (for one), the later over the earlier. */
#include "wall/site_internal.h"

#include "base/suggest.h"

#include <ctype.h>
#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

/* A host is handed to ssh and mpirun as a word of its own: it must not look like an option. */
static gw_code read_host(const gw_yaml_node *map, const char *key, char out[64], gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    gw_code code = gw_site_text(map, key, "-._:@", 64, out, error);
    if (!code && node && !isalnum((unsigned char)out[0]))
        return gw_yaml_fail(node, error,
                            "key '%s': '%s' is no host; expected a name or an address, as node1 or 10.0.0.5",
                            key, out);
    return code;
}

/* X11: [host]:display[.screen] */
static gw_code read_display(const gw_yaml_node *map, char out[64], gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "display");
    gw_code code = gw_site_text(map, "display", "-._:/", 64, out, error);
    if (code || !node)
        return code;
    const char *number = strrchr(out, ':');
    size_t digits = number ? strspn(number + 1, "0123456789") : 0;
    const char *rest = digits ? number + 1 + digits : "x";
    if (*rest == '.' && isdigit((unsigned char)rest[1]))
        rest += 1 + strspn(rest + 1, "0123456789");
    if (*rest != '\0')
        return gw_yaml_fail(node, error,
                            "key 'display': '%s' is no X display; expected one as \":0\" or \":0.1\"", out);
    return GW_OK;
}

static gw_code read_stereo(const gw_yaml_node *map, uint32_t *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "stereo");
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, "stereo", error);
    if (code)
        return code;
    for (uint32_t i = 0; i < GW_STEREO_COUNT; i++)
        if (!strcmp(gw_yaml_text(node), gw_stereo_names[i])) {
            *out = i;
            return GW_OK;
        }
    const char *near = gw_suggest(gw_yaml_text(node), gw_stereo_names, GW_STEREO_COUNT);
    return gw_yaml_fail(node, error,
                        "key 'stereo': '%.40s' is unknown%s%s; expected mono, side-by-side, top-bottom, "
                        "anaglyph, row-interlace, left or right",
                        gw_yaml_text(node), near ? "; did you mean " : "", near ? near : "");
}

static gw_code read_window(const gw_yaml_node *map, int32_t out[2], gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "window");
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_LIST, "window", error);
    if (!code && gw_yaml_count(node) != 2)
        return gw_yaml_fail(node, error,
                            "key 'window': expected [x, y], the window's top left corner in pixels");
    for (size_t i = 0; i < 2 && !code; i++) {
        long value = 0;
        code = gw_yaml_integer(gw_yaml_item(node, i), "window", -GW_MAXIMUM_WALL_SIDE, GW_MAXIMUM_WALL_SIDE,
                               &value, error);
        out[i] = (int32_t)value;
    }
    return code;
}

static gw_code read_light(const gw_yaml_node *map, gw_panel *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "gamma");
    gw_code code = GW_OK;
    if (node && gw_yaml_node_kind(node) == GW_YAML_SCALAR && !strcmp(gw_yaml_text(node), "srgb"))
        out->gamma = 0;
    else
        code = gw_site_number(map, "gamma", 1, 4, &out->gamma, error);
    node = code ? NULL : gw_yaml_find(map, "white");
    if (node)
        code = gw_yaml_numbers(node, "white", 3, out->white, error);
    for (int i = 0; i < 3 && node && !code; i++)
        if (!(out->white[i] >= 0.1 && out->white[i] <= 1))
            code = gw_yaml_fail(node, error,
                                "key 'white': %g is outside 0.1 to 1; expected gains of red, green and blue",
                                out->white[i]);
    return code ? code : gw_site_number(map, "brightness", 0.1, 1, &out->brightness, error);
}

/* Lays the keys of a map over *out; but for pixels, which the layout was made of (site_pixels.c). */
static gw_code read_panel(const gw_yaml_node *map, const char *key, int with_pixels, gw_panel *out,
                          gw_error *error) {
    static const char *const names[] = {"host",   "display", "monitor", "gpu",        "window",
                                        "stereo", "gamma",   "white",   "brightness", "pixels"};
    gw_code code = gw_site_map(map, key, names, GW_COUNT(names) - !with_pixels, error);
    if (!code)
        code = read_host(map, "host", out->host, error);
    if (!code)
        code = read_display(map, out->display, error);
    if (!code)
        code = gw_site_text(map, "monitor", "-._", sizeof out->monitor, out->monitor, error);
    if (!code && gw_yaml_find(map, "gpu")) {
        long value = 0;
        code = gw_yaml_integer(gw_yaml_find(map, "gpu"), "gpu", 0, 63, &value, error);
        out->gpu = (int32_t)value;
    }
    if (!code)
        code = read_window(map, out->window, error);
    if (!code)
        code = read_stereo(map, &out->stereo, error);
    return code ? code : read_light(map, out, error);
}

/* One host: its name, the tiles it drives, and panel keys for all of them. */
static gw_code read_group(const gw_yaml_node *group, gw_site_source *source, const gw_yaml_node **owner,
                          gw_site *site, gw_error *error) {
    static const char *const names[] = {"name", "tiles", "panel"};
    const gw_yaml_node *node, *tiles = NULL, *panel = NULL;
    char host[64] = "";
    gw_code code = gw_site_map(group, "hosts", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_require(group, "name", &node, error);
    if (!code)
        code = read_host(group, "name", host, error);
    if (!code)
        code = gw_site_require(group, "tiles", &tiles, error);
    if (!code)
        code = gw_yaml_expect(tiles, GW_YAML_LIST, "tiles", error);
    if (!code)
        panel = gw_yaml_find(group, "panel");
    for (size_t i = 0; !code && i < gw_yaml_count(tiles); i++) {
        const gw_yaml_node *item = gw_yaml_item(tiles, i);
        uint32_t matches = 0;
        code = gw_yaml_expect(item, GW_YAML_SCALAR, "tiles", error);
        for (uint32_t t = 0; t < site->layout.tile_count && !code; t++) {
            if (fnmatch(gw_yaml_text(item), site->layout.tiles[t].name, FNM_NOESCAPE))
                continue;
            matches++;
            if (owner[t])
                code = gw_yaml_fail(item, error,
                                    "key 'tiles': tile '%s' has a host already, in line %d; a tile runs once",
                                    site->layout.tiles[t].name, gw_yaml_node_line(owner[t]));
            owner[t] = item;
            memcpy(site->panels[t].host, host, sizeof host);
            if (panel && !code) {
                source->panels[t] = panel;
                code = read_panel(panel, "panel", 0, &site->panels[t], error);
            }
        }
        if (!code && !matches)
            code = gw_yaml_fail(item, error, "key 'tiles': no tile is called '%.60s'", gw_yaml_text(item));
    }
    return code;
}

static gw_code read_hosts(gw_site_source *source, gw_site *site, gw_error *error) {
    const gw_yaml_node *list = gw_yaml_find(source->root, "hosts"), *owner[GW_MAXIMUM_TILES] = {0};
    if (!list)
        return GW_OK;
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "hosts", error);
    for (size_t i = 0; !code && i < gw_yaml_count(list); i++) {
        if (i == GW_MAXIMUM_TILES)
            return gw_yaml_fail(list, error, "key 'hosts': a wall has at most %d hosts", GW_MAXIMUM_TILES);
        code = read_group(gw_yaml_item(list, i), source, owner, site, error);
    }
    return code;
}

static gw_code unknown_tile(const gw_yaml_node *node, const char *name, const gw_layout *layout,
                            gw_error *error) {
    const char *names[GW_MAXIMUM_TILES];
    for (uint32_t t = 0; t < layout->tile_count; t++)
        names[t] = layout->tiles[t].name;
    const char *near = gw_suggest(name, names, layout->tile_count);
    return gw_yaml_fail(node, error, "key 'panels': no tile is called '%.60s'%s%s%s", name,
                        near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* Panels of single tiles: the key panel of the tile or its wall, then the map panels. */
static gw_code read_single(gw_site_source *source, gw_site *site, gw_error *error) {
    const gw_yaml_node *map = gw_yaml_find(source->root, "panels");
    gw_code code = map ? gw_yaml_expect(map, GW_YAML_MAP, "panels", error) : GW_OK;
    for (uint32_t t = 0; t < site->layout.tile_count && !code; t++) {
        const gw_yaml_node *panel = gw_yaml_find(source->tiles[t], "panel");
        if (!panel)
            continue;
        source->panels[t] = panel;
        code = read_panel(panel, "panel", 0, &site->panels[t], error);
    }
    for (size_t i = 0; map && !code && i < gw_yaml_count(map); i++) {
        const gw_yaml_node *panel = gw_yaml_value(map, i);
        uint32_t t = 0;
        while (t < site->layout.tile_count && strcmp(gw_yaml_key(map, i), site->layout.tiles[t].name))
            t++;
        if (t == site->layout.tile_count)
            return unknown_tile(panel, gw_yaml_key(map, i), &site->layout, error);
        source->panels[t] = panel;
        code = read_panel(panel, "panels", 1, &site->panels[t], error);
    }
    return code;
}

gw_code gw_site_read_panels(gw_site_source *source, gw_site *site, gw_error *error) {
    const gw_yaml_node *panel = gw_yaml_find(source->root, "panel");
    gw_panel common = site->panels[0];
    gw_code code = panel ? read_panel(panel, "panel", 1, &common, error) : GW_OK;
    for (uint32_t t = 0; t < site->layout.tile_count && !code; t++) {
        site->panels[t] = common;
        source->panels[t] = panel ? panel : source->tiles[t];
    }
    if (!code)
        code = read_hosts(source, site, error);
    return code ? code : read_single(source, site, error);
}
