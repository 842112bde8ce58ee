/* Site files: YAML to site. The format is docs/sites.md; every key not listed here is an error. */
#include "wall/site.h"

#include "base/yaml.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static gw_code read_map(const gw_yaml_node *node, const char *key, const char *const *names, size_t count,
                        gw_error *error) {
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, key, error);
    return code ? code : gw_yaml_check_keys(node, names, count, error);
}

/* The value of a key that must be there. */
static gw_code require(const gw_yaml_node *map, const char *key, const gw_yaml_node **out, gw_error *error) {
    *out = gw_yaml_find(map, key);
    return *out ? GW_OK : gw_yaml_fail(map, error, "key '%s' is missing here", key);
}

/* [width, height] in whole pixels. */
static gw_code read_pixels(const gw_yaml_node *map, const char *key, uint32_t out[2], gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = require(map, key, &node, error);
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
    gw_code code = require(map, "tile", &tile, error);
    if (!code)
        code = read_map(tile, "tile", names, COUNT(names), error);
    for (int i = 0; i < 2 && !code; i++) {
        code = require(tile, names[i], &node, error);
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
    gw_code code = read_map(bezel, "bezel", names, COUNT(names), error);
    for (size_t i = 0; i < COUNT(names) && !code; i++) {
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
    gw_code code = read_map(map, "grid", names, COUNT(names), error);
    uint32_t *const counts[] = {&grid.columns, &grid.rows};
    for (size_t i = 0; i < 2 && !code; i++) {
        const gw_yaml_node *node;
        long value = 0;
        code = require(map, names[i], &node, error);
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
    gw_code code = require(map, "name", &node, error);
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
    gw_code code = require(map, "corners", &node, error);
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
    gw_code code = require(map, "place", &node, error);
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
    static const char *const names[] = {"name", "corners", "pixels", "place"};
    gw_tile *tile = &out->tiles[out->tile_count];
    uint32_t pixels[2] = {0, 0};
    gw_code code = read_map(map, "tiles", names, COUNT(names), error);
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

static gw_code read_tiles(const gw_yaml_node *list, const double eye[3], gw_layout *out, gw_error *error) {
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
        code = read_tile(gw_yaml_item(list, i), out, error);
    if (code)
        return code;
    gw_error inner = {0};
    code = gw_layout_measure(out, &inner);
    return code ? gw_yaml_fail(list, error, "key 'tiles': %s", inner.text) : GW_OK;
}

static gw_code read_site(const gw_yaml_node *root, gw_layout *out, gw_error *error) {
    static const char *const names[] = {"version", "eye", "grid", "tiles"};
    const gw_yaml_node *node;
    long version = 0;
    double eye[3] = {0, 0, 1800};
    gw_code code = read_map(root, "site", names, COUNT(names), error);
    if (!code)
        code = require(root, "version", &node, error);
    if (!code)
        code = gw_yaml_integer(node, "version", 1, 1, &version, error);
    node = code ? NULL : gw_yaml_find(root, "eye");
    if (node)
        code = gw_yaml_numbers(node, "eye", 3, eye, error);
    if (code)
        return code;
    const gw_yaml_node *grid = gw_yaml_find(root, "grid"), *tiles = gw_yaml_find(root, "tiles");
    if (!grid == !tiles)
        return gw_yaml_fail(root, error, "a site has either 'grid' or 'tiles'; this one has %s",
                            grid ? "both" : "neither");
    return grid ? read_grid(grid, eye, out, error) : read_tiles(tiles, eye, out, error);
}

gw_code gw_site_load(const char *path, gw_site *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_site_defaults(out);
    gw_yaml *document = NULL;
    gw_code code = gw_yaml_load(path, &document, error);
    if (!code)
        code = read_site(gw_yaml_root(document), &out->layout, error);
    gw_yaml_destroy(&document);
    return code;
}
