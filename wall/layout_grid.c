/* Grids of tiles, flat or bent: from columns, rows, bezels and gaps to corners in millimetres. */
#include "wall/layout.h"

#include "render/vector3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const gw_hang gw_hang_front = {.right = {1, 0, 0}, .up = {0, 1, 0}};

/* Where the lit area of each column (axis 0) or row (axis 1) begins, from the grid's left or top outer edge,
 * and what all of them measure with bezels and gaps. */
typedef struct axis_places {
    double begin[GW_MAXIMUM_TILES];   /* mm */
    uint32_t first[GW_MAXIMUM_TILES]; /* pixel */
    double extent;                    /* mm */
    uint32_t pixels;                  /* of all parts together */
} axis_places;

static void place_axis(const gw_grid *grid, int axis, axis_places *out) {
    const uint32_t *parts = axis ? grid->heights : grid->widths, count = axis ? grid->rows : grid->columns;
    const double *gaps = axis ? grid->row_gaps : grid->column_gaps;
    double before = axis ? grid->top : grid->left, after = axis ? grid->bottom : grid->right, air = 0;
    uint32_t pixels = 0;
    for (uint32_t i = 0; i < count; i++) {
        out->first[i] = pixels;
        out->begin[i] = grid->pitch[axis] * pixels + i * (before + after) + before + air;
        pixels += parts[i];
        if (i + 1 < count)
            air += gaps[i];
    }
    out->extent = grid->pitch[axis] * pixels + count * (before + after) + air;
    out->pixels = pixels;
}

static gw_code check_parts(const gw_grid *grid, int axis, gw_error *error) {
    uint64_t sum = 0;
    uint32_t count = axis ? grid->rows : grid->columns;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t part = axis ? grid->heights[i] : grid->widths[i];
        double gap = axis ? grid->row_gaps[i] : grid->column_gaps[i];
        if (part == 0)
            return gw_fail(error, GW_BAD_INPUT,
                           "%s %u of the wall has no pixels; use fewer tiles or more pixels",
                           axis ? "row" : "column", i);
        if (!(gap >= 0 && gap <= 1e4))
            return gw_fail(error, GW_BAD_INPUT, "a gap of %g mm is out of range; it must be 0 to 10000 mm",
                           gap);
        sum += part;
    }
    if (sum > GW_MAXIMUM_WALL_SIDE)
        return gw_fail(error, GW_BAD_INPUT, "the wall is %llu px %s; at most %d are possible",
                       (unsigned long long)sum, axis ? "high" : "wide", GW_MAXIMUM_WALL_SIDE);
    return GW_OK;
}

static gw_code check_grid(const gw_grid *grid, uint32_t tiles_before, gw_error *error) {
    uint64_t tiles = (uint64_t)grid->columns * grid->rows;
    if (grid->columns < 1 || grid->rows < 1 || tiles + tiles_before > GW_MAXIMUM_TILES)
        return gw_fail(error, GW_BAD_INPUT, "%ux%u tiles is out of range; a wall has 1 to %d tiles",
                       grid->columns, grid->rows, GW_MAXIMUM_TILES);
    for (int axis = 0; axis < 2; axis++) {
        gw_code code = check_parts(grid, axis, error);
        if (code)
            return code;
    }
    const double bezels[4] = {grid->left, grid->right, grid->top, grid->bottom};
    for (int i = 0; i < 4; i++)
        if (!(bezels[i] >= 0 && bezels[i] <= 1e4))
            return gw_fail(error, GW_BAD_INPUT, "a bezel of %g mm is out of range; it must be 0 to 10000 mm",
                           bezels[i]);
    for (int i = 0; i < 2; i++)
        if (!(grid->pitch[i] >= 1e-4 && grid->pitch[i] <= 1e4))
            return gw_fail(error, GW_BAD_INPUT,
                           "a pixel of %g mm is out of range; it must be 0.0001 to 10000 mm", grid->pitch[i]);
    return GW_OK;
}

/* Rows that lean are a chain whose frames touch: heights and depths of the rows' middles, and the angle at
 * which each leans to the viewer. The foremost bend has depth 0. */
typedef struct row_chain {
    double height[GW_MAXIMUM_TILES], depth[GW_MAXIMUM_TILES], angle[GW_MAXIMUM_TILES];
} row_chain;

static void chain_rows(const gw_grid *grid, double lean, row_chain *out) {
    double up = 0, in = 0, least = 0;
    for (uint32_t row = grid->rows; row-- > 0;) {
        double angle = (0.5 * (grid->rows - 1) - row) * lean;
        double lit = grid->heights[row] * grid->pitch[1], length = grid->top + lit + grid->bottom;
        double gap = row ? grid->row_gaps[row - 1] : 0, middle = grid->bottom + 0.5 * lit;
        out->angle[row] = angle;
        out->height[row] = up + middle * cos(angle);
        out->depth[row] = in + middle * sin(angle);
        least = fmin(least, fmin(out->depth[row], in + length * sin(angle)));
        up += (length + gap) * cos(angle);
        in += (length + gap) * sin(angle);
    }
    for (uint32_t row = 0; row < grid->rows; row++) {
        out->height[row] -= 0.5 * up;
        out->depth[row] -= least;
    }
}

static void bent_corners(const gw_grid *grid, const gw_hang *hang, const row_chain *chain, uint32_t column,
                         uint32_t row, double corners[3][3]) {
    double front[3], turn = (column - 0.5 * (grid->columns - 1)) * hang->angle, lean = chain->angle[row];
    double half[2] = {0.5 * grid->widths[column] * grid->pitch[0], 0.5 * grid->heights[row] * grid->pitch[1]};
    gw_cross(hang->right, hang->up, front);
    for (int i = 0; i < 3; i++) {
        double along = cos(turn) * hang->right[i] + sin(turn) * front[i];
        double in = cos(turn) * front[i] - sin(turn) * hang->right[i];
        double up = cos(lean) * hang->up[i] + sin(lean) * in;
        double middle = hang->centre[i] +
                        hang->radius * (sin(turn) * hang->right[i] + (1 - cos(turn)) * front[i]) +
                        0.5 * (grid->left - grid->right) * along + chain->height[row] * hang->up[i] +
                        chain->depth[row] * in;
        corners[0][i] = middle - half[0] * along + half[1] * up;
        corners[1][i] = middle + half[0] * along + half[1] * up;
        corners[2][i] = middle - half[0] * along - half[1] * up;
    }
}

/* Corners of a part of the flat grid: `at` and `size` in mm from its left top outer corner. */
static void flat_corners(const gw_hang *hang, const double extent[2], const double at[2],
                         const double size[2], double corners[3][3]) {
    double x = -0.5 * extent[0] + at[0], y = 0.5 * extent[1] - at[1];
    const double flat[3][2] = {{x, y}, {x + size[0], y}, {x, y - size[1]}};
    for (int corner = 0; corner < 3; corner++)
        for (int i = 0; i < 3; i++)
            corners[corner][i] =
                hang->centre[i] + flat[corner][0] * hang->right[i] + flat[corner][1] * hang->up[i];
}

static int has_gaps(const gw_grid *grid) {
    double sum = grid->left + grid->right + grid->top + grid->bottom;
    for (uint32_t i = 0; i + 1 < grid->columns; i++)
        sum += grid->column_gaps[i];
    for (uint32_t i = 0; i + 1 < grid->rows; i++)
        sum += grid->row_gaps[i];
    return sum > 0;
}

static void hang_tile(const gw_grid *grid, const gw_hang *hang, const row_chain *chain,
                      const axis_places places[2], uint32_t column, uint32_t row, gw_tile *tile) {
    const double extent[2] = {places[0].extent, places[1].extent};
    const uint32_t pixels[2] = {grid->widths[column], grid->heights[row]};
    double corners[3][3];
    tile->rectangle = (gw_rectangle){.width = pixels[0], .height = pixels[1]};
    if (hang->radius > 0) {
        bent_corners(grid, hang, chain, column, row, corners);
    } else if (has_gaps(grid)) {
        const double at[2] = {places[0].begin[column], places[1].begin[row]};
        const double size[2] = {pixels[0] * grid->pitch[0], pixels[1] * grid->pitch[1]};
        flat_corners(hang, extent, at, size, corners);
    } else {
        const uint32_t whole[2] = {places[0].pixels, places[1].pixels};
        flat_corners(hang, extent, (const double[2]){0, 0}, extent, corners);
        gw_plane_from_corners((const double(*)[3])corners, whole, &tile->plane);
        tile->rectangle.x = (int32_t)places[0].first[column];
        tile->rectangle.y = (int32_t)places[1].first[row];
        return;
    }
    gw_plane_from_corners((const double(*)[3])corners, pixels, &tile->plane);
}

/* Whole pixels, of which more than a wall can have are refused later. */
static uint32_t whole_pixels(double pixels) {
    return (uint32_t)lround(fmin(pixels, 8.0 * GW_MAXIMUM_WALL_SIDE));
}

/* Where a tile begins in the picture with bezels, px from the grid's outer edge. The outermost bezels belong
 * to the wall: they are shown, too. A bent wall is shown unrolled. */
static uint32_t framed_offset(const gw_grid *grid, const gw_hang *hang, const axis_places *places, int axis,
                              uint32_t i) {
    double margin = axis ? grid->top : grid->left, offset = places->begin[i] - places->begin[0];
    if (axis == 0 && hang->radius > 0)
        offset = fmax(i * 2 * hang->radius * tan(0.5 * hang->angle), places->first[i] * grid->pitch[0]);
    return whole_pixels(margin / grid->pitch[axis]) + whole_pixels(offset / grid->pitch[axis]);
}

static gw_code name_tile(const gw_grid *grid, const char *name, uint32_t column, uint32_t row, char out[32],
                         gw_error *error) {
    int length = 0;
    if (name[0] && grid->columns == 1 && grid->rows == 1)
        length = snprintf(out, 32, "%s", name);
    else
        length = snprintf(out, 32, "%s%sc%ur%u", name, name[0] ? "-" : "", column, row);
    return length < 32 ? GW_OK
                       : gw_fail(error, GW_BAD_INPUT,
                                 "tile '%s-c%ur%u' has a name of more than 31 characters; shorten the wall's",
                                 name, column, row);
}

gw_code gw_layout_add_grid(const gw_grid *grid, const gw_hang *hang, const char *name,
                           const uint32_t place[2], const uint32_t framed_place[2], gw_layout *layout,
                           uint32_t framed_end[2], gw_error *error) {
    axis_places places[2];
    row_chain chain;
    gw_code code = check_grid(grid, layout->tile_count, error);
    if (code)
        return code;
    place_axis(grid, 0, &places[0]);
    place_axis(grid, 1, &places[1]);
    chain_rows(grid, hang->lean, &chain);
    for (uint32_t row = 0; row < grid->rows; row++)
        for (uint32_t column = 0; column < grid->columns; column++) {
            gw_tile *tile = &layout->tiles[layout->tile_count++];
            code = name_tile(grid, name, column, row, tile->name, error);
            if (code)
                return code;
            hang_tile(grid, hang, &chain, places, column, row, tile);
            const uint32_t at[2] = {column, row};
            for (int axis = 0; axis < 2; axis++) {
                tile->picture[axis] = place[axis] + places[axis].first[at[axis]];
                tile->framed[axis] =
                    framed_place[axis] + framed_offset(grid, hang, &places[axis], axis, at[axis]);
            }
        }
    const gw_tile *last = &layout->tiles[layout->tile_count - 1];
    framed_end[0] = last->framed[0] + last->rectangle.width + whole_pixels(grid->right / grid->pitch[0]);
    framed_end[1] = last->framed[1] + last->rectangle.height + whole_pixels(grid->bottom / grid->pitch[1]);
    for (int axis = 0; axis < 2; axis++)
        if (framed_end[axis] > GW_MAXIMUM_WALL_SIDE)
            return gw_fail(error, GW_BAD_INPUT, "with its bezels the wall is %u px; at most %d are possible",
                           framed_end[axis], GW_MAXIMUM_WALL_SIDE);
    return GW_OK;
}

gw_code gw_layout_grid(const gw_grid *grid, gw_layout *out, gw_error *error) {
    const uint32_t origin[2] = {0, 0};
    memset(out, 0, sizeof *out);
    memcpy(out->eye, grid->eye, sizeof out->eye);
    gw_code code = gw_layout_add_grid(grid, &gw_hang_front, "", origin, origin, out, out->framed, error);
    return code ? code : gw_layout_measure(out, error);
}
