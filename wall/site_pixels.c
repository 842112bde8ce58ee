/* Panels that have other pixels than the rest: key `pixels` of `panel` (for all) and `panels` (for one). */
#include "wall/site_internal.h"

#include <stdio.h>
#include <string.h>

/* The map of panels about this tile, if it says how many pixels it has. */
static const gw_yaml_node *own_pixels(const gw_site_source *source, const char *name) {
    const gw_yaml_node *panels = gw_yaml_find(source->root, "panels");
    const gw_yaml_node *panel = panels ? gw_yaml_find(panels, name) : NULL;
    return panel && gw_yaml_find(panel, "pixels") ? panel : NULL;
}

gw_code gw_site_pixels_of(const gw_site_source *source, const gw_yaml_node *map, const char *name,
                          uint32_t out[2], gw_error *error) {
    const gw_yaml_node *own = name ? own_pixels(source, name) : NULL,
                       *common = gw_yaml_find(source->root, "panel");
    if (own)
        return gw_site_pixels(own, "pixels", 1, out, error);
    if (!gw_yaml_find(map, "pixels") && common && gw_yaml_find(common, "pixels"))
        return gw_site_pixels(common, "pixels", 1, out, error);
    return gw_site_pixels(map, "pixels", 1, out, error);
}

/* Gives a tile its own pixels on the area that it has. */
static void set_pixels(gw_tile *tile, const uint32_t pixels[2]) {
    double corners[4][3];
    gw_tile_corners(tile, corners);
    gw_plane_from_corners((const double(*)[3])corners, pixels, &tile->plane);
    tile->rectangle = (gw_rectangle){.width = pixels[0], .height = pixels[1]};
}

gw_code gw_site_refit(const gw_site_source *source, uint32_t columns, uint32_t rows, uint32_t first,
                      gw_layout *layout, uint32_t framed_end[2], gw_error *error) {
    const uint32_t counts[2] = {columns, rows};
    uint32_t sizes[2][GW_MAXIMUM_TILES] = {{0}}, old[2][GW_MAXIMUM_TILES] = {{0}};
    int any = 0;
    for (uint32_t i = 0; i < columns * rows; i++) {
        gw_tile *tile = &layout->tiles[first + i];
        const gw_yaml_node *own = own_pixels(source, tile->name);
        const uint32_t at[2] = {i % columns, i / columns};
        uint32_t pixels[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++)
            old[axis][at[axis]] = pixels[axis];
        gw_code code = own ? gw_site_pixels(own, "pixels", 1, pixels, error) : GW_OK;
        if (code)
            return code;
        if (own)
            set_pixels(tile, pixels);
        any |= own != NULL;
        for (int axis = 0; axis < 2; axis++)
            if (pixels[axis] > sizes[axis][at[axis]])
                sizes[axis][at[axis]] = pixels[axis];
    }
    /* Columns and rows of both pictures are as wide as their widest tile. */
    for (int axis = 0; axis < 2 && any; axis++) {
        int64_t moved = 0;
        for (uint32_t k = 0; k < counts[axis]; k++) {
            for (uint32_t i = 0; i < columns * rows; i++) {
                gw_tile *tile = &layout->tiles[first + i];
                if ((axis ? i / columns : i % columns) != k)
                    continue;
                tile->picture[axis] = (uint32_t)(tile->picture[axis] + moved);
                tile->framed[axis] = (uint32_t)(tile->framed[axis] + moved);
            }
            moved += (int64_t)sizes[axis][k] - old[axis][k];
        }
        framed_end[axis] = (uint32_t)(framed_end[axis] + moved);
        if (framed_end[axis] > GW_MAXIMUM_WALL_SIDE)
            return gw_fail(error, GW_BAD_INPUT,
                           "with the pixels of its panels the wall is %u px; at most %d are possible",
                           framed_end[axis], GW_MAXIMUM_WALL_SIDE);
    }
    return GW_OK;
}
