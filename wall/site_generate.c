/* Generators: grid (flat), curve (bent) and walls (several of either), from tape-measure figures to tiles. */
#include "wall/site_internal.h"

#include "render/vector3.h"

#include <math.h>
#include <string.h>

static const double degrees = 57.29577951308232;

static gw_code read_count(const gw_yaml_node *map, const char *key, int needed, uint32_t *out,
                          gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    long value = 1;
    if (!node && needed)
        return gw_site_require(map, key, &node, error);
    gw_code code = node ? gw_yaml_integer(node, key, 1, GW_MAXIMUM_TILES, &value, error) : GW_OK;
    *out = (uint32_t)value;
    return code;
}

static gw_code read_tile(const gw_site_source *source, const gw_yaml_node *map, gw_grid *grid,
                         gw_error *error) {
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
        code = gw_site_pixels_of(source, tile, NULL, pixels, error);
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
    gw_code code = bezel ? gw_site_map(bezel, "bezel", names, GW_COUNT(names), error) : GW_OK;
    for (size_t i = 0; i < GW_COUNT(names) && bezel && !code; i++)
        code = gw_site_number(bezel, names[i], 0, 1e4, sides[i], error);
    return code;
}

/* One number for all pairs of neighbours, or one for each. */
static gw_code read_pairs(const gw_yaml_node *map, const char *key, uint32_t parts, double *out,
                          gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    uint32_t pairs = parts - 1;
    gw_code code = GW_OK;
    if (!node)
        return GW_OK;
    int list = gw_yaml_node_kind(node) == GW_YAML_LIST;
    if (list && gw_yaml_count(node) != pairs)
        return gw_yaml_fail(node, error,
                            "key '%s': %zu gaps; %u %s have %u gaps between them (or one number for all)",
                            key, gw_yaml_count(node), parts, key, pairs);
    for (uint32_t i = 0; i < pairs && !code; i++)
        code = gw_yaml_number(list ? gw_yaml_item(node, i) : node, key, 0, 1e4, &out[i], error);
    return code;
}

static gw_code read_gaps(const gw_yaml_node *map, gw_grid *grid, gw_error *error) {
    static const char *const names[] = {"columns", "rows"};
    const gw_yaml_node *gaps = gw_yaml_find(map, "gaps");
    if (!gaps)
        return GW_OK;
    if (gw_yaml_find(map, "bezel"))
        return gw_yaml_fail(gaps, error,
                            "key 'gaps': there is a 'bezel', too; keep one of them (a gap is all that is "
                            "between two lit areas)");
    gw_code code = gw_site_map(gaps, "gaps", names, GW_COUNT(names), error);
    if (!code)
        code = read_pairs(gaps, "columns", grid->columns, grid->column_gaps, error);
    return code ? code : read_pairs(gaps, "rows", grid->rows, grid->row_gaps, error);
}

/* Two directions of any length, at right angles give or take 0.1 degrees. */
static gw_code read_directions(const gw_yaml_node *map, gw_hang *hang, gw_error *error) {
    const gw_yaml_node *right = gw_yaml_find(map, "right"), *up = gw_yaml_find(map, "up");
    if (!right && !up)
        return GW_OK;
    if (!right || !up)
        return gw_yaml_fail(right ? right : up, error,
                            "key '%s' needs '%s' beside it: the directions of the picture's rows and columns",
                            right ? "right" : "up", right ? "up" : "right");
    gw_code code = gw_site_point(right, "right", hang->right, error);
    if (!code)
        code = gw_site_point(up, "up", hang->up, error);
    if (code)
        return code;
    if (!gw_normalise(hang->right, 0) || !gw_normalise(hang->up, 0))
        return gw_yaml_fail(right, error,
                            "keys 'right' and 'up': [0, 0, 0] is no direction; expected one as [1, 0, 0]");
    double dot = gw_dot(hang->right, hang->up);
    if (fabs(dot) > 0.1 / degrees)
        return gw_yaml_fail(up, error, "keys 'right' and 'up' are at %.2f degrees instead of 90",
                            acos(fmax(-1, fmin(1, dot))) * degrees);
    for (int i = 0; i < 3; i++)
        hang->up[i] -= dot * hang->right[i];
    gw_normalise(hang->up, 0);
    return GW_OK;
}

/* The angle from column to column: said, or such that the frames (with their gap) touch. */
static gw_code read_angle(const gw_yaml_node *map, const gw_grid *grid, gw_hang *hang, gw_error *error) {
    const gw_yaml_node *each = gw_yaml_find(map, "angle"), *total = gw_yaml_find(map, "total_angle");
    double width = grid->widths[0] * grid->pitch[0] + grid->left + grid->right, angle = 0;
    for (uint32_t i = 1; i + 1 < grid->columns; i++)
        if (grid->column_gaps[i] != grid->column_gaps[0])
            return gw_yaml_fail(map, error,
                                "key 'gaps': on a curve all gaps between columns are the same; give one "
                                "number, or measured 'tiles'");
    if (each && total)
        return gw_yaml_fail(total, error, "keys 'angle' and 'total_angle': keep one of them");
    if (!each && !total) {
        hang->angle = 2 * atan(0.5 * (width + grid->column_gaps[0]) / hang->radius);
    } else {
        gw_code code = gw_site_number(map, each ? "angle" : "total_angle", 0.01, 360, &angle, error);
        if (code)
            return code;
        hang->angle = angle / degrees / (each ? 1 : grid->columns);
        if (grid->column_gaps[0] > 0)
            return gw_yaml_fail(each ? each : total, error,
                                "the gaps between columns follow from 'radius' and the angle; leave "
                                "'columns' out of 'gaps'");
        double side = hang->angle < 3.1 ? 2 * hang->radius * tan(0.5 * hang->angle) : INFINITY;
        if (grid->columns > 1 && side < width - 0.5)
            return gw_yaml_fail(each ? each : total, error,
                                "at %g degrees from column to column and %g mm radius there are %.1f mm for "
                                "each tile, whose frame is %.1f mm wide; expected at least %.2f degrees",
                                hang->angle * degrees, hang->radius, side, width,
                                2 * atan(0.5 * width / hang->radius) * degrees);
    }
    if (hang->angle * grid->columns > 360.01 / degrees)
        return gw_yaml_fail(map, error, "%u columns at %g degrees are more than a full circle", grid->columns,
                            hang->angle * degrees);
    return GW_OK;
}

static gw_code read_bend(const gw_yaml_node *map, const gw_grid *grid, gw_hang *hang, gw_error *error) {
    double lean = 0;
    gw_code code = gw_site_number(map, "radius", 100, 1e6, &hang->radius, error);
    if (!code)
        code = read_angle(map, grid, hang, error);
    if (!code)
        code = gw_site_number(map, "lean", 0, 90, &lean, error);
    hang->lean = lean / degrees;
    if (!code && lean * (grid->rows - 1) > 180)
        code = gw_yaml_fail(gw_yaml_find(map, "lean"), error,
                            "key 'lean': %u rows at %g degrees from row to row lean more than half a turn",
                            grid->rows, lean);
    return code;
}

/* Columns, rows and tile of a grid, and where it hangs. */
static gw_code read_array(const gw_site_source *source, const gw_yaml_node *map, int counts_needed,
                          gw_grid *grid, gw_hang *hang, gw_error *error) {
    const gw_yaml_node *centre = gw_yaml_find(map, "centre");
    gw_code code = read_count(map, "columns", counts_needed, &grid->columns, error);
    if (!code)
        code = read_count(map, "rows", counts_needed, &grid->rows, error);
    if (!code)
        code = read_tile(source, map, grid, error);
    if (!code)
        code = read_bezel(map, grid, error);
    if (!code)
        code = read_gaps(map, grid, error);
    if (!code && centre)
        code = gw_site_point(centre, "centre", hang->centre, error);
    return code ? code : read_directions(map, hang, error);
}

static gw_code add(gw_site_source *source, const gw_yaml_node *map, const gw_grid *grid, const gw_hang *hang,
                   const char *name, const uint32_t place[2], gw_layout *out, uint32_t framed_end[2],
                   gw_error *error) {
    gw_error inner = {0};
    uint32_t first = out->tile_count;
    gw_code code = gw_layout_add_grid(grid, hang, name, place, place, out, framed_end, &inner);
    for (uint32_t t = first; t < out->tile_count; t++)
        source->tiles[t] = map;
    if (code)
        return gw_yaml_fail(map, error, "%s", inner.text);
    return gw_site_refit(source, grid->columns, grid->rows, first, out, framed_end, error);
}

static gw_code read_one(gw_site_source *source, const char *kind, const gw_yaml_node *map, gw_layout *out,
                        gw_error *error) {
    static const char *const names[] = {"columns", "rows", "tile",   "bezel", "gaps",        "centre",
                                        "right",   "up",   "radius", "angle", "total_angle", "lean"};
    const uint32_t origin[2] = {0, 0};
    const gw_yaml_node *node;
    int bent = !strcmp(kind, "curve");
    gw_grid grid = {0};
    gw_hang hang = gw_hang_front;
    gw_code code = gw_site_map(map, kind, names, bent ? GW_COUNT(names) : 8, error);
    if (!code)
        code = read_array(source, map, 1, &grid, &hang, error);
    if (!code && bent)
        code = gw_site_require(map, "radius", &node, error);
    if (!code && bent)
        code = read_bend(map, &grid, &hang, error);
    return code ? code : add(source, map, &grid, &hang, "", origin, out, out->framed, error);
}

/* One of several walls, in both pictures. */
typedef struct wall_part {
    uint32_t first_tile, end_tile;
    uint32_t place[2], end[2]; /* px, without bezels */
    uint32_t framed_end[2];    /* px, with bezels, as if it stood alone at `place` */
    uint32_t shift[2];         /* px, by which it stands further in the picture with bezels */
} wall_part;

static gw_code read_wall(gw_site_source *source, const gw_yaml_node *map, wall_part *part, gw_layout *out,
                         gw_error *error) {
    static const char *const names[] = {"name", "place",  "panel", "columns",     "rows",
                                        "tile", "bezel",  "gaps",  "centre",      "right",
                                        "up",   "radius", "angle", "total_angle", "lean"};
    gw_grid grid = {0};
    gw_hang hang = gw_hang_front;
    char name[32] = "";
    gw_code code = gw_site_map(map, "walls", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_name(map, name, error);
    if (!code)
        code = gw_site_pixels(map, "place", 0, part->place, error);
    if (!code)
        code = read_array(source, map, 0, &grid, &hang, error);
    if (!code && gw_yaml_find(map, "radius"))
        code = read_bend(map, &grid, &hang, error);
    if (!code && hang.radius == 0 &&
        (gw_yaml_find(map, "angle") || gw_yaml_find(map, "total_angle") || gw_yaml_find(map, "lean")))
        code = gw_yaml_fail(
            map, error,
            "keys 'angle', 'total_angle' and 'lean' bend a wall round a 'radius'; it is missing here");
    part->first_tile = out->tile_count;
    if (!code)
        code = add(source, map, &grid, &hang, name, part->place, out, part->framed_end, error);
    part->end_tile = out->tile_count;
    for (uint32_t t = part->first_tile; t < part->end_tile; t++) {
        const gw_tile *tile = &out->tiles[t];
        const uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++)
            if (tile->picture[axis] + size[axis] > part->end[axis])
                part->end[axis] = tile->picture[axis] + size[axis];
    }
    return code;
}

/* Bezels make walls larger than their pixels: in the picture with bezels, each moves on by what those before
 * it in the picture need more. Repeated until nothing moves, for walls come in any order. */
static void make_room(wall_part *parts, size_t count, gw_layout *out) {
    for (size_t round = 0, moved = 1; moved && round < count; round++) {
        moved = 0;
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < count; j++)
                for (int axis = 0; axis < 2; axis++) {
                    uint32_t end = parts[j].framed_end[axis] + parts[j].shift[axis];
                    if (parts[j].end[axis] <= parts[i].place[axis] &&
                        parts[i].place[axis] + parts[i].shift[axis] < end) {
                        parts[i].shift[axis] = end - parts[i].place[axis];
                        moved = 1;
                    }
                }
    }
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 2; axis++) {
            uint32_t end = parts[i].framed_end[axis] + parts[i].shift[axis];
            for (uint32_t t = parts[i].first_tile; t < parts[i].end_tile; t++)
                out->tiles[t].framed[axis] += parts[i].shift[axis];
            if (end > out->framed[axis])
                out->framed[axis] = end;
        }
}

static gw_code read_walls(gw_site_source *source, const gw_yaml_node *list, gw_layout *out, gw_error *error) {
    wall_part parts[GW_MAXIMUM_TILES];
    memset(parts, 0, sizeof parts);
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "walls", error);
    size_t count = code ? 0 : gw_yaml_count(list);
    if (!code && (count < 1 || count > GW_MAXIMUM_TILES))
        return gw_yaml_fail(list, error, "key 'walls': %zu walls; expected 1 to %d", count, GW_MAXIMUM_TILES);
    for (size_t i = 0; i < count && !code; i++)
        code = read_wall(source, gw_yaml_item(list, i), &parts[i], out, error);
    if (code)
        return code;
    make_room(parts, count, out);
    if (out->framed[0] > GW_MAXIMUM_WALL_SIDE || out->framed[1] > GW_MAXIMUM_WALL_SIDE)
        return gw_yaml_fail(list, error, "with its bezels the wall is %ux%u px; at most %d are possible",
                            out->framed[0], out->framed[1], GW_MAXIMUM_WALL_SIDE);
    return GW_OK;
}

gw_code gw_site_generate(gw_site_source *source, const char *kind, const gw_yaml_node *node, gw_layout *out,
                         gw_error *error) {
    gw_code code = strcmp(kind, "walls") ? read_one(source, kind, node, out, error)
                                         : read_walls(source, node, out, error);
    gw_error inner = {0};
    if (!code && gw_layout_measure(out, &inner))
        code = gw_yaml_fail(node, error, "%s", inner.text);
    return code;
}
