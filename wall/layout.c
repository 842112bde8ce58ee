#include "wall/layout.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void gw_split_evenly(uint32_t pixels, uint32_t count, uint32_t *parts) {
    for (uint32_t i = 0; i < count; i++) {
        uint64_t begin = (uint64_t)pixels * i / count, end = (uint64_t)pixels * (i + 1) / count;
        parts[i] = (uint32_t)(end - begin);
    }
}

static gw_code check_grid(const gw_grid *grid, gw_error *error) {
    if (grid->columns < 1 || grid->rows < 1 || (uint64_t)grid->columns * grid->rows > GW_MAXIMUM_TILES)
        return gw_fail(error, GW_BAD_INPUT, "%ux%u tiles is out of range; a wall has 1 to %d tiles",
                       grid->columns, grid->rows, GW_MAXIMUM_TILES);
    for (int axis = 0; axis < 2; axis++) {
        uint64_t sum = 0;
        uint32_t count = axis ? grid->rows : grid->columns;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t part = axis ? grid->heights[i] : grid->widths[i];
            if (part == 0)
                return gw_fail(error, GW_BAD_INPUT,
                               "%s %u of the wall has no pixels; use fewer tiles or more pixels",
                               axis ? "row" : "column", i);
            sum += part;
        }
        if (sum > GW_MAXIMUM_WALL_SIDE)
            return gw_fail(error, GW_BAD_INPUT, "the wall is %llu px %s; at most %d are possible",
                           (unsigned long long)sum, axis ? "high" : "wide", GW_MAXIMUM_WALL_SIDE);
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

gw_code gw_layout_grid(const gw_grid *grid, gw_layout *out, gw_error *error) {
    gw_code code = check_grid(grid, error);
    if (code)
        return code;
    memset(out, 0, sizeof *out);
    memcpy(out->eye, grid->eye, sizeof out->eye);
    uint32_t pixels[2] = {0, 0};
    for (uint32_t i = 0; i < grid->columns; i++)
        pixels[0] += grid->widths[i];
    for (uint32_t i = 0; i < grid->rows; i++)
        pixels[1] += grid->heights[i];
    double extent[2] = {grid->pitch[0] * pixels[0] + grid->columns * (grid->left + grid->right),
                        grid->pitch[1] * pixels[1] + grid->rows * (grid->top + grid->bottom)};
    int one_plane = grid->left + grid->right + grid->top + grid->bottom == 0;

    uint32_t y = 0;
    for (uint32_t row = 0; row < grid->rows; y += grid->heights[row++]) {
        uint32_t x = 0;
        for (uint32_t column = 0; column < grid->columns; x += grid->widths[column++]) {
            gw_tile *tile = &out->tiles[out->tile_count++];
            snprintf(tile->name, sizeof tile->name, "c%ur%u", column, row);
            tile->plane.step_x[0] = grid->pitch[0];
            tile->plane.step_y[1] = -grid->pitch[1];
            tile->plane.corner[0] = -0.5 * extent[0];
            tile->plane.corner[1] = 0.5 * extent[1];
            tile->rectangle = (gw_rectangle){.width = grid->widths[column], .height = grid->heights[row]};
            tile->picture[0] = x;
            tile->picture[1] = y;
            if (one_plane) {
                tile->rectangle.x = (int32_t)x;
                tile->rectangle.y = (int32_t)y;
            } else {
                tile->plane.corner[0] +=
                    grid->pitch[0] * x + column * (grid->left + grid->right) + grid->left;
                tile->plane.corner[1] -= grid->pitch[1] * y + row * (grid->top + grid->bottom) + grid->top;
            }
        }
    }
    code = gw_layout_measure(out, error);
    if (code)
        return code;
    /* The outermost bezels belong to the wall: show them, too. */
    uint32_t margin[2] = {(uint32_t)lround(grid->left / grid->pitch[0]),
                          (uint32_t)lround(grid->top / grid->pitch[1])};
    uint32_t far_margin[2] = {(uint32_t)lround(grid->right / grid->pitch[0]),
                              (uint32_t)lround(grid->bottom / grid->pitch[1])};
    for (uint32_t i = 0; i < out->tile_count; i++)
        for (int axis = 0; axis < 2; axis++)
            out->tiles[i].framed[axis] += margin[axis];
    for (int axis = 0; axis < 2; axis++) {
        out->framed[axis] += margin[axis] + far_margin[axis];
        if (out->framed[axis] > GW_MAXIMUM_WALL_SIDE)
            return gw_fail(error, GW_BAD_INPUT, "with its bezels the wall is %u px; at most %d are possible",
                           out->framed[axis], GW_MAXIMUM_WALL_SIDE);
    }
    return GW_OK;
}

/* The wall-space point at pixel coordinates (x, y) of the tile's plane. */
static void plane_point(const gw_plane *plane, double x, double y, double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = plane->corner[i] + x * plane->step_x[i] + y * plane->step_y[i];
}

/* Corner 0..3 of a tile: top left, top right, bottom left, bottom right. */
static void tile_corner(const gw_tile *tile, int corner, double out[3]) {
    double x = (double)tile->rectangle.x + (corner & 1 ? (double)tile->rectangle.width : 0);
    double y = (double)tile->rectangle.y + (corner & 2 ? (double)tile->rectangle.height : 0);
    plane_point(&tile->plane, x, y, out);
}

/* The box around all tiles in mm. */
static void measure_box(const gw_layout *layout, double least[3], double greatest[3]) {
    for (int i = 0; i < 3; i++) {
        least[i] = INFINITY;
        greatest[i] = -INFINITY;
    }
    for (uint32_t t = 0; t < layout->tile_count; t++)
        for (int corner = 0; corner < 4; corner++) {
            double point[3];
            tile_corner(&layout->tiles[t], corner, point);
            for (int i = 0; i < 3; i++) {
                least[i] = fmin(least[i], point[i]);
                greatest[i] = fmax(greatest[i], point[i]);
            }
        }
}

gw_code gw_layout_measure(gw_layout *layout, gw_error *error) {
    double least[3], greatest[3];
    measure_box(layout, least, greatest);
    for (int i = 0; i < 3; i++)
        layout->centre[i] = 0.5 * (least[i] + greatest[i]);
    layout->size[0] = greatest[0] - least[0];
    layout->size[1] = greatest[1] - least[1];
    if (!(layout->size[0] > 0 && layout->size[1] > 0 && isfinite(layout->size[0]) &&
          isfinite(layout->size[1])))
        return gw_fail(
            error, GW_BAD_INPUT,
            "the wall's tiles span %g x %g mm as seen along z; a wall must have some width and height",
            layout->size[0], layout->size[1]);

    /* The picture with bezels is drawn at the first tile's pixel pitch. */
    const gw_plane *first = &layout->tiles[0].plane;
    double pitch[2] = {sqrt(first->step_x[0] * first->step_x[0] + first->step_x[1] * first->step_x[1] +
                            first->step_x[2] * first->step_x[2]),
                       sqrt(first->step_y[0] * first->step_y[0] + first->step_y[1] * first->step_y[1] +
                            first->step_y[2] * first->step_y[2])};
    memset(layout->picture, 0, sizeof layout->picture);
    memset(layout->framed, 0, sizeof layout->framed);
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        gw_tile *tile = &layout->tiles[t];
        double corner[3];
        tile_corner(tile, 0, corner);
        double offset[2] = {(corner[0] - least[0]) / pitch[0], (greatest[1] - corner[1]) / pitch[1]};
        uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++) {
            if (offset[axis] > GW_MAXIMUM_WALL_SIDE)
                return gw_fail(
                    error, GW_BAD_INPUT,
                    "tile '%s' stands %.0f px from the wall's first corner; at most %d are possible",
                    tile->name, offset[axis], GW_MAXIMUM_WALL_SIDE);
            tile->framed[axis] = (uint32_t)lround(fmax(0, offset[axis]));
            uint32_t end = tile->picture[axis] + size[axis], framed_end = tile->framed[axis] + size[axis];
            if (end > layout->picture[axis])
                layout->picture[axis] = end;
            if (framed_end > layout->framed[axis])
                layout->framed[axis] = framed_end;
            if (end > GW_MAXIMUM_WALL_SIDE || framed_end > GW_MAXIMUM_WALL_SIDE)
                return gw_fail(error, GW_BAD_INPUT, "tile '%s' ends at pixel %u; at most %d are possible",
                               tile->name, end > framed_end ? end : framed_end, GW_MAXIMUM_WALL_SIDE);
        }
    }
    return GW_OK;
}

gw_code gw_layout_point(const gw_layout *layout, const double pixel[2], double out[3], gw_error *error) {
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        double x = pixel[0] - tile->picture[0], y = pixel[1] - tile->picture[1];
        /* The far edge belongs to the tile, so that the wall's last corner can be named. */
        if (x >= 0 && y >= 0 && x <= tile->rectangle.width && y <= tile->rectangle.height) {
            plane_point(&tile->plane, x + tile->rectangle.x, y + tile->rectangle.y, out);
            return GW_OK;
        }
    }
    return gw_fail(error, GW_BAD_INPUT, "pixel %g,%g is on no tile; the wall has %ux%u pixels", pixel[0],
                   pixel[1], layout->picture[0], layout->picture[1]);
}
