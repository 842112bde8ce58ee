/* Site files: YAML to site. The format is docs/sites.md; every key not listed here is an error. */
#include "wall/site_internal.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

gw_code gw_site_map(const gw_yaml_node *node, const char *key, const char *const *names, size_t count,
                    gw_error *error) {
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, key, error);
    return code ? code : gw_yaml_check_keys(node, names, count, error);
}

gw_code gw_site_require(const gw_yaml_node *map, const char *key, const gw_yaml_node **out, gw_error *error) {
    *out = gw_yaml_find(map, key);
    return *out ? GW_OK : gw_yaml_fail(map, error, "key '%s' is missing here", key);
}

gw_code gw_site_number(const gw_yaml_node *map, const char *key, double minimum, double maximum, double *out,
                       gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    return node ? gw_yaml_number(node, key, minimum, maximum, out, error) : GW_OK;
}

gw_code gw_site_text(const gw_yaml_node *map, const char *key, const char *others, size_t size, char *out,
                     gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, key, error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    size_t length = strlen(text);
    if (length < 1 || length >= size)
        return gw_yaml_fail(node, error, "key '%s': %zu characters; expected 1 to %zu", key, length,
                            size - 1);
    for (size_t i = 0; i < length; i++)
        if (!isalnum((unsigned char)text[i]) && !strchr(others, text[i]))
            return gw_yaml_fail(node, error,
                                "key '%s': '%.60s' has a character that cannot be here; expected letters, "
                                "digits and any of %s",
                                key, text, others);
    memcpy(out, text, length + 1);
    return GW_OK;
}

/* [width, height] in whole pixels. */
static gw_code read_pixels(const gw_yaml_node *map, const char *key, uint32_t out[2], gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = gw_site_require(map, key, &node, error);
    if (!code)
        code = gw_yaml_expect(node, GW_YAML_LIST, key, error);
    if (!code && gw_yaml_count(node) != 2)
        code = gw_yaml_fail(node, error, "key '%s': must be [width, height] in pixels", key);
    for (size_t i = 0; i < 2 && !code; i++) {
        long value = 0;
        code = gw_yaml_integer(gw_yaml_item(node, i), key, 1, GW_MAXIMUM_WALL_SIDE, &value, error);
        out[i] = (uint32_t)value;
    }
    return code;
}

static gw_code read_grid_tile(const gw_yaml_node *map, gw_grid *grid, gw_error *error) {
    static const char *const names[] = {"width", "height", "pixels"};
    const gw_yaml_node *tile, *node;
    uint32_t pixels[2] = {0, 0};
    double size[2] = {0, 0};
    gw_code code = gw_site_require(map, "tile", &tile, error);
    if (!code)
        code = gw_site_map(tile, "tile", names, GW_COUNT(names), error);
    for (int i = 0; i < 2 && !code; i++) {
        code = gw_site_require(tile, names[i], &node, error);
        if (!code)
            code = gw_yaml_number(node, names[i], 1, 1e5, &size[i], error);
    }
    if (!code)
        code = read_pixels(tile, "pixels", pixels, error);
    if (code)
        return code;
    for (uint32_t i = 0; i < grid->columns; i++)
        grid->widths[i] = pixels[0];
    for (uint32_t i = 0; i < grid->rows; i++)
        grid->heights[i] = pixels[1];
    grid->pitch[0] = size[0] / pixels[0];
    grid->pitch[1] = size[1] / pixels[1];
    return GW_OK;
}

static gw_code read_bezel(const gw_yaml_node *map, gw_grid *grid, gw_error *error) {
    static const char *const names[] = {"left", "right", "top", "bottom"};
    double *const sides[] = {&grid->left, &grid->right, &grid->top, &grid->bottom};
    const gw_yaml_node *bezel = gw_yaml_find(map, "bezel");
    if (!bezel)
        return GW_OK;
    gw_code code = gw_site_map(bezel, "bezel", names, GW_COUNT(names), error);
    for (size_t i = 0; i < GW_COUNT(names) && !code; i++) {
        const gw_yaml_node *node = gw_yaml_find(bezel, names[i]);
        if (node)
            code = gw_yaml_number(node, names[i], 0, 1e4, sides[i], error);
    }
    return code;
}

static gw_code read_grid(const gw_yaml_node *map, const double eye[3], gw_layout *out, gw_error *error) {
    static const char *const names[] = {"columns", "rows", "tile", "bezel"};
    gw_grid grid = {0};
    memcpy(grid.eye, eye, sizeof grid.eye);
    gw_code code = gw_site_map(map, "grid", names, GW_COUNT(names), error);
    uint32_t *const counts[] = {&grid.columns, &grid.rows};
    for (size_t i = 0; i < 2 && !code; i++) {
        const gw_yaml_node *node;
        long value = 0;
        code = gw_site_require(map, names[i], &node, error);
        if (!code)
            code = gw_yaml_integer(node, names[i], 1, GW_MAXIMUM_TILES, &value, error);
        *counts[i] = (uint32_t)value;
    }
    if (!code)
        code = read_grid_tile(map, &grid, error);
    if (!code)
        code = read_bezel(map, &grid, error);
    if (code)
        return code;
    gw_error inner = {0};
    code = gw_layout_grid(&grid, out, &inner);
    return code ? gw_yaml_fail(map, error, "key 'grid': %s", inner.text) : GW_OK;
}

static gw_code read_name(const gw_yaml_node *map, const gw_layout *layout, char name[32], gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = gw_site_require(map, "name", &node, error);
    if (!code)
        code = gw_yaml_expect(node, GW_YAML_SCALAR, "name", error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    size_t length = strlen(text);
    int good = length >= 1 && length <= 31;
    for (size_t i = 0; i < length && good; i++)
        good = isalnum((unsigned char)text[i]) || text[i] == '-' || text[i] == '_';
    if (!good)
        return gw_yaml_fail(node, error,
                            "key 'name': '%s' cannot name a tile; use 1 to 31 letters, digits, '-' and '_'",
                            text);
    for (uint32_t i = 0; i < layout->tile_count; i++)
        if (!strcmp(layout->tiles[i].name, text))
            return gw_yaml_fail(node, error, "key 'name': '%s' names an earlier tile already", text);
    memcpy(name, text, length + 1);
    return GW_OK;
}

/* Three measured corners, as the panel's picture has them: top left, top right, bottom left. */
static gw_code read_corners(const gw_yaml_node *map, gw_tile *tile, gw_error *error) {
    const gw_yaml_node *node;
    double corners[3][3];
    gw_code code = gw_site_require(map, "corners", &node, error);
    if (!code)
        code = gw_yaml_expect(node, GW_YAML_LIST, "corners", error);
    if (!code && gw_yaml_count(node) != 3)
        code = gw_yaml_fail(node, error,
                            "key 'corners': must be three points in mm: top left, top right, bottom left");
    for (size_t i = 0; i < 3 && !code; i++)
        code = gw_yaml_numbers(gw_yaml_item(node, i), "corners", 3, corners[i], error);
    if (code)
        return code;
    double across = 0, down = 0, dot = 0;
    for (int i = 0; i < 3; i++) {
        double x = corners[1][i] - corners[0][i], y = corners[2][i] - corners[0][i];
        tile->plane.corner[i] = corners[0][i];
        tile->plane.step_x[i] = x / tile->rectangle.width;
        tile->plane.step_y[i] = y / tile->rectangle.height;
        across += x * x;
        down += y * y;
        dot += x * y;
    }
    if (!(across >= 1 && down >= 1 && across < 1e10 && down < 1e10))
        return gw_yaml_fail(
            node, error,
            "key 'corners': the tile is %g x %g mm; both must be 1 mm to 100 m (corners are in mm)",
            sqrt(across), sqrt(down));
    if (fabs(dot) > 0.05 * sqrt(across * down))
        return gw_yaml_fail(
            node, error,
            "key 'corners': the top and left edges meet at %.1f degrees instead of 90; are the corners "
            "in the order top left, top right, bottom left?",
            acos(dot / sqrt(across * down)) * 57.29577951308232);
    return GW_OK;
}

/* Where the tile stands in the picture without bezels: [x, y] px. */
static gw_code read_place(const gw_yaml_node *map, gw_tile *tile, gw_error *error) {
    const gw_yaml_node *node;
    double place[2] = {0, 0};
    gw_code code = gw_site_require(map, "place", &node, error);
    if (!code)
        code = gw_yaml_numbers(node, "place", 2, place, error);
    for (int i = 0; i < 2 && !code; i++) {
        if (!(place[i] >= 0 && place[i] < GW_MAXIMUM_WALL_SIDE) || floor(place[i]) != place[i])
            return gw_yaml_fail(node, error, "key 'place': %g is not a whole number of pixels from 0 to %d",
                                place[i], GW_MAXIMUM_WALL_SIDE - 1);
        tile->picture[i] = (uint32_t)place[i];
    }
    return code;
}

static int overlap(const gw_tile *a, const gw_tile *b) {
    return a->picture[0] < b->picture[0] + b->rectangle.width &&
           b->picture[0] < a->picture[0] + a->rectangle.width &&
           a->picture[1] < b->picture[1] + b->rectangle.height &&
           b->picture[1] < a->picture[1] + a->rectangle.height;
}

static gw_code read_tile(const gw_yaml_node *map, gw_layout *out, gw_error *error) {
    static const char *const names[] = {"name", "corners", "pixels", "place", "panel"};
    gw_tile *tile = &out->tiles[out->tile_count];
    uint32_t pixels[2] = {0, 0};
    gw_code code = gw_site_map(map, "tiles", names, GW_COUNT(names), error);
    if (!code)
        code = read_name(map, out, tile->name, error);
    if (!code)
        code = read_pixels(map, "pixels", pixels, error);
    if (code)
        return code;
    tile->rectangle = (gw_rectangle){.width = pixels[0], .height = pixels[1]};
    code = read_corners(map, tile, error);
    if (!code)
        code = read_place(map, tile, error);
    if (code)
        return code;
    for (uint32_t i = 0; i < out->tile_count; i++)
        if (overlap(tile, &out->tiles[i]))
            return gw_yaml_fail(map, error,
                                "tile '%s' overlaps tile '%s' in the picture; correct 'place' or 'pixels'",
                                tile->name, out->tiles[i].name);
    out->tile_count++;
    return GW_OK;
}

static gw_code read_tiles(gw_site_source *source, const gw_yaml_node *list, const double eye[3],
                          gw_layout *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    memcpy(out->eye, eye, sizeof out->eye);
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "tiles", error);
    if (code)
        return code;
    size_t count = gw_yaml_count(list);
    if (count < 1 || count > GW_MAXIMUM_TILES)
        return gw_yaml_fail(list, error, "key 'tiles': a wall has 1 to %d tiles, not %zu", GW_MAXIMUM_TILES,
                            count);
    for (size_t i = 0; i < count && !code; i++)
        code = read_tile(source->tiles[i] = gw_yaml_item(list, i), out, error);
    if (code)
        return code;
    gw_error inner = {0};
    code = gw_layout_measure(out, &inner);
    return code ? gw_yaml_fail(list, error, "key 'tiles': %s", inner.text) : GW_OK;
}

static gw_code read_layout(gw_site_source *source, gw_layout *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(source->root, "eye");
    double eye[3] = {0, 0, 1800};
    gw_code code = node ? gw_yaml_numbers(node, "eye", 3, eye, error) : GW_OK;
    if (code)
        return code;
    const gw_yaml_node *grid = gw_yaml_find(source->root, "grid"),
                       *tiles = gw_yaml_find(source->root, "tiles");
    if (!grid == !tiles)
        return gw_yaml_fail(source->root, error, "a site has either 'grid' or 'tiles'; this one has %s",
                            grid ? "both" : "neither");
    if (tiles)
        return read_tiles(source, tiles, eye, out, error);
    code = read_grid(grid, eye, out, error);
    for (uint32_t t = 0; t < out->tile_count && !code; t++)
        source->tiles[t] = grid;
    return code;
}

static gw_code read_times(const gw_yaml_node *root, gw_site_times *out, gw_error *error) {
    static const char *const names[] = {"load", "frame", "death", "refresh"};
    const gw_yaml_node *map = gw_yaml_find(root, "times");
    if (!map)
        return GW_OK;
    gw_code code = gw_site_map(map, "times", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_number(map, "load", 1, 86400, &out->load, error);
    if (!code)
        code = gw_site_number(map, "frame", 0.001, 60, &out->frame, error);
    if (!code)
        code = gw_site_number(map, "death", 0.2, 600, &out->death, error);
    if (!code)
        code = gw_site_number(map, "refresh", 1, 1000, &out->refresh, error);
    if (!code && out->death <= out->frame)
        return gw_yaml_fail(map, error,
                            "key 'times': a tile would be lost after %g s, before it is late after %g s; "
                            "'death' must be greater than 'frame'",
                            out->death, out->frame);
    return code;
}

static gw_code read_network(const gw_yaml_node *root, char out[64], gw_error *error) {
    static const char *const names[] = {"address"};
    const gw_yaml_node *map = gw_yaml_find(root, "network");
    if (!map)
        return GW_OK;
    struct in6_addr bytes;
    gw_code code = gw_site_map(map, "network", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_text(map, "address", ".:", 64, out, error);
    if (!code && out[0] && inet_pton(AF_INET, out, &bytes) != 1 && inet_pton(AF_INET6, out, &bytes) != 1)
        return gw_yaml_fail(gw_yaml_find(map, "address"), error,
                            "key 'address': '%s' is no address; expected one of this machine's own, as "
                            "10.0.0.1",
                            out);
    return code;
}

static gw_code read_viewer(const gw_yaml_node *root, gw_site *out, gw_error *error) {
    static const char *const names[] = {"fly_speed"};
    const gw_yaml_node *map = gw_yaml_find(root, "navigation");
    gw_code code = gw_site_number(root, "eye_distance", 0, 100, &out->eye_distance, error);
    if (!code)
        code = gw_site_text(root, "tracker", "-._:/@+,=%~ ", sizeof out->tracker, out->tracker, error);
    if (!code && map)
        code = gw_site_map(map, "navigation", names, GW_COUNT(names), error);
    return code || !map ? code : gw_site_number(map, "fly_speed", 0, 1e6, &out->fly_speed, error);
}

static gw_code read_site(gw_site_source *source, gw_site *out, gw_error *error) {
    static const char *const names[] = {"version", "eye",   "eye_distance", "tracker", "navigation", "times",
                                        "network", "panel", "panels",       "hosts",   "grid",       "tiles"};
    const gw_yaml_node *node, *root = source->root;
    long version = 0;
    gw_code code = gw_site_map(root, "site", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_require(root, "version", &node, error);
    if (!code)
        code = gw_yaml_integer(node, "version", 1, 1, &version, error);
    if (!code)
        code = read_layout(source, &out->layout, error);
    if (!code)
        code = gw_site_read_panels(source, out, error);
    if (!code)
        code = read_times(root, &out->times, error);
    if (!code)
        code = read_network(root, out->address, error);
    return code ? code : read_viewer(root, out, error);
}

gw_code gw_site_load(const char *path, gw_site *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_site_defaults(out);
    gw_yaml *document = NULL;
    gw_code code = gw_yaml_load(path, &document, error);
    if (!code) {
        gw_site_source source = {.root = gw_yaml_root(document)};
        code = read_site(&source, out, error);
    }
    gw_yaml_destroy(&document);
    return code;
}
