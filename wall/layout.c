#include "wall/layout.h"

#include "render/vector3.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void gw_split_evenly(uint32_t pixels, uint32_t count, uint32_t *parts) {
    for (uint32_t i = 0; i < count; i++) {
        uint64_t begin = (uint64_t)pixels * i / count, end = (uint64_t)pixels * (i + 1) / count;
        parts[i] = (uint32_t)(end - begin);
    }
}

void gw_plane_from_corners(const double corners[3][3], const uint32_t pixels[2], gw_plane *out) {
    for (int i = 0; i < 3; i++) {
        out->corner[i] = corners[0][i];
        out->step_x[i] = (corners[1][i] - corners[0][i]) / pixels[0];
        out->step_y[i] = (corners[2][i] - corners[0][i]) / pixels[1];
    }
}

/* The wall-space point at pixel coordinates (x, y) of the tile's plane. */
static void plane_point(const gw_plane *plane, double x, double y, double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = plane->corner[i] + x * plane->step_x[i] + y * plane->step_y[i];
}

void gw_tile_corners(const gw_tile *tile, double out[4][3]) {
    for (int corner = 0; corner < 4; corner++) {
        double x = (double)tile->rectangle.x + (corner & 1 ? (double)tile->rectangle.width : 0);
        double y = (double)tile->rectangle.y + (corner & 2 ? (double)tile->rectangle.height : 0);
        plane_point(&tile->plane, x, y, out[corner]);
    }
}

/* The box around all tiles in mm. */
static void measure_box(const gw_layout *layout, double least[3], double greatest[3]) {
    for (int i = 0; i < 3; i++) {
        least[i] = INFINITY;
        greatest[i] = -INFINITY;
    }
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        double corners[4][3];
        gw_tile_corners(&layout->tiles[t], corners);
        for (int corner = 0; corner < 4; corner++)
            for (int i = 0; i < 3; i++) {
                least[i] = fmin(least[i], corners[corner][i]);
                greatest[i] = fmax(greatest[i], corners[corner][i]);
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
    memset(layout->picture, 0, sizeof layout->picture);
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        const uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++) {
            uint64_t end = (uint64_t)tile->picture[axis] + size[axis];
            if (end > GW_MAXIMUM_WALL_SIDE)
                return gw_fail(error, GW_BAD_INPUT, "tile '%s' ends at pixel %llu; at most %d are possible",
                               tile->name, (unsigned long long)end, GW_MAXIMUM_WALL_SIDE);
            if (end > layout->picture[axis])
                layout->picture[axis] = (uint32_t)end;
        }
    }
    return GW_OK;
}

/* One axis of two rectangles of pixels: whether they share any. */
static int share(const uint32_t *at_a, const uint32_t size_a[2], const uint32_t *at_b,
                 const uint32_t size_b[2], int axis) {
    return at_a[axis] < at_b[axis] + size_b[axis] && at_b[axis] < at_a[axis] + size_a[axis];
}

/* Pixels of the first tile in what is between two neighbours of the picture; 0 for tiles that are none. */
static uint32_t gap_between(const gw_layout *layout, const gw_tile *before, const gw_tile *next, int axis) {
    const uint32_t sizes[2] = {before->rectangle.width, before->rectangle.height};
    double from[4][3], to[4][3], between[3];
    if (before->picture[axis] + sizes[axis] != next->picture[axis])
        return 0;
    gw_tile_corners(before, from);
    gw_tile_corners(next, to);
    for (int i = 0; i < 3; i++)
        between[i] = to[0][i] - from[axis ? 2 : 1][i];
    const gw_plane *first = &layout->tiles[0].plane;
    double pixels = gw_length(between) / gw_length(axis ? first->step_y : first->step_x);
    return (uint32_t)lround(fmin(pixels, GW_MAXIMUM_WALL_SIDE));
}

/* Moves tiles along an axis until none hides one that stands before it in the same row (or column) of the
 * picture without bezels, and leaves the gap that there is. One pass in the picture's order, for moving a
 * tile moves only those behind it. */
static void push_apart(gw_layout *layout, int axis) {
    uint32_t order[GW_MAXIMUM_TILES];
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        uint32_t at = i;
        for (; at > 0 && layout->tiles[order[at - 1]].picture[axis] > layout->tiles[i].picture[axis]; at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        gw_tile *tile = &layout->tiles[order[i]];
        const uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (uint32_t j = 0; j < i; j++) {
            const gw_tile *before = &layout->tiles[order[j]];
            const uint32_t size_before[2] = {before->rectangle.width, before->rectangle.height};
            if (before->picture[axis] + size_before[axis] <= tile->picture[axis] &&
                share(before->picture, size_before, tile->picture, size, 1 - axis) &&
                tile->framed[axis] < before->framed[axis] + size_before[axis])
                tile->framed[axis] =
                    before->framed[axis] + size_before[axis] + gap_between(layout, before, tile, axis);
        }
    }
}

/* Whether two tiles that are apart in the picture without bezels hide each other in the one with bezels. */
static int any_hidden(const gw_layout *layout) {
    for (uint32_t i = 0; i < layout->tile_count; i++)
        for (uint32_t j = 0; j < i; j++) {
            const gw_tile *a = &layout->tiles[i], *b = &layout->tiles[j];
            const uint32_t size_a[2] = {a->rectangle.width, a->rectangle.height},
                           size_b[2] = {b->rectangle.width, b->rectangle.height};
            int apart = !share(a->picture, size_a, b->picture, size_b, 0) ||
                        !share(a->picture, size_a, b->picture, size_b, 1);
            if (apart && share(a->framed, size_a, b->framed, size_b, 0) &&
                share(a->framed, size_a, b->framed, size_b, 1))
                return 1;
        }
    return 0;
}

/* Where each tile's first corner is seen from the front, in pixels of the first tile. */
static gw_code project(gw_layout *layout, gw_error *error) {
    double least[3], greatest[3];
    measure_box(layout, least, greatest);
    const gw_plane *first = &layout->tiles[0].plane;
    const double pitch[2] = {gw_length(first->step_x), gw_length(first->step_y)};
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        gw_tile *tile = &layout->tiles[t];
        double corners[4][3];
        gw_tile_corners(tile, corners);
        const double offset[2] = {(corners[0][0] - least[0]) / pitch[0],
                                  (greatest[1] - corners[0][1]) / pitch[1]};
        for (int axis = 0; axis < 2; axis++) {
            if (offset[axis] > GW_MAXIMUM_WALL_SIDE)
                return gw_fail(
                    error, GW_BAD_INPUT,
                    "tile '%s' stands %.0f px from the wall's first corner; at most %d are possible",
                    tile->name, offset[axis], GW_MAXIMUM_WALL_SIDE);
            tile->framed[axis] = (uint32_t)lround(fmax(0, offset[axis]));
        }
    }
    return GW_OK;
}

gw_code gw_layout_frame(gw_layout *layout, gw_error *error) {
    gw_code code = project(layout, error);
    if (code)
        return code;
    push_apart(layout, 0);
    push_apart(layout, 1);
    if (any_hidden(layout)) /* no view from the front: the picture without bezels serves */
        for (uint32_t t = 0; t < layout->tile_count; t++)
            memcpy(layout->tiles[t].framed, layout->tiles[t].picture, sizeof layout->tiles[t].framed);
    memset(layout->framed, 0, sizeof layout->framed);
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        const uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++) {
            uint32_t end = tile->framed[axis] + size[axis];
            if (end > GW_MAXIMUM_WALL_SIDE)
                return gw_fail(error, GW_BAD_INPUT,
                               "with the gaps, tile '%s' ends at pixel %u; at most %d are possible",
                               tile->name, end, GW_MAXIMUM_WALL_SIDE);
            if (end > layout->framed[axis])
                layout->framed[axis] = end;
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

void gw_layout_names(const gw_layout *layout, uint64_t tiles, char *text, size_t room) {
    enum { MORE = 16 /* characters of " and 63 more" */ };
    uint32_t left = 0;
    size_t used = 0;
    for (uint32_t i = 0; i < layout->tile_count && i < 64; i++)
        left += (uint32_t)(tiles >> i & 1);
    text[0] = '\0';
    for (uint32_t i = 0; i < layout->tile_count && left > 0; i++) {
        const char *name = layout->tiles[i].name;
        if (!(tiles >> i & 1))
            continue;
        if (used + strlen(name) + 2 + MORE > room) {
            snprintf(text + used, room - used, " and %" PRIu32 " more", left);
            return;
        }
        used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", " : "", name);
        left--;
    }
}
